"""A referee that knows neither grid nor queue accepts every contact of random scenes, and catches planted faults."""

import random

import numpy as np
import pytest
from random_scenes import KINDS, place, random_scene, two_levels
from referee import CIRCLE, WALL, Fault, replay

from circle_bounce_ros.kernel import Circle, ContactKind, Scene, Simulation, Wall
from circle_bounce_ros.kernel.engine import (
    broad_phase,
    build,
    engines,
    grid_layout,
    loop,
    prediction,
)
from circle_bounce_ros.kernel.engine.records import CIRCLES_AT, COUNT_AT, NOTHING


def contacts_of(scene, until, **options):
    simulation = Simulation(scene, record_contacts=True, **options)
    simulation.advance_to(until)
    contacts = simulation.drain_contacts()
    assert len(contacts) == simulation.contact_count
    return contacts


def duration(kind):
    return {'fast': 0.05, 'dense': 3.0, 'sizes': 4.0}.get(kind, 20.0)


@pytest.mark.parametrize('kind', KINDS)
def test_every_contact_is_the_earliest_possible_one(kind):
    accepted = 0
    for seed in range(12):
        scene = random_scene(kind, seed)
        until = duration(kind)
        accepted += replay(scene, contacts_of(scene, until), until)
    # Known from the density: fewer would mean that the scenes are empty.
    assert accepted > 250


def test_the_random_scenes_have_contacts_of_every_kind():
    kinds = set()
    for kind in KINDS:
        for seed in range(3):
            kinds |= set(contacts_of(random_scene(kind, seed), duration(kind))['kind'].tolist())
    assert kinds == {int(kind) for kind in ContactKind}


def test_every_contact_is_the_earliest_possible_one_on_two_levels_of_cells():
    scene = two_levels(0)
    assert Simulation(scene)._engine.world.levels == 2
    assert replay(scene, contacts_of(scene, 2.0), 2.0) > 150


def test_referee_catches_an_engine_whose_large_circles_look_no_further_than_small_ones(
    monkeypatch,
):
    monkeypatch.setattr(broad_phase, 'FAR', broad_phase.NEAR)
    scene = two_levels(0)
    with pytest.raises(Fault):
        replay(scene, contacts_of(scene, 10.0, compiled=False), 10.0)


@pytest.fixture
def honest():
    scene = random_scene('box', 0)
    contacts = contacts_of(scene, 20.0)
    assert replay(scene, contacts, 20.0) > 50
    return scene, contacts


def test_referee_catches_a_contact_left_out(honest):
    scene, contacts = honest
    for left_out in (0, 20, len(contacts) - 1):
        with pytest.raises(Fault):
            replay(scene, np.delete(contacts, left_out), 20.0)


@pytest.mark.parametrize(
    ('field', 'change'),
    [
        ('time', lambda v: v + 1e-6),
        ('b', lambda v: (v + 1) % 4),
        ('nx', lambda v: v + 1e-3),
        ('impulse', lambda v: 1.001 * v),
        ('x', lambda v: v + 1e-6),
        ('ax0', lambda v: -v),
        ('ay1', lambda v: v + 1e-3),
        ('bx1', lambda v: v + 1e-3),
    ],
)
def test_referee_catches_a_forged_contact(honest, field, change):
    scene, contacts = honest
    forged = contacts.copy()
    row = int(np.flatnonzero(forged['kind'] == WALL)[3])
    forged[field][row] = change(forged[field][row])
    with pytest.raises(Fault):
        replay(scene, forged, 20.0)


def test_referee_catches_an_engine_that_looks_in_its_own_cell_only(monkeypatch):
    def short_sighted(world, table, cell, side, reach, count):
        at = broad_phase.list_at(table, cell)
        members = world.lists[at + COUNT_AT]
        at += CIRCLES_AT
        world.candidates[count : count + members] = world.lists[at : at + members]
        return count + members

    monkeypatch.setattr(broad_phase, 'query_cells', short_sighted)
    scene = random_scene('box', 0)
    with pytest.raises(Fault):
        replay(scene, contacts_of(scene, 20.0, compiled=False), 20.0)


def test_referee_catches_an_engine_that_forgets_a_wall():
    scene = random_scene('tilted', 0)
    contacts = contacts_of(scene, 20.0)
    wall = int(contacts['b'][contacts['kind'] == WALL][0])
    simulation = Simulation(scene, record_contacts=True, compiled=False)
    numbers = simulation._engine.world.segment_numbers
    numbers[:] = [
        (number + 1) % len(scene.walls) if number == wall else number for number in numbers
    ]
    simulation.advance_to(20.0)
    with pytest.raises(Fault):
        replay(scene, simulation.drain_contacts(), 20.0)


def test_referee_catches_an_engine_that_acts_on_void_events(monkeypatch):
    monkeypatch.setattr(loop, 'is_contact', lambda world, circle: circle.kind != NOTHING)
    caught = 0
    for seed in range(6):
        scene = random_scene('mixed', seed)
        try:
            replay(scene, contacts_of(scene, 20.0, compiled=False), 20.0)
        except Fault:
            caught += 1
    assert caught > 0


@pytest.mark.parametrize('kind', KINDS)
def test_the_grid_changes_no_bit(kind, monkeypatch):
    """Everybody looks at everybody and at all that is locked: an engine without a grid."""
    scene = random_scene(kind, 5)
    until = duration(kind)
    with_grid = contacts_of(scene, until)
    monkeypatch.setattr(
        broad_phase, 'query_neighbours', lambda world, circle, side: broad_phase.query_all(world)
    )
    monkeypatch.setattr(prediction, 'query_neighbours', broad_phase.query_neighbours)
    without = Simulation(scene, record_contacts=True, compiled=False)
    world = without._engine.world
    world.candidates.extend([0] * len(world.moving))
    world.disk_numbers[:] = range(len(world.disks))
    world.segment_numbers[:] = range(len(world.segments))
    for reach in world.reaches:
        reach.first_disk, reach.end_disk = 0, len(world.disks)
        reach.first_segment, reach.end_segment = 0, len(world.segments)
    without.advance_to(until)
    assert with_grid.tobytes() == without.drain_contacts().tobytes()
    assert (with_grid['kind'] == CIRCLE).any() == (kind != 'pass_through')


def test_the_random_scenes_have_several_levels_of_cells():
    scene = random_scene('sizes', 0)
    assert Simulation(scene, compiled=False)._engine.world.levels == 2


@pytest.mark.parametrize('kind', KINDS)
def test_levels_of_cells_change_no_bit(kind, monkeypatch):
    """As many levels as sizes allow, against those that are worth their while."""
    scene = random_scene(kind, 6)
    ordinary = contacts_of(scene, duration(kind))
    monkeypatch.setattr(grid_layout, 'SPLIT_ABOVE', 0.01)
    monkeypatch.setattr(grid_layout, 'GAPS_A_CELL_OF_LEVELS', 0.1)
    many = Simulation(scene, record_contacts=True, compiled=False)
    if kind in ('mixed', 'sizes'):
        assert many._engine.world.levels >= 2
    many.advance_to(duration(kind))
    assert ordinary.tobytes() == many.drain_contacts().tobytes()


@pytest.mark.parametrize('kind', KINDS)
def test_the_order_in_memory_changes_no_bit(kind, monkeypatch):
    scene = random_scene(kind, 1)
    ordinary = Simulation(scene, record_contacts=True)
    ordinary.advance_to(duration(kind))
    monkeypatch.setattr(build, 'MORTON_ABOVE', 1)
    sorted_ = Simulation(scene, record_contacts=True)
    moving_indices = [
        circle.moving_index
        for circle in build.build(scene, keep_log=False).moving.view(np.recarray)
    ]
    assert moving_indices != sorted(moving_indices)
    sorted_.advance_to(duration(kind))
    assert ordinary.positions.tobytes() == sorted_.positions.tobytes()
    assert ordinary.velocities.tobytes() == sorted_.velocities.tobytes()
    assert ordinary.drain_contacts().tobytes() == sorted_.drain_contacts().tobytes()


@pytest.mark.parametrize('compiled', [False, True])
def test_lists_and_logs_that_are_full_get_room(compiled, monkeypatch):
    """A cloud falls in on itself: cells fill up far beyond what they held at the start."""
    if compiled:
        pytest.importorskip(
            'numba', reason='numba is not installed: there is only the plain engine'
        )
    rng = random.Random(8)
    circles = [
        Circle(c.position, (-c.position[0], -c.position[1]), radius=c.radius)
        for c in place(rng, 150, [0.5] + [0.05] * 30, 10.0)
    ]
    scene = Scene(circles, [Wall((-11.0, -11.0), (-11.0, 11.0))])
    ordinary = contacts_of(scene, 3.0, compiled=compiled)
    monkeypatch.setattr(build, 'LOG_BLOCK', 7)
    monkeypatch.setattr(grid_layout, 'GAPS_A_CELL', 2.0)
    simulation = Simulation(scene, record_contacts=True, compiled=compiled)
    before = len(simulation._engine.world.lists)
    simulation.advance_to(3.0)
    assert len(simulation._engine.world.lists) > before
    contacts = simulation.drain_contacts()
    assert contacts.tobytes() == ordinary.tobytes()
    assert replay(scene, contacts, 3.0) > 100


@pytest.mark.parametrize('kind', KINDS)
def test_plain_and_compiled_code_give_the_same_bits(kind):
    pytest.importorskip('numba', reason='numba is not installed: there is only the plain engine')
    scene = random_scene(kind, 2)
    plain = contacts_of(scene, duration(kind), compiled=False)
    assert len(plain) > 20
    assert plain.tobytes() == contacts_of(scene, duration(kind), compiled=True).tobytes()


@pytest.mark.parametrize('compiled', [False, True])
@pytest.mark.parametrize('kind', KINDS)
def test_prefetching_changes_no_bit(kind, compiled, monkeypatch):
    if compiled:
        pytest.importorskip(
            'numba', reason='numba is not installed: there is only the plain engine'
        )
    scene = random_scene(kind, 2)
    straight = contacts_of(scene, duration(kind), compiled=compiled)
    monkeypatch.setattr(build, 'PREFETCH_ABOVE', 0)
    ahead = Simulation(scene, record_contacts=True, compiled=compiled)
    if not compiled:
        ahead._engine.world.prefetches = True  # plain code never does: it would only take time
    assert ahead._engine.world.prefetches
    ahead.advance_to(duration(kind))
    assert len(straight) > 20
    assert straight.tobytes() == ahead.drain_contacts().tobytes()


@pytest.mark.parametrize('seed', range(4))
def test_a_circle_that_moves_alone_does_what_the_queue_would_make_it_do(seed, monkeypatch):
    crowded = random_scene('mixed', seed)
    moving = [circle for circle in crowded.circles if not circle.locked]
    locked = [circle for circle in crowded.circles if circle.locked]
    scene = Scene([moving[0], *locked], crowded.walls)
    alone = contacts_of(scene, 5_000.0)  # so long that clocks are set back
    monkeypatch.setattr(engines, 'Independent', engines.Interacting)
    assert len(alone) > 200
    assert alone.tobytes() == contacts_of(scene, 5_000.0).tobytes()


def test_circles_followed_alone_do_what_the_queue_would_make_them_do(monkeypatch):
    """Circles that pass through each other have a short cut of their own: same contacts, same bits."""
    scene = random_scene('pass_through', 4)
    alone = contacts_of(scene, 100.0)
    monkeypatch.setattr(engines, 'Independent', engines.Interacting)
    one_by_one = [
        contacts_of(Scene([circle, *(c for c in scene.circles if c.locked)], scene.walls), 100.0)
        for circle in scene.circles
        if not circle.locked
    ]
    assert len(alone) == sum(map(len, one_by_one))
    moving = [i for i, c in enumerate(scene.circles) if not c.locked]
    for i, contacts in zip(moving, one_by_one, strict=True):
        mine = alone[alone['a'] == i]
        assert np.allclose(mine['time'], contacts['time'], rtol=0, atol=1e-9)
        assert mine['kind'].tolist() == contacts['kind'].tolist()
