"""
A sweep as a small YAML file, and the runs that follow from it.

    scene: gas                                   a packaged scene, or a file beside this one
    parameters:                                  places in the scene file, each with the values it takes
      groups[0].packing: {from: 0.05, to: 0.45, steps: 9}
      groups[0].count: [250, 1000]
    seeds: {first: 0, count: 4}                  or a list
    duration: 60.0                               s, of which the first warm_up are not measured
    warm_up: 5.0                                 s
    rate: 20.0                                   Hz
    record: none                                 or bag, or parquet
    topics: [poses]                              of the recordings; by default all

Runs are numbered: the seeds go fastest, then the last parameter, the first one slowest.
"""

from __future__ import annotations

import copy
import hashlib
import json
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from circle_bounce_ros.kernel import Scene, SceneError
from circle_bounce_ros.scene_file import build_scene, read_scene
from circle_bounce_ros.schedule.recording import RecordingTicks

RECORDS = ('none', 'bag', 'parquet')
DEFAULTS: dict[str, Any] = {
    'parameters': {},
    'seeds': [0],
    'warm_up': 0.0,
    'rate': 60.0,
    'record': 'none',
    'topics': None,
}
NEEDED = ('scene', 'duration')
MOST_RUNS = 10**9

STEP = re.compile(r'([A-Za-z_]\w*)((?:\[\d+\])*)')


class PlanError(ValueError):
    """What is wrong with a sweep: place, rule and value, in one sentence."""


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
        data = copy.deepcopy(self.scene)
        data.pop('restart_after', None)
        for place, value in run.parameters.items():
            put(data, place, value)
        return build_scene(data, self.name, run.seed)

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
    """Return the plan that was dumped."""
    data = json.loads(text)
    data['seeds'] = tuple(data['seeds'])
    data['topics'] = None if data['topics'] is None else tuple(data['topics'])
    return Plan(**data)


def load_plan(path: Path) -> Plan:
    """
    Return the sweep that a file describes.

    Raises
    ------
    PlanError
        For what is wrong with it, which begins with the file.

    """
    try:
        return _plan(read_scene(path), path.parent)
    except SceneError as error:
        text = str(error)
        raise PlanError(text if text.startswith(str(path)) else f'{path}: {text}') from None
    except PlanError as error:
        raise PlanError(f'{path}: {error}') from None


def _plan(given: Any, folder: Path) -> Plan:
    if not isinstance(given, dict):
        raise PlanError(f'must be keys and values, got {type(given).__name__}')
    known = [*NEEDED, *DEFAULTS]
    for key in given:
        if key not in known:
            raise PlanError(f'{key}: must be one of {", ".join(known)}')
    for key in NEEDED:
        if key not in given:
            raise PlanError(f'{key}: is needed')
    data = DEFAULTS | given
    name, scene = _scene(data['scene'], folder)
    parameters = _parameters(data['parameters'], scene)
    duration = _number(data['duration'], 'duration', lambda value: value > 0.0, '> 0 s')
    warm_up = _number(
        data['warm_up'], 'warm_up', lambda value: 0.0 <= value < duration, 'from 0 to < duration'
    )
    rate = _number(data['rate'], 'rate', lambda value: value > 0.0, '> 0 Hz')
    if data['record'] not in RECORDS:
        raise PlanError(f'record: must be one of {", ".join(RECORDS)}, got {data["record"]!r}')
    seeds = _seeds(data['seeds'])
    plan = Plan(
        name, scene, parameters, seeds, duration, warm_up, rate, data['record'], _topics(data)
    )
    try:
        plan.ticks()
    except ValueError as error:
        raise PlanError(str(error)) from None
    if len(plan) > MOST_RUNS:
        raise PlanError(f'parameters and seeds: must make at most {MOST_RUNS} runs')
    return plan


def _scene(value: Any, folder: Path) -> tuple[str, dict[str, Any]]:
    if not isinstance(value, str):
        raise PlanError(f'scene: must be a name or a path, got {value!r}')
    is_path = '/' in value or value.endswith(('.yaml', '.yml'))
    scene = read_scene(folder / value if is_path else value)
    if not isinstance(scene, dict):
        raise PlanError(f'scene: must be a scene file, got {value!r}')
    return Path(value).stem, scene


def _topics(data: dict[str, Any]) -> tuple[str, ...] | None:
    topics = data['topics']
    if topics is None:
        return None
    if not isinstance(topics, list) or not all(isinstance(topic, str) for topic in topics):
        raise PlanError(f'topics: must be a list of names, got {topics!r}')
    return tuple(topics)


def _seeds(value: Any) -> tuple[int, ...]:
    rule = 'must be a list of different whole numbers or {first: N, count: N}'
    if isinstance(value, dict) and set(value) == {'first', 'count'}:
        first, count = value['first'], value['count']
        if _is_whole(first) and _is_whole(count) and first >= 0 and 0 < count <= MOST_RUNS:
            return tuple(range(first, first + count))
    is_list = isinstance(value, list) and value and all(_is_whole(seed) for seed in value)
    if is_list and len(set(value)) == len(value):
        return tuple(value)
    raise PlanError(f'seeds: {rule}, got {value!r}')


def _is_whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _number(value: Any, place: str, is_fine: Callable[[float], bool], rule: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not is_fine(value):
        raise PlanError(f'{place}: must be {rule}, got {value!r}')
    return float(value)


def _parameters(given: Any, scene: dict[str, Any]) -> dict[str, list[Any]]:
    if not isinstance(given, dict):
        raise PlanError(f'parameters: must be places and values, got {given!r}')
    parameters = {}
    for place, values in given.items():
        where = f'parameters.{place}'
        parameters[place] = _values(values, where)
        try:
            put(copy.deepcopy(scene), place, parameters[place][0])
        except PlanError as error:
            raise PlanError(f'{where}: {error}') from None
    return parameters


def _values(given: Any, where: str) -> list[Any]:
    if isinstance(given, list) and given:
        return given
    if isinstance(given, dict) and set(given) == {'from', 'to', 'steps'}:
        start, end, steps = given['from'], given['to'], given['steps']
        numbers = all(
            isinstance(value, (int, float)) and not isinstance(value, bool)
            for value in (start, end)
        )
        if numbers and _is_whole(steps) and 2 <= steps <= MOST_RUNS:
            # Rounded, because 0.15000000000000002 is no value to write beside a point.
            return [float(f'{start + (end - start) * k / (steps - 1):.12g}') for k in range(steps)]
    raise PlanError(
        f'{where}: must be a list of values or {{from: X, to: X, steps: N}}, got {given!r}'
    )


def put(data: Any, place: str, value: Any) -> None:
    """
    Put a value to a place in plain data, such as `groups[0].speed.maxwell`.

    Raises
    ------
    PlanError
        For a place that leads nowhere. Only the last key of it may be new.

    """
    keys = _keys(place)
    for key in keys[:-1]:
        data = _inside(data, key, place)
    last = keys[-1]
    if isinstance(last, int):
        _inside(data, last, place)
    elif not isinstance(data, dict):
        raise PlanError(f'{place}: leads nowhere in the scene, {last} has nothing to be in')
    data[last] = value


def _keys(place: Any) -> list[str | int]:
    keys: list[str | int] = []
    for part in str(place).split('.'):
        found = STEP.fullmatch(part)
        if not found:
            raise PlanError(f'must look like groups[0].packing, got {place!r}')
        keys += [found[1], *(int(number) for number in re.findall(r'\d+', found[2]))]
    return keys


def _inside(data: Any, key: str | int, place: str) -> Any:
    try:
        return data[key]
    except (KeyError, IndexError, TypeError):
        raise PlanError(f'{place}: leads nowhere in the scene, there is no {key}') from None
