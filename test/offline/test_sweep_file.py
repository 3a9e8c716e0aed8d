"""A sweep file: which runs follow from it, and what is refused before the first of them."""

from __future__ import annotations

import math

import pytest
from conftest import perform_here

from circle_bounce_ros.offline.plan import PlanError, restore
from circle_bounce_ros.offline.sweep_file import load_plan


def test_every_combination_of_parameters_and_seeds_is_a_run(write_sweep):
    plan = load_plan(
        write_sweep(
            parameters={'groups[0].packing': [0.1, 0.2], 'groups[0].speed.maxwell': [1, 2]}
        )
    )
    runs = [plan.run(k) for k in range(len(plan))]
    seen = [(r.seed, *r.parameters.values()) for r in runs]
    assert seen == [(s, p, v) for p in (0.1, 0.2) for v in (1, 2) for s in (5, 6)]
    scene = plan.build(runs[-1])
    assert scene.seed == 6
    area = sum(math.pi * circle.radius**2 for circle in scene.circles)
    assert area / 4.0 == pytest.approx(0.2)
    assert restore(plan.dump()) == plan


PACKING = 'groups[0].packing'


@pytest.mark.parametrize(
    ('changes', 'place'),
    [
        ({'sedes': 1}, 'sedes'),
        ({'observables': ['pressure']}, 'observables'),
        ({'duration': -1}, 'duration'),
        ({'duration': True}, 'duration'),
        ({'duration': 1e9, 'rate': 1e6}, 'duration'),  # 10^15 ticks
        ({'warm_up': 4.0}, 'warm_up'),
        ({'rate': 0.01}, 'duration'),
        ({'record': 'tape'}, 'record'),
        ({'record': ['bag']}, 'record'),
        ({'scene': 'gaz'}, 'scene'),
        ({'scene': './nothing.yaml'}, 'scene: ./nothing.yaml'),
        ({'seeds': []}, 'seeds'),
        ({'seeds': 3}, 'seeds'),
        ({'seeds': [1, 1]}, 'seeds[1]'),
        ({'seeds': [1, -1]}, 'seeds[1]'),
        ({'seeds': [2**63]}, 'seeds[0]'),
        ({'seeds': {'first': -1, 'count': 2}}, 'seeds.first'),
        ({'seeds': {'first': 2**63 - 1, 'count': 2}}, 'seeds.first'),
        ({'seeds': {'first': 0, 'count': 10**9}}, 'seeds.count'),
        ({'parameters': [PACKING]}, 'parameters'),
        ({'parameters': {'groups[0]packing': [1]}}, 'parameters'),
        ({'parameters': {'groups[1].packing': [1]}}, 'parameters.groups[1].packing'),
        ({'parameters': {'walls[0].box.min[2]': [1]}}, 'parameters.walls[0].box.min[2]'),
        ({'parameters': {'groups.packing': [1]}}, 'parameters.groups.packing'),
        ({'parameters': {'groups[0].pakcing': [0.1]}}, 'parameters.groups[0].pakcing'),
        ({'parameters': {PACKING: [-0.1, 0.2]}}, 'parameters.groups[0].packing'),
        ({'parameters': {PACKING: 3}}, 'parameters.groups[0].packing'),
        ({'parameters': {PACKING: [0.1, 0.2, 0.1]}}, 'parameters.groups[0].packing[2]'),
        ({'parameters': {PACKING: {'from': 0.1, 'to': 0.1, 'steps': 2}}}, 'parameters.groups[0].packing[1]'),
        ({'parameters': {PACKING: {'from': 'a', 'to': 1, 'steps': 2}}}, 'parameters.groups[0].packing.from'),
        ({'parameters': {PACKING: {'from': -1e308, 'to': 1e308, 'steps': 2}}}, 'parameters.groups[0].packing.from'),
        ({'parameters': {PACKING: {'from': 0.1, 'to': 0.2, 'steps': 10**9}}}, 'parameters.groups[0].packing.steps'),
        # Each range is in order, both together are not.
        ({'parameters': {
            PACKING: {'from': 0.1, 'to': 0.2, 'steps': 10**6},
            'groups[0].speed.maxwell': {'from': 0.1, 'to': 0.2, 'steps': 10**6},
        }}, 'parameters'),
        ({'parameters': {PACKING: {'from': 0.1, 'to': 0.2, 'steps': 10**6}}}, 'parameters'),  # and two seeds
        # Set by the sweep itself, of no effect, or another column of a row.
        ({'parameters': {'seed': [5, 6]}}, 'parameters.seed'),
        ({'parameters': {'restart_after': [1, 2]}}, 'parameters.restart_after'),
        ({'parameters': {'description': ['a']}}, 'parameters.description'),
        ({'parameters': {'circles': [[]]}}, 'parameters.circles'),
        # Set twice.
        ({'parameters': {PACKING: [0.1], 'groups[00].packing': [0.2]}}, 'parameters.groups[00].packing'),
        ({'parameters': {'groups[0].speed.maxwell': [1], 'groups[0].speed': [1]}}, 'parameters.groups[0].speed'),
        ({'topics': ['poses']}, 'topics'),  # of recordings that are not made
        ({'record': 'bag', 'topics': 'poses'}, 'topics'),
        ({'record': 'bag', 'topics': []}, 'topics'),
        ({'record': 'bag', 'topics': ['bodys']}, 'topics'),
        ({'record': 'bag', 'topics': ['poses', '/poses']}, 'topics'),
        ({'record': 'bag', 'topics': ['green/pose']}, 'topics'),
        ({'record': 'bag', 'topics': ['//poses']}, 'topics'),
        ({'record': 'parquet', 'topics': ['poses']}, 'topics'),
    ],
)  # fmt: skip
def test_what_no_run_could_be_made_of_is_refused(write_sweep, changes, place):
    path = write_sweep(**changes)
    with pytest.raises(PlanError) as caught:
        load_plan(path)
    # The limits of ticks are those of recordings, whose errors have no place of their own.
    assert str(caught.value).startswith(f'{path}: {place}: must ')


def test_an_error_says_file_place_rule_and_value(write_sweep):
    path = write_sweep(seeds=[3, 4, 3])
    with pytest.raises(PlanError) as caught:
        load_plan(path)
    assert str(caught.value) == f'{path}: seeds[2]: must be given once, got 3 again'


@pytest.mark.parametrize('name', ['a\n\u202eb', 'x' * 10_000])
@pytest.mark.parametrize(
    'changes',
    [
        lambda name: {name: 1},
        lambda name: {'scene': f'{name}.yaml'},
        lambda name: {'scene': name},
        lambda name: {'parameters': {name: [1]}},
        lambda name: {'parameters': {name: 3}},
        lambda name: {'parameters': {f'groups[0].{name}': [0.1]}},
        lambda name: {'record': 'bag', 'topics': [name]},
    ],
)
def test_an_error_is_one_short_line_whatever_things_are_called(write_sweep, changes, name):
    path = write_sweep(**changes(name))
    with pytest.raises(PlanError) as caught:
        load_plan(path)
    sentence = str(caught.value).removeprefix(str(path))
    assert sentence.isprintable()
    assert len(sentence) < 600


@pytest.mark.parametrize('topics', [['bodies', 'clock'], ['/bodies', '/clock']])
def test_topics_are_recorded_with_and_without_a_leading_slash(write_sweep, topics):
    assert load_plan(write_sweep(record='bag', topics=topics)).topics == ('bodies', '/clock')


def test_topics_of_a_circle_that_a_run_lacks_are_said_of_that_run(
    tmp_path, write_scene, write_sweep
):
    circle = {'position': [0, 0], 'velocity': [1, 0], 'radius': 0.1, 'name': 'a'}
    write_scene('named', circles=[circle])
    sweep = write_sweep(
        scene='./named.yaml', parameters={'circles[0].name': ['a', 'b']}, record='bag',
        topics=['a/pose'], seeds=[0],
    )  # fmt: skip
    first, second = perform_here(sweep, tmp_path / 'out')
    assert first['contacts'] == 0
    assert second['error'].startswith('TopicsError: topics: must be from ')


def test_a_million_runs_are_planned_in_no_time_of_note(write_sweep):
    steps = {'from': 0.1, 'to': 0.3, 'steps': 1000}
    plan = load_plan(write_sweep(parameters={PACKING: steps}, seeds={'first': 0, 'count': 1000}))
    assert len(plan) == 10**6
    assert plan.run(10**6 - 1) == (10**6 - 1, 999, {PACKING: 0.3})
