"""
A sweep as plain data, and the runs that follow from it.

Runs are numbered: the seeds go fastest, then the last parameter, the first one slowest.
"""

from __future__ import annotations

import copy
import hashlib
import json
import math
import re
from dataclasses import dataclass
from typing import Any, NamedTuple

from circle_bounce_ros.kernel import Scene
from circle_bounce_ros.scene_file import build_scene
from circle_bounce_ros.scene_file.wording import named, shown
from circle_bounce_ros.schedule.recording import RecordingTicks

STEP = re.compile(r'([A-Za-z_]\w*)((?:\[\d{1,9}\])*)')


class PlanError(ValueError):
    """
    What is wrong with a sweep: the place, the rule and the value, in one sentence.

    Attributes
    ----------
    place : str
        For instance `parameters.groups[0].packing`; empty for the sweep as a whole.
    problem : str
        For instance `must be > 0 s, got -1`.

    """

    def __init__(self, place: str, problem: str) -> None:
        super().__init__(f'{place}: {problem}' if place else problem)
        self.place = place
        self.problem = problem


class Run(NamedTuple):
    """
    One simulation of a sweep.

    Attributes
    ----------
    number : int
    seed : int
    parameters : dict
        Values by place in the scene file.

    """

    number: int
    seed: int
    parameters: dict[str, Any]


@dataclass(frozen=True)
class Plan:
    """
    All runs of a sweep, without making a list of them.

    Attributes
    ----------
    name : str
        Of the scene.
    scene : dict
        Of the scene file, as plain data.
    parameters : dict
        A list of values for each place in the scene file.
    seeds : tuple of int
    duration, warm_up : float, s
    rate : float, Hz
    record : str
    topics : tuple of str or None
        As the topics or tables are called.

    """

    name: str
    scene: dict[str, Any]
    parameters: dict[str, list[Any]]
    seeds: tuple[int, ...]
    duration: float
    warm_up: float
    rate: float
    record: str
    topics: tuple[str, ...] | None

    def __len__(self) -> int:
        return math.prod(map(len, self.parameters.values())) * len(self.seeds)

    def run(self, number: int) -> Run:
        """Return the run of a number."""
        left, seed = divmod(number, len(self.seeds))
        values: dict[str, Any] = {}
        for place, choices in reversed(self.parameters.items()):
            left, choice = divmod(left, len(choices))
            values[place] = choices[choice]
        return Run(number, self.seeds[seed], {place: values[place] for place in self.parameters})

    def build(self, run: Run) -> Scene:
        """
        Return the scene of a run. It goes on to the end: a run does not start again.

        Raises
        ------
        SceneError
            When the scene cannot be with these parameters.

        """
        return build_scene(scene_with(self.scene, run.parameters), self.name, run.seed)

    def ticks(self) -> RecordingTicks:
        """Return the ticks of each run."""
        return RecordingTicks(self.rate, self.duration)

    def dump(self) -> str:
        """Return the plan as JSON, from which `restore` makes the same one."""
        return json.dumps(self.__dict__, indent=1) + '\n'

    def digest(self) -> str:
        """Return what tells plans apart."""
        return hashlib.sha256(self.dump().encode()).hexdigest()


def restore(text: str) -> Plan:
    """
    Return the plan that was dumped.

    Raises
    ------
    ValueError
        For a text that is no plan.

    """
    try:
        data = json.loads(text)
        data['seeds'] = tuple(data['seeds'])
        data['topics'] = None if data['topics'] is None else tuple(data['topics'])
        return Plan(**data)
    except (KeyError, TypeError, RecursionError) as error:
        raise ValueError(f'is no plan of a sweep: {error}') from None


def scene_with(scene: dict[str, Any], parameters: dict[str, Any]) -> dict[str, Any]:
    """
    Return a copy of a scene, as plain data, with values at their places and without `restart_after`.

    Raises
    ------
    PlanError
        For a place that leads nowhere.

    """
    data = copy.deepcopy(scene)
    data.pop('restart_after', None)
    for place, value in parameters.items():
        put(data, place, value)
    return data


def put(data: Any, place: str, value: Any) -> None:
    """
    Put a value to a place in plain data, such as `groups[0].speed.maxwell`.

    Raises
    ------
    PlanError
        For a place that leads nowhere. Only the last key of it may be new.

    """
    *way, last = keys_of(place)
    for key in way:
        if not _holds(data, key):
            raise _leads_nowhere(place, key)
        data = data[key]
    may_be_new = isinstance(last, str) and isinstance(data, dict)
    if not may_be_new and not _holds(data, last):
        raise _leads_nowhere(place, last)
    data[last] = value


def under_parameters(place: str) -> str:
    """Return how an error names a parameter."""
    return f'parameters.{named(place)}'


def _leads_nowhere(place: str, key: str | int) -> PlanError:
    return PlanError(
        under_parameters(place), f'must be a place in the scene, got no {named(str(key))} there'
    )


def _holds(data: Any, key: str | int) -> bool:
    if isinstance(key, int):
        return isinstance(data, list) and key < len(data)
    return isinstance(data, dict) and key in data


def keys_of(place: str) -> list[str | int]:
    """
    Return the keys on the way to a place.

    Raises
    ------
    PlanError
        For what is no place.

    """
    keys: list[str | int] = []
    for part in place.split('.'):
        found = STEP.fullmatch(part)
        if not found:
            raise PlanError(
                'parameters', f'must be places like groups[0].packing, got {shown(place)}'
            )
        keys += [found[1], *(int(number) for number in re.findall(r'\d+', found[2]))]
    return keys
