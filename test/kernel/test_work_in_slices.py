"""`at_most` bounds the work of a call, every call gets on, and the bits are those of one call."""

import math

import numpy as np
import pytest
from random_scenes import box, random_scene

from circle_bounce_ros.kernel import Circle, EndlessContactsError, Scene, Simulation, Wall

CELLS = 8_192  # of the longest way across the cells that one step may take


def in_slices(scene, until, at_most, most_calls, **options):
    """Go to a time in slices; return the simulation and, of each call, what it did and the time it left."""
    simulation = Simulation(scene, record_contacts=True, **options)
    calls = []
    arrived = False
    while not arrived:
        before, contacts = simulation._engine.get('events'), simulation.contact_count
        arrived = simulation.advance_to(until, at_most=at_most)
        calls.append((simulation._engine.get('events') - before, simulation.time))
        assert simulation.contact_count - contacts <= at_most
        assert len(calls) <= most_calls
    return simulation, calls


def state_of(simulation):
    return simulation.positions.tobytes() + simulation.velocities.tobytes()


def slot(clearance, speed=1.0, count=3):
    """Return circles that rattle through a slot a little wider than they are, and pass through each other."""
    height = 0.2 + clearance
    walls = [Wall((0.0, 0.0), (50.0, 0.0)), Wall((0.0, height), (50.0, height))]
    rattling = [
        Circle((1.0 + k, height / 2), (speed, speed * (0.5 + k)), radius=0.1) for k in range(count)
    ]
    return Scene(rattling, walls, moving_circles_collide=False)


ODD = {
    'a slot with little clearance': (slot(1e-5), 0.05),
    'one circle in such a slot': (slot(1e-5, count=1), 0.05),
    'a very light circle': (
        Scene(
            [
                Circle((x, 0.0), (1.0, 0.3), radius=0.1, mass=m)
                for x, m in ((0.0, 1e-12), (1.0, 1.0))
            ],
            box(-2, -2, 2, 2),
            moving_circles_collide=False,
        ),
        50.0,
    ),
    'a light circle that hits others': (
        Scene(
            [
                Circle((x, 0.0), (x, 0.3), radius=0.1, mass=m)
                for x, m in ((-1.0, 1e-12), (1.0, 1.0))
            ],
            box(-2, -2, 2, 2),
        ),
        40.0,
    ),
    'a very small circle': (
        Scene([Circle((0.1, 0.2), (0.7, 0.4), radius=1e-9)], box(-1, -1, 1, 1)),
        100.0,
    ),
}


@pytest.mark.parametrize('name', ODD)
def test_a_call_does_no_more_than_it_may_and_always_gets_on(name):
    scene, until = ODD[name]
    whole = Simulation(scene, record_contacts=True)
    whole.advance_to(until)
    steps = whole._engine.get('events')
    simulation, calls = in_slices(scene, until, 100, most_calls=steps // 100 + 2)
    assert max(done for done, _ in calls) <= 100 + CELLS
    assert all(done >= 100 for done, _ in calls[:-1])
    times = [time for _, time in calls]
    assert times == sorted(times)
    assert simulation.contact_count == whole.contact_count > 10
    assert state_of(simulation) == state_of(whole)
    assert simulation.drain_contacts().tobytes() == whole.drain_contacts().tobytes()


@pytest.mark.parametrize('at_most', [1, 2, 17])
def test_where_circles_pass_through_each_other_a_cut_leaves_all_at_one_time(at_most):
    scene = random_scene('pass_through', 7)
    whole = Simulation(scene, record_contacts=True)
    whole.advance_to(80.0)
    contacts = whole.drain_contacts()
    sliced = Simulation(scene, record_contacts=True)
    log = []
    while not sliced.advance_to(80.0, at_most=at_most):
        log += sliced.drain_contacts().tolist()
        # All that is due until then and nothing beyond.
        assert len(log) == np.searchsorted(contacts['time'], sliced.time, side='right')
    log += sliced.drain_contacts().tolist()
    assert log == contacts.tolist()
    assert len(log) > 100


def test_calls_with_and_without_a_limit_may_take_turns():
    scene = random_scene('pass_through', 3)
    whole, mixed = (Simulation(scene, record_contacts=True) for _ in range(2))
    whole.advance_to(60.0)
    for k in range(1, 61):
        mixed.advance_to(k - 0.5)
        while not mixed.advance_to(float(k), at_most=3):
            pass
    assert state_of(whole) == state_of(mixed)
    assert whole.drain_contacts().tobytes() == mixed.drain_contacts().tobytes()


@pytest.mark.parametrize('collide', [True, False])
@pytest.mark.parametrize('at_most', [0, -1, math.nan])
def test_a_limit_that_allows_nothing_is_refused(at_most, collide):
    pair = [Circle((x, 0.0), (1.0, 0.0), radius=0.5) for x in (0.0, 3.0)]
    simulation = Simulation(Scene(pair, moving_circles_collide=collide))
    with pytest.raises(ValueError, match=f'^at_most: must be at least 1, got {at_most}$'):
        simulation.advance_to(1.0, at_most=at_most)
    assert simulation.advance_to(1.0, at_most=2**70)


def in_slices_until(simulation, time, at_most):
    while not simulation.advance_to(time, at_most=at_most):
        pass


def stuck(x):
    """Return a circle that glides along the slot until a locked one turns it against the walls, and that one."""
    return [
        Circle((x, 0.5), (1.0, 0.0), radius=0.5),
        Circle((x + 3.0, 0.9), radius=0.2, locked=True),
    ]


@pytest.mark.parametrize('at_most', [None, 1000])
def test_of_several_contacts_without_end_the_first_is_told_and_no_other_contact_is_lost(at_most):
    """The circle with the lower number gets stuck later; some have gone further than that when it is found."""
    walls = [Wall((-50.0, 0.0), (50.0, 0.0)), Wall((-50.0, 1.0), (50.0, 1.0))]
    walls += box(-50, 10, 50, 12)
    free = [Circle((x, 11.0), (0.1, 3.0 + x), radius=0.25) for x in (0.0, 1.0)]
    late, disk = stuck(0.0)
    early, other = stuck(20.0)
    disk = Circle((5.0, 0.9), radius=0.2, locked=True)
    scene = Scene(
        [free[0], late, early, free[1], disk, other], walls, moving_circles_collide=False
    )
    simulation = Simulation(scene, record_contacts=True)
    simulation.advance_to(1.0)  # what is in the log already stays there
    with pytest.raises(EndlessContactsError, match=r'^circles\[2\]: '):
        in_slices_until(simulation, 30.0, at_most)
    found = simulation.drain_contacts().tolist()
    assert simulation.time == pytest.approx(3.0 - math.sqrt(0.7**2 - 0.4**2), rel=1e-9)
    alone = Simulation(Scene(free, walls, moving_circles_collide=False), record_contacts=True)
    alone.advance_to(simulation.time)
    expected = alone.drain_contacts()
    assert [row[0] for row in found if row[1] in (0, 3)] == expected['time'].tolist()
    assert len(expected) > 5
    assert simulation.positions[[0, 3]].tolist() == alone.positions.tolist()
