"""The parameters of the node: what is allowed together, and who hears of a change."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.parameter import Parameter

from circle_bounce_ros.base_node import BaseNode, ParameterError
from circle_bounce_ros.kernel import Scene, SceneError
from circle_bounce_ros.ros.main import PARAMETERS, SEED_OF_FILE
from circle_bounce_ros.scene_file import load_scene


class Parameters:
    """
    The parameters, checked before any change takes effect.

    Parameters
    ----------
    node : BaseNode
        Has declared them.
    on_change : callable
        Called with the names of those that have been set, once they have.

    Raises
    ------
    ParameterError, SceneError
        For values that the node cannot start with.

    """

    def __init__(self, node: BaseNode, on_change: Callable[[set[str]], None]) -> None:
        self._node = node
        self._on_change = on_change
        self._names = {row.name for row in PARAMETERS}
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
