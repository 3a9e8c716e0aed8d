"""The parameters of the node: what they are called, what is allowed, and who hears of a change."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.parameter import Parameter

from circle_bounce_ros.kernel import Scene, SceneError
from circle_bounce_ros.scene_file import load_scene

# The seed that stands for the one in the scene file.
SEED_OF_FILE = -1

LARGEST_SEED = 2**63 - 1  # what an integer parameter can hold


class ParameterError(ValueError):
    """A parameter that the node cannot start with, in one sentence."""


def _text(description: str) -> ParameterDescriptor:
    return ParameterDescriptor(description=description)


def _number(description: str, least: float, most: float) -> ParameterDescriptor:
    limits = FloatingPointRange(from_value=least, to_value=most)
    return ParameterDescriptor(description=description, floating_point_range=[limits])


def _whole(description: str, least: int, most: int) -> ParameterDescriptor:
    limits = IntegerRange(from_value=least, to_value=most, step=1)
    return ParameterDescriptor(description=description, integer_range=[limits])


def _fixed(description: str) -> ParameterDescriptor:
    return ParameterDescriptor(description=description, read_only=True)


PARAMETERS: list[tuple[str, Any, ParameterDescriptor]] = [
    (
        'scene',
        'lesson',
        _text(
            'The scene to show: the name of a packaged one, or with a / or .yaml in it the path of a file, '
            'from the working directory. No unit.'
        ),
    ),
    (
        'seed',
        SEED_OF_FILE,
        _whole(
            'What the random groups of the scene are filled from; -1: the seed in the file. No unit.',
            SEED_OF_FILE,
            LARGEST_SEED,
        ),
    ),
    (
        'rate',
        60.0,
        _number(
            'Ticks per second, in Hz: of wall time, with publish_clock of scene time.', 0.1, 1000.0
        ),
    ),
    (
        'time_scale',
        1.0,
        _number(
            'Seconds of scene time per second of the clock (s/s), greater than 0; with publish_clock 0 means '
            'as fast as possible.',
            0.0,
            1000.0,
        ),
    ),
    ('start_paused', False, _fixed('Whether the scene stands still at the start. True or false.')),
    (
        'publish_clock',
        False,
        _fixed(
            'Whether the node is the time source: it publishes /clock, and stamps are simulated time. '
            'Not together with use_sim_time. True or false.'
        ),
    ),
    ('frame_id', 'world', _fixed('The frame of all positions and velocities. No unit.')),
]


class Parameters:
    """
    The parameters, declared, and checked before any change takes effect.

    Parameters
    ----------
    node : Node
    on_change : callable
        Called with the names of those that have been set, once they have.

    Raises
    ------
    ParameterError, SceneError
        For values that the node cannot start with.

    """

    def __init__(self, node: Node, on_change: Callable[[set[str]], None]) -> None:
        self._node = node
        self._on_change = on_change
        try:
            node.declare_parameters('', PARAMETERS)
        except ParameterException as error:
            raise ParameterError(str(error)) from error
        self._names = {name for name, *_ in PARAMETERS}
        values = self._values()
        self._check(values)
        self._scene = self._load(values)
        node.add_on_set_parameters_callback(self._on_set)
        node.add_post_set_parameters_callback(self._after_set)

    def __getitem__(self, name: str) -> Any:
        """Return the value of a parameter."""
        return self._node.get_parameter(name).value

    @property
    def scene(self) -> Scene:
        """The scene that `scene` and `seed` say, as it was loaded when they were checked."""
        return self._scene

    def _values(self) -> dict[str, Any]:
        return {name: self[name] for name in (*self._names, 'use_sim_time')}

    def _check(self, values: dict[str, Any]) -> None:
        if values['publish_clock'] and values['use_sim_time']:
            raise ParameterError(
                'publish_clock and use_sim_time: must not both be true, a node cannot follow the clock '
                'that it publishes'
            )
        if values['time_scale'] == 0.0 and not values['publish_clock']:
            raise ParameterError('time_scale: must be > 0 without publish_clock, got 0.0')
        if not values['frame_id']:
            raise ParameterError("frame_id: must not be empty, got ''")

    def _load(self, values: dict[str, Any]) -> Scene:
        seed = values['seed']
        return load_scene(values['scene'], seed=None if seed == SEED_OF_FILE else seed)

    def _on_set(self, parameters: Iterable[Parameter]) -> SetParametersResult:
        new = {parameter.name: parameter.value for parameter in parameters}
        values = self._values() | new
        try:
            self._check(values)
            if new.keys() & {'scene', 'seed'}:
                self._candidate = self._load(values)
        except (ParameterError, SceneError) as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _after_set(self, parameters: Iterable[Parameter]) -> None:
        changed = {parameter.name for parameter in parameters} & self._names
        if changed & {'scene', 'seed'}:
            self._scene = self._candidate
        if changed:
            self._on_change(changed)
