"""A referee that knows neither grid nor queue accepts every contact of random scenes, and catches planted faults."""

import numpy as np
import pytest
from random_scenes import KINDS, random_scene
from referee import CIRCLE, WALL, Fault, replay

from circle_bounce_ros.kernel import ContactKind, Simulation
from circle_bounce_ros.kernel.engine import grid, loop, plan
from circle_bounce_ros.kernel.engine.records import NOTHING


def contacts_of(scene, until):
    simulation = Simulation(scene, record_contacts=True)
    simulation.advance_to(until)
    assert len(simulation._world.log) == simulation.contact_count
    return simulation.drain_contacts()


def duration(kind):
    return {'fast': 0.05, 'dense': 3.0}.get(kind, 20.0)


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
    def short_sighted(world, circle, side):
        return list(world.grid.members[circle.cell])

    monkeypatch.setattr(plan, 'gather', short_sighted)
    scene = random_scene('box', 0)
    with pytest.raises(Fault):
        replay(scene, contacts_of(scene, 20.0), 20.0)


def test_referee_catches_an_engine_that_forgets_a_wall():
    scene = random_scene('tilted', 0)
    contacts = contacts_of(scene, 20.0)
    wall = int(contacts['b'][contacts['kind'] == WALL][0])
    simulation = Simulation(scene, record_contacts=True)
    for flats in simulation._world.grid.flats:
        if wall in flats:
            flats.remove(wall)
    simulation.advance_to(20.0)
    with pytest.raises(Fault):
        replay(scene, simulation.drain_contacts(), 20.0)


def test_referee_catches_an_engine_that_acts_on_stale_plans(monkeypatch):
    monkeypatch.setattr(loop, '_is_contact', lambda world, i: world.moving[i].kind != NOTHING)
    caught = 0
    for seed in range(6):
        scene = random_scene('mixed', seed)
        try:
            replay(scene, contacts_of(scene, 20.0), 20.0)
        except Fault:
            caught += 1
    assert caught > 0


@pytest.mark.parametrize('kind', KINDS)
def test_the_grid_changes_no_bit(kind, monkeypatch):
    """With one cell list for all, every pair is looked at: an engine without a grid."""
    scene = random_scene(kind, 5)
    until = duration(kind)
    with_grid = contacts_of(scene, until)

    def everyone(world, circle, side):
        return list(range(len(world.moving)))

    monkeypatch.setattr(plan, 'gather', everyone)
    monkeypatch.setattr(grid, 'list_number', lambda grid, ix, iy: 0)
    without = Simulation(scene, record_contacts=True)
    world = without._world
    for lists, all_of in ((world.grid.locked, world.locked), (world.grid.flats, world.flats)):
        for members in lists:
            members[:] = range(len(all_of))
    without.advance_to(until)
    assert with_grid.tobytes() == without.drain_contacts().tobytes()
    assert (with_grid['kind'] == CIRCLE).any() == (kind != 'pass_through')
