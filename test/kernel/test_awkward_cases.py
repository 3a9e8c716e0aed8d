"""Decided rules for the cases in which geometry alone leaves a choice."""

import math
import random

import numpy as np
import pytest
from random_scenes import box

from circle_bounce_ros.kernel import (
    Circle,
    ContactKind,
    EndlessContactsError,
    Scene,
    Simulation,
    Wall,
    kinetic_energy,
)
from circle_bounce_ros.kernel.engine import event_queue, grid_layout
from circle_bounce_ros.kernel.engine.broad_phase import query_neighbours
from circle_bounce_ros.kernel.engine.collision_response import bounce_off, collide
from circle_bounce_ros.kernel.engine.records import EVERYWHERE


def contacts_until(simulation, time):
    simulation.record_contacts = True
    simulation.advance_to(time)
    return simulation.drain_contacts()


def plain(scene, **options):
    """Return a simulation and its world as objects that a test can look into."""
    simulation = Simulation(scene, compiled=False, **options)
    return simulation, simulation._engine.world


def is_outside(world, i):
    return world.moving[i].level == world.levels


def locked(x, y, radius=0.5):
    return Circle((x, y), radius=radius, locked=True)


def test_touching_and_closing_in_is_a_contact_now():
    simulation = Simulation(Scene([Circle((0.0, 0.0), (1.0, 0.0), radius=0.5), locked(1.0, 0.0)]))
    contacts = contacts_until(simulation, 0.0)
    assert contacts['time'].tolist() == [0.0]
    assert simulation.velocities.tolist() == [[-1.0, 0.0]]


@pytest.mark.parametrize('velocity', [(-1.0, 0.0), (0.0, 1.0), (0.0, 0.0)])
def test_touching_and_parting_sliding_or_resting_is_none(velocity):
    simulation = Simulation(Scene([Circle((0.0, 0.0), velocity, radius=0.5), locked(1.0, 0.0)]))
    assert len(contacts_until(simulation, 10.0)) == 0
    assert simulation.velocities.tolist() == [list(velocity)]


def test_touching_circles_of_equal_velocity_travel_together():
    pair = [Circle((x, 0.0), (0.3, 0.1), radius=0.5) for x in (0.0, 1.0)]
    simulation = Simulation(Scene(pair))
    assert len(contacts_until(simulation, 100.0)) == 0


def test_an_exact_graze_changes_nothing():
    grazing = Circle((-5.0, 1.0), (1.0, 0.0), radius=0.5)
    simulation = Simulation(Scene([grazing, locked(0.0, 0.0)]))
    assert len(contacts_until(simulation, 10.0)) == 0


def test_a_hair_inside_a_graze_is_a_contact():
    inside = Circle((-5.0, 1.0 - 2.0**-40), (1.0, 0.0), radius=0.5)
    simulation = Simulation(Scene([inside, locked(0.0, 0.0)]))
    assert len(contacts_until(simulation, 10.0)) == 1
    # Turned by twice the angle between path and tangent: sqrt(2 2^-40) each.
    angle = math.atan2(simulation.velocities[0, 1], simulation.velocities[0, 0])
    assert math.isclose(angle, 2 * math.sqrt(2 * 2.0**-40), rel_tol=1e-3)


def test_in_a_corner_of_two_walls_the_velocity_is_reversed():
    """Both walls at one instant, one after the other; the corner point itself is out of reach."""
    simulation = Simulation(Scene([Circle((2.0, 2.0), (-1.0, -1.0), radius=0.5)], box(0, 0, 4, 4)))
    contacts = contacts_until(simulation, 2.0)
    assert contacts['time'].tolist() == [1.5, 1.5]
    assert set(contacts['b'].tolist()) == {0, 3}
    assert simulation.velocities.tolist() == [[1.0, 1.0]]


def test_in_a_tilted_corner_too():
    """A right angle turned by 0.3: the reflections about two normals at right angles reverse."""
    turn = 0.3
    c, s = math.cos(turn), math.sin(turn)
    walls = [Wall((0.0, 0.0), (9 * c, 9 * s)), Wall((0.0, 0.0), (-9 * s, 9 * c))]
    x, y = 4 * (c - s), 4 * (s + c)
    simulation = Simulation(Scene([Circle((x, y), (-x, -y), radius=0.5)], walls))
    assert len(contacts_until(simulation, 2.0)) == 2
    # Two reflections, each exact to an ulp or two of the speed 5.7.
    assert np.abs(simulation.velocities - [(x, y)]).max() < 1e-14


def test_a_wall_end_is_a_point():
    """Head-on at the end of a wall seen edge-on; at 45 degrees it turns by a right angle."""
    wall = Wall((0.0, 0.0), (5.0, 0.0))
    head_on = Simulation(Scene([Circle((-3.0, 0.0), (1.0, 0.0), radius=0.5)], [wall]))
    contacts = contacts_until(head_on, 4.0)
    assert contacts['kind'].tolist() == [ContactKind.WALL_END]
    assert contacts['time'].tolist() == [2.5]
    assert head_on.velocities.tolist() == [[-1.0, 0.0]]
    height = 0.5 * math.sqrt(0.5)
    aside = Simulation(Scene([Circle((-3.0, height), (1.0, 0.0), radius=0.5)], [wall]))
    aside.advance_to(4.0)
    assert np.abs(aside.velocities - [(0.0, 1.0)]).max() < 1e-14


def test_an_end_shared_by_two_walls_is_one_point_of_the_lower_number():
    walls = [Wall((0.0, 0.0), (1.0, 3.0)), Wall((1.0, -3.0), (0.0, 0.0))]
    simulation = Simulation(Scene([Circle((-3.0, 0.0), (1.0, 0.0), radius=0.5)], walls))
    contacts = contacts_until(simulation, 10.0)
    assert [(c['kind'].item(), c['b'].item()) for c in contacts] == [(ContactKind.WALL_END, 0)]


@pytest.mark.parametrize('side', [1.0, -1.0])
def test_a_wall_has_two_sides(side):
    wall = Wall((-3.0, -3.0), (3.0, 3.0))
    circle = Circle((-2.0 * side, 2.0 * side), (side, -side), radius=math.sqrt(0.5))
    simulation = Simulation(Scene([circle], [wall]))
    contacts = contacts_until(simulation, 3.0)
    assert np.allclose(contacts['time'], 1.5, rtol=1e-15)
    assert np.abs(simulation.velocities - [(-side, side)]).max() < 1e-15
    # The normal points from the circle to the wall.
    assert np.allclose(
        [contacts['nx'][0], contacts['ny'][0]], np.array([side, -side]) / math.sqrt(2)
    )


def test_collinear_walls_are_passed_as_one():
    """A circle that rolls along the seam of two walls, exactly touching them, is not stopped."""
    walls = [Wall((-5.0, 0.0), (0.0, 0.0)), Wall((0.0, 0.0), (5.0, 0.0))]
    simulation = Simulation(Scene([Circle((-4.0, 0.5), (1.0, 0.0), radius=0.5)], walls))
    assert len(contacts_until(simulation, 20.0)) == 0


def test_newtons_cradle_passes_the_velocity_on_at_one_instant():
    row = [Circle((float(k), 0.0), radius=0.5) for k in range(5)]
    striker = Circle((-3.0, 0.0), (2.0, 0.0), radius=0.5)
    simulation = Simulation(Scene([striker, *row]))
    contacts = contacts_until(simulation, 3.0)
    assert contacts['time'].tolist() == [1.0] * 5
    assert simulation.velocities[:, 0].tolist() == [0.0, 0.0, 0.0, 0.0, 0.0, 2.0]


def test_simultaneous_contacts_are_reproducible_and_keep_energy():
    """One circle between two others at one instant: an order is fixed, the result is elastic."""
    trio = [
        Circle((0.0, 3.0), (0.0, -1.0), radius=0.5),
        Circle((-0.5, 0.0), radius=0.5),
        Circle((0.5, 0.0), radius=0.5),
    ]
    runs = [Simulation(Scene(trio)) for _ in range(2)]
    for run in runs:
        run.advance_to(10.0)
    assert runs[0].velocities.tobytes() == runs[1].velocities.tobytes()
    assert math.isclose(kinetic_energy(runs[0]), 0.5, rel_tol=1e-14)
    assert runs[0].contact_count >= 2


def test_zero_velocity_stays():
    simulation = Simulation(
        Scene([Circle((0.0, 0.0), radius=0.5), locked(3.0, 0.0)], box(-1, -1, 5, 1))
    )
    simulation.advance_to(1e6)
    assert simulation.positions.tolist() == [[0.0, 0.0]]
    assert simulation.contact_count == 0


def test_a_single_circle_goes_straight_for_ever():
    simulation = Simulation(Scene([Circle((1.0, 2.0), (0.25, -0.5), radius=0.5)]))
    for time in (1.0, 1e6, 1e15):
        simulation.advance_to(time)
        assert simulation.positions.tolist() == [[1.0 + 0.25 * time, 2.0 - 0.5 * time]]


def test_circles_that_left_an_open_scene_still_meet():
    """A slow one is caught up by a fast one, a million metres away from everything."""
    slow = Circle((1.0, 0.0), (1.0, 0.0), radius=0.5)
    fast = Circle((-1e6, 0.0), (2.0, 0.0), radius=0.5)
    simulation = Simulation(Scene([slow, fast, locked(0.0, 5.0), locked(-1e6, 9.0)]))
    contacts = contacts_until(simulation, 3e6)
    # The gap of a million metres (less the two radii) closes at 1 m/s.
    assert contacts['time'].tolist() == [1e6]
    assert simulation.velocities.tolist() == [[2.0, 0.0], [1.0, 0.0]]


@pytest.mark.parametrize(('levels', 'radius'), [(1, 0.5), (2, 0.12)])
def test_a_circle_comes_back_from_far_outside(levels, radius, monkeypatch):
    """
    A light circle bounces off a locked one, catches up with a heavy one far out, and comes back.

    On the way back it is in no cell of the grid: the locked circle must find it all the same. A large circle at rest
    makes it a proxy on a second level of cells, which it leaves and enters as well.
    """
    speed = 2.01
    light = Circle((20.0, 0.0), (-speed, 0.0), radius=radius)
    heavy = Circle((21.5, 0.0), (1.0, 0.0), radius=radius, mass=1e12)
    large = [Circle((0.0, 10.0), radius=1.0)] * (levels - 1)
    monkeypatch.setattr(grid_layout, 'SPLIT_ABOVE', 0.01)
    monkeypatch.setattr(grid_layout, 'GAPS_A_CELL_OF_LEVELS', 0.01)
    scene = Scene([light, heavy, *large, locked(0.0, 0.0)])
    simulation, world = plain(scene, record_contacts=True)
    assert world.levels == levels
    near = 0.5 + radius
    first = (20.0 - near) / speed
    meeting = (21.5 - 2.0 * radius - near + speed * first) / (speed - 1.0)
    place = 21.5 + meeting - 2.0 * radius
    back = meeting + (place - near) / (speed - 2.0)
    simulation.advance_to(meeting + 1.0)
    assert is_outside(world, 0)
    simulation.advance_to(back + 1.0)
    contacts = simulation.drain_contacts()
    assert contacts['kind'].tolist() == [
        ContactKind.LOCKED,
        ContactKind.CIRCLE,
        ContactKind.LOCKED,
    ]
    # The way back is slow: rounding and the finite mass are blown up by speed / (speed - 2).
    assert np.allclose(contacts['time'], [first, meeting, back], rtol=1e-9)


def test_a_circle_still_in_the_grid_meets_one_that_has_just_left_it():
    """At the outer bounds of the grid one is in a cell and the other in none."""

    def scene(gap, slow):
        chaser = Circle((3.0, 0.0), (-1.0, 0.0), radius=0.5)
        return Scene([chaser, Circle((3.0 + gap, 0.0), (slow, 0.0), radius=0.5), locked(0.0, 0.0)])

    gap = 6.0
    _, world = plain(scene(gap, 0.1))
    width = world.tables[0].width
    # A circle leaves the grid at the first border between cells beyond the outer bounds and one cell more.
    edge = world.x0
    while edge <= world.outer_x1 + world.edge:
        edge += width
    there = edge + 0.3
    meeting = 2.0 + (there - 1.0 - 1.0) / 1.0
    slow = (there - 3.0 - gap) / meeting
    simulation, world = plain(scene(gap, slow), record_contacts=True)
    simulation.advance_to(meeting - 0.1)
    assert [is_outside(world, i) for i in range(2)] == [False, True]
    simulation.advance_to(meeting + 1.0)
    contacts = simulation.drain_contacts()
    assert contacts['kind'].tolist() == [ContactKind.LOCKED, ContactKind.CIRCLE]
    assert math.isclose(contacts['time'][1], meeting, rel_tol=1e-12)


def test_a_circle_outside_the_grid_bounds_looks_at_all_that_are_outside():
    row = [Circle((4.0 * k, 0.0), (float(k > 1), 0.0), radius=0.5) for k in range(3)]
    simulation, world = plain(Scene([*row, locked(0.0, 5.0)]))
    inside, between, outside = world.moving
    while not is_outside(world, 2):
        simulation.advance_to(simulation.time + 1.0)
    between.column = world.tables[0].columns

    def seen_by(circle):
        return world.candidates[: query_neighbours(world, circle, EVERYWHERE)]

    assert 2 not in seen_by(inside)
    assert 2 in seen_by(between)
    assert seen_by(outside) == [0, 1, 2]


@pytest.mark.parametrize('kind', [ContactKind.CIRCLE, ContactKind.LOCKED])
def test_bodies_that_do_not_approach_are_let_go(kind):
    """Rounding far from the origin can announce a contact of bodies that already part."""
    parting = Circle((0.0, 0.0), (-1.0, 0.25), radius=0.5)
    other = locked(1.0, 0.0) if kind == ContactKind.LOCKED else Circle((1.0, 0.0), radius=0.5)
    simulation, world = plain(Scene([parting, other]), record_contacts=True)
    if kind == ContactKind.CIRCLE:
        collide(world, 0, 1, 0.0)
    else:
        world.moving[0].kind, world.moving[0].partner = int(kind), 0
        bounce_off(world, 0, 0.0)
    assert simulation.velocities[0].tolist() == [-1.0, 0.25]
    assert simulation.contact_count == 0
    assert len(simulation.drain_contacts()) == 0


def test_the_event_queue_knows_the_earliest_time_and_whose_it_is():
    rng = random.Random(4)
    _, world = plain(Scene([Circle((3.0 * k, 0.0), radius=1.0) for k in range(37)]))
    times = [0.0] * 37
    for _ in range(5000):
        i = rng.randrange(37)
        times[i] = rng.choice([1.0, 2.0, 3.0, math.inf, rng.random() * 4])
        event_queue.update(world, i, times[i])
        assert world.tree_time[1] == min(times)
        assert times[world.tree_who[1]] == min(times)


@pytest.mark.parametrize('others', [0, 40])
@pytest.mark.parametrize('collide', [False, True])
def test_contacts_without_end_are_found_at_their_instant(others, collide):
    """A circle glides along a slot that fits exactly, until a locked one turns it against the walls."""
    slot = [Wall((-5.0, 0.0), (9.0, 0.0)), Wall((-5.0, 1.0), (9.0, 1.0))]
    glides = Circle((0.0, 0.5), (1.0, 0.0), radius=0.5, name='stuck')
    busy = [Circle((0.0, 3.0 + 2.0 * k), (0.0, 0.3), radius=0.5) for k in range(others)]
    locked_disk = locked(6.0, 0.9, 0.2)
    scene = Scene([glides, *busy, locked_disk], slot, moving_circles_collide=collide)
    simulation = Simulation(scene, record_contacts=True)
    with pytest.raises(EndlessContactsError, match='stuck'):
        simulation.advance_to(20.0)
    touch = 6.0 - math.sqrt(0.7**2 - 0.4**2)
    assert math.isclose(simulation.time, touch, rel_tol=1e-9)
    # Contacts are without end while nothing travels further than 1e-9 radii.
    assert np.allclose(simulation.positions[0], [touch, 0.5], rtol=0, atol=1e-8)
    assert np.allclose(
        simulation.positions[1:, 1], [3.0 + 2.0 * k + 0.3 * touch for k in range(others)]
    )


def test_contacts_without_end_are_an_error_and_never_a_hang():
    """A slot that fits exactly, the circle pushed across it."""
    slot = [Wall((-5.0, 0.0), (5.0, 0.0)), Wall((-5.0, 1.0), (5.0, 1.0))]
    scene = Scene([Circle((0.0, 0.5), (1.0, 1.0), radius=0.5, name='stuck')], slot)
    simulation = Simulation(scene)
    with pytest.raises(EndlessContactsError) as caught:
        simulation.advance_to(1.0)
    assert str(caught.value).startswith(
        'circles[0] (stuck): contacts without end at 0 s, more than 20100 of them within '
    )
    assert simulation.time == 0.0
    assert simulation.positions.tolist() == [[0.0, 0.5]]
    simulation.reset()
    assert simulation.velocities.tolist() == [[1.0, 1.0]]


@pytest.mark.parametrize('miss', [1e-4, 1e-8, 1e-12, 0.0])
@pytest.mark.parametrize('degrees', [10.0, 1.0, 0.1, 0.01])
def test_a_circle_that_runs_into_a_wedge_comes_out_after_as_many_bounces_as_unfolding_tells(
    degrees, miss
):
    """Unfolded at each wall the path is straight: it crosses a wall for each `degrees` of its turn about the apex."""
    turn, opening, radius, far, until = 0.3, math.radians(degrees), 0.05, 1.0, 1.5
    apex = radius / math.sin(opening / 2.0)  # of the centres, along the middle of the wedge

    def place(distance, angle):
        return distance * math.cos(angle + turn), distance * math.sin(angle + turn)

    walls = [Wall((0.0, 0.0), place(apex + 3.0, angle)) for angle in (0.0, opening)]
    start = 0.37 * opening
    x, y = (a + b for a, b in zip(place(apex, opening / 2.0), place(far, start), strict=True))
    velocity = place(1.0, start + math.pi - math.asin(miss / far))
    scene = Scene([Circle((x, y), velocity, radius=radius)], walls)
    simulation = Simulation(scene)
    simulation.advance_to(until)
    nearest = math.sqrt(far**2 - miss**2)
    turned = math.atan2(nearest, miss) + math.atan2(until - nearest, miss)
    assert simulation.contact_count == math.floor((start + turned) / opening)


def test_contacts_without_end_survive_calls_in_slices():
    slot = [Wall((-5.0, 0.0), (5.0, 0.0)), Wall((-5.0, 1.0), (5.0, 1.0))]
    simulation = Simulation(Scene([Circle((0.0, 0.5), (0.0, 1.0), radius=0.5)], slot))

    def in_slices():
        for _ in range(3000):
            simulation.advance_to(1.0, at_most=10)

    with pytest.raises(EndlessContactsError):
        in_slices()


@pytest.mark.parametrize('collide', [True, False])
def test_after_endless_contacts_the_others_are_where_they_belong(collide):
    """The state can be read: nobody is ahead of its time, whichever way the circles are followed."""
    slot = [Wall((-5.0, 0.0), (5.0, 0.0)), Wall((-5.0, 1.0), (5.0, 1.0))]
    free = [Circle((0.0, y), (0.0, 1.0), radius=0.25) for y in (5.0, -9.0)]
    stuck = Circle((0.0, 0.5), (0.0, 1.0), radius=0.5)
    simulation = Simulation(Scene([free[0], stuck, free[1]], slot, collide), record_contacts=True)
    with pytest.raises(EndlessContactsError, match=r'^circles\[1\]: '):
        simulation.advance_to(3.0)
    assert simulation.time == 0.0
    assert simulation.positions[[0, 2]].tolist() == [[0.0, 5.0], [0.0, -9.0]]


@pytest.mark.parametrize('time', [math.nan, math.inf, -math.inf])
def test_a_time_that_is_none_is_refused(time):
    simulation = Simulation(Scene([Circle((0.0, 0.0), radius=0.5)]))
    with pytest.raises(ValueError, match=f'^time: must be finite, got {time}$'):
        simulation.advance_to(time)


def test_time_does_not_run_backwards():
    simulation = Simulation(Scene([Circle((0.0, 0.0), (1.0, 0.0), radius=0.5)]))
    simulation.advance_to(2.0)
    with pytest.raises(ValueError, match=r'^time: must not be before 2\.0 s, got 1\.5$'):
        simulation.advance_to(1.5)
    simulation.advance_to(2.0)
    assert simulation.positions.tolist() == [[2.0, 0.0]]


def test_moving_circles_pass_through_each_other_where_the_scene_says_so():
    pair = [
        Circle((0.0, 0.0), (1.0, 0.0), radius=0.5),
        Circle((4.0, 0.0), (-1.0, 0.0), radius=0.5),
    ]
    simulation = Simulation(Scene(pair, moving_circles_collide=False))
    simulation.advance_to(10.0)
    assert simulation.positions.tolist() == [[10.0, 0.0], [-6.0, 0.0]]


def test_ids_are_indices_in_the_scene_and_arrays_are_in_scene_order():
    circles = [
        locked(-5.0, 0.0),
        Circle((0.0, 0.0), (1.0, 0.0), radius=0.5, mass=2.0),
        locked(5.0, 5.0),
        Circle((3.0, 0.0), radius=0.25, mass=3.0),
    ]
    simulation = Simulation(Scene(circles), record_contacts=True)
    assert simulation.ids.tolist() == [1, 3]
    assert simulation.radii.tolist() == [0.5, 0.25]
    assert simulation.masses.tolist() == [2.0, 3.0]
    simulation.advance_to(3.0)
    contact = simulation.drain_contacts()[0]
    assert (contact['a'], contact['b'], contact['kind']) == (1, 3, ContactKind.CIRCLE)
    # From a to b, at b's left edge; the impulse of 2 * 2 * 3 / 5 * 1 N s.
    assert [contact[k].item() for k in ('time', 'x', 'y', 'nx', 'ny')] == [
        2.25,
        2.75,
        0.0,
        1.0,
        0.0,
    ]
    assert math.isclose(contact['impulse'], 2.4, rel_tol=1e-15)


def test_contacts_are_logged_only_while_asked_for():
    scene = Scene([Circle((0.0, 0.0), (1.0, 0.0), radius=0.5)], box(-1, -1, 1, 1))
    simulation = Simulation(scene)
    simulation.advance_to(3.0)
    assert len(simulation.drain_contacts()) == 0
    assert simulation.contact_count == 3
    simulation.record_contacts = True
    simulation.advance_to(5.0)
    simulation.record_contacts = False
    simulation.advance_to(7.0)
    assert simulation.drain_contacts()['time'].tolist() == [3.5, 4.5]
