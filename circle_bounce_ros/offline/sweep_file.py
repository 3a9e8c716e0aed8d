"""
A sweep as a small YAML file.

    scene: gas                                   a packaged scene, or a file beside this one
    parameters:                                  places in the scene file, each with the values it takes
      groups[0].packing: {from: 0.05, to: 0.45, steps: 9}
      groups[0].count: [250, 1000]
    seeds: {first: 0, count: 4}                  or a list
    duration: 60.0                               s, of which the first warm_up are not measured
    warm_up: 5.0                                 s
    rate: 20.0                                   Hz
    record: bag                                  or parquet; by default none
    topics: [poses]                              of the recordings; by default all

What would make every run fail is refused here, as is what would have no effect.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

from circle_bounce_ros.kernel import SceneError
from circle_bounce_ros.offline.observables import COLUMNS
from circle_bounce_ros.offline.plan import Plan, PlanError, keys_of, scene_with, under_parameters
from circle_bounce_ros.offline.sinks import BAG, PARQUET, TopicsError, topics_to_record
from circle_bounce_ros.scene_file import read_scene
from circle_bounce_ros.scene_file.loading import LARGEST_SEED
from circle_bounce_ros.scene_file.schema import check
from circle_bounce_ros.scene_file.wording import inside, named, shown

NONE = 'none'
RECORDS = (NONE, BAG, PARQUET)
DEFAULTS: dict[str, Any] = {
    'parameters': {},
    'seeds': [0],
    'warm_up': 0.0,
    'rate': 60.0,
    'record': NONE,
    'topics': None,
}
NEEDED = ('scene', 'duration')

# Their rows are in memory, 2 GB of them.
MOST_RUNS = 10**6

# Of a range: no scene has larger numbers.
LARGEST_VALUE = 1e60

# Keys of a scene file that are no parameters, and why.
NO_PARAMETERS = {
    'seed': 'is what `seeds` sets',
    'restart_after': 'has no effect, as a run does not start again',
    'description': 'has no effect',
}


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
    except (SceneError, PlanError) as error:
        place = f'{path}: {error.place}' if error.place else str(path)
        raise PlanError(place, error.problem) from None


def _plan(given: Any, folder: Path) -> Plan:
    if not isinstance(given, dict):
        raise PlanError('', f'must be keys and values, got {shown(given)}')
    known = [*NEEDED, *DEFAULTS]
    for key in given:
        if key not in known:
            raise PlanError(
                inside('', key), f'must be one of {", ".join(known)}, got an unknown key'
            )
    for key in NEEDED:
        if key not in given:
            raise PlanError(key, 'must be given, got nothing')
    data = DEFAULTS | given
    if data['record'] not in RECORDS:
        rule = f'must be one of {", ".join(RECORDS)}'
        raise PlanError('record', f'{rule}, got {shown(data["record"])}')
    name, scene = _scene(data['scene'], folder)
    seeds = _seeds(data['seeds'])
    parameters = _parameters(data['parameters'], MOST_RUNS // len(seeds))
    _check_scene(scene, parameters)
    duration = _number(data['duration'], 'duration', lambda value: value > 0.0, '> 0 s')
    warm_up = _number(
        data['warm_up'], 'warm_up', lambda value: 0.0 <= value < duration, 'from 0 to < duration'
    )
    rate = _number(data['rate'], 'rate', lambda value: value > 0.0, '> 0 Hz')
    plan = Plan(name, scene, parameters, seeds, duration, warm_up, rate, data['record'], None)
    try:
        plan.ticks()
    except ValueError as error:
        # It begins with the place, which is called the same here.
        place, _, problem = str(error).partition(': ')
        raise PlanError(place, problem) from None
    return plan if data['topics'] is None else _with_topics(plan, data['topics'])


def _scene(value: Any, folder: Path) -> tuple[str, dict[str, Any]]:
    if not isinstance(value, str):
        raise PlanError('scene', f'must be a name or a path, got {shown(value)}')
    is_path = '/' in value or value.endswith(('.yaml', '.yml'))
    try:
        scene = read_scene(folder / value if is_path else value)
    except SceneError as error:
        # A name that is unknown has this place already.
        place = ': '.join(filter(None, ['scene', named(value), error.place]))
        raise PlanError('scene' if error.place == 'scene' else place, error.problem) from None
    if not isinstance(scene, dict):
        raise PlanError('scene', f'must be a scene file, got {shown(value)}')
    return Path(value).stem, scene


def _with_topics(plan: Plan, topics: Any) -> Plan:
    """Return the plan with the topics to record, as far as the scene of the first run has them."""
    if plan.record == NONE:
        raise PlanError('topics', f'must go with record: {BAG} or {PARQUET}, got record: {NONE}')
    if not isinstance(topics, list) or not all(isinstance(topic, str) for topic in topics):
        raise PlanError('topics', f'must be a list of names, got {shown(topics)}')
    try:
        names = topics_to_record(topics, plan.build(plan.run(0)), plan.record)
    except TopicsError as error:
        raise PlanError('topics', error.problem) from None
    except SceneError:
        # Which is said of this run, while others may be fine.
        names = tuple(name.lstrip('/') for name in topics)
    return Plan(**plan.__dict__ | {'topics': names})


def _seeds(value: Any) -> tuple[int, ...]:
    if isinstance(value, dict) and set(value) == {'first', 'count'}:
        first, count = value['first'], value['count']
        if not _is_whole(count) or not 1 <= count <= MOST_RUNS:
            rule = f'must be a whole number from 1 to {MOST_RUNS}'
            raise PlanError('seeds.count', f'{rule}, got {shown(count)}')
        largest = LARGEST_SEED - count + 1
        if not _is_whole(first) or not 0 <= first <= largest:
            rule = f'must be a whole number from 0 to {largest}'
            raise PlanError('seeds.first', f'{rule}, got {shown(first)}')
        return tuple(range(first, first + count))
    if not isinstance(value, list) or not value:
        rule = 'must be a list of whole numbers or {first: N, count: N}'
        raise PlanError('seeds', f'{rule}, got {shown(value)}')
    for index, seed in enumerate(value):
        if not _is_whole(seed) or not 0 <= seed <= LARGEST_SEED:
            rule = f'must be a whole number from 0 to {LARGEST_SEED}'
            raise PlanError(f'seeds[{index}]', f'{rule}, got {shown(seed)}')
    _check_different(value, 'seeds')
    return tuple(value)


def _is_whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _number(value: Any, place: str, is_fine: Callable[[float], bool], rule: str) -> float:
    if not _is_number(value) or not is_fine(value):
        raise PlanError(place, f'must be {rule}, got {shown(value)}')
    return float(value)


def _check_different(values: list[Any], place: str) -> None:
    seen: set[Any] = set()
    for index, value in enumerate(values):
        # 1 and 1.0 are one value, true is none of them.
        what = float(value) if _is_number(value) else json.dumps(value, sort_keys=True)
        if what in seen:
            raise PlanError(f'{place}[{index}]', f'must be given once, got {shown(value)} again')
        seen.add(what)


def _parameters(given: Any, most: int) -> dict[str, list[Any]]:
    """Return the values of each place, of which there are `most` combinations at most."""
    if not isinstance(given, dict):
        raise PlanError('parameters', f'must be places and values, got {shown(given)}')
    counts = {place: _count(values, under_parameters(place)) for place, values in given.items()}
    if math.prod(counts.values()) > most:
        raise PlanError(
            'parameters', f'must make at most {MOST_RUNS} runs with all seeds, got more'
        )
    _check_places(given)
    return {place: _values(values, under_parameters(place)) for place, values in given.items()}


def _check_places(places: dict[str, Any]) -> None:
    """Refuse what sets the same thing twice, is not to be set, or is called as something else in a row."""
    seen: dict[tuple[str | int, ...], str] = {}
    for place in places:
        keys = tuple(keys_of(place))
        if keys[0] in NO_PARAMETERS:
            raise PlanError(
                under_parameters(place), f'must not be set: it {NO_PARAMETERS[keys[0]]}'
            )
        if place in COLUMNS:
            raise PlanError(
                under_parameters(place), 'must not be called as a column of the summary: set parts'
            )
        for other, name in seen.items():
            shorter = min(len(keys), len(other))
            if keys[:shorter] == other[:shorter]:
                raise PlanError(
                    under_parameters(place), f'must not be a part of {named(name)}, or it of this'
                )
        seen[keys] = place


def _count(given: Any, place: str) -> int:
    if isinstance(given, list) and given:
        return len(given)
    if not isinstance(given, dict) or set(given) != {'from', 'to', 'steps'}:
        rule = 'must be a list of values or {from: X, to: X, steps: N}'
        raise PlanError(place, f'{rule}, got {shown(given)}')
    for key in ('from', 'to'):
        if not _is_number(given[key]) or not abs(given[key]) <= LARGEST_VALUE:
            rule = f'must be a number from -{LARGEST_VALUE:g} to {LARGEST_VALUE:g}'
            raise PlanError(f'{place}.{key}', f'{rule}, got {shown(given[key])}')
    steps = given['steps']
    if not _is_whole(steps) or not 2 <= steps <= MOST_RUNS:
        rule = f'must be a whole number from 2 to {MOST_RUNS}'
        raise PlanError(f'{place}.steps', f'{rule}, got {shown(steps)}')
    return int(steps)


def _values(given: Any, place: str) -> list[Any]:
    values = (
        given if isinstance(given, list) else _range(given['from'], given['to'], given['steps'])
    )
    _check_different(values, place)
    return values


def _range(start: float, end: float, steps: int) -> list[float]:
    # Rounded, because 0.15000000000000002 is no value to write beside a point.
    return [float(f'{start + (end - start) * k / (steps - 1):.12g}') for k in range(steps)]


def _check_scene(scene: dict[str, Any], parameters: dict[str, list[Any]]) -> None:
    """Refuse a scene that is none, or a parameter that is nothing in it: judged by its first value."""
    data = scene_with(scene, {place: values[0] for place, values in parameters.items()})
    try:
        check(data)
    except SceneError as error:
        of_a_parameter = any(error.place.startswith(place) for place in parameters)
        outer = 'parameters.' if of_a_parameter else 'scene: ' if error.place else 'scene'
        raise PlanError(outer + error.place, error.problem) from None
