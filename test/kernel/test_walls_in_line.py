"""Walls in line that touch each other are one wall to circles that slide along them, and keep their numbers."""

import itertools
import math
import random

import numpy as np
import pytest
from random_scenes import box, in_pieces, random_scene, regular_polygon

from circle_bounce_ros.kernel import Circle, ContactKind, Scene, Simulation, Wall
from circle_bounce_ros.kernel.engine.wall_segments import straighten


def slide(walls, turn, side=1.0, start=1.0, until=8.0):
    """Let a circle slide along a floor tilted by `turn`; return its contacts and change of velocity."""
    c, s = math.cos(turn), math.sin(turn)
    place = (start * c - side * 0.1 * s, start * s + side * 0.1 * c)
    simulation = Simulation(Scene([Circle(place, (c, s), radius=0.1)], walls))
    simulation.advance_to(until)
    return simulation.contact_count, np.abs(simulation.velocities - [(c, s)]).max()


def ten_metres(turn):
    return (10.0 * math.cos(turn), 10.0 * math.sin(turn))


@pytest.mark.parametrize('seed', range(6))
def test_a_circle_slides_over_the_seams_of_a_tilted_floor(seed):
    rng = random.Random(seed)
    turn = 7.0 * rng.random()
    x, y = ten_metres(turn)
    points = [(k / 1000 * x, k / 1000 * y) for k in range(1001)]
    walls = [Wall(*pair) for pair in itertools.pairwise(points)]
    rng.shuffle(walls)
    _, kick = slide(walls, turn, side=rng.choice([-1.0, 1.0]))
    # Rounding may let it touch the one line once: by an angle of a few 1e-16.
    assert kick < 1e-15


@pytest.mark.parametrize('seed', range(6))
def test_pieces_of_any_length_and_dividers_beyond_the_floor_are_not_felt(seed):
    rng = random.Random(seed)
    turn = 7.0 * rng.random()
    x, y = ten_metres(turn)
    walls = in_pieces(rng, Wall((0.0, 0.0), (x, y)), 60)
    for share in (rng.random() for _ in range(30)):
        foot = (share * x, share * y)
        walls.append(Wall(foot, (foot[0] + 0.03 * y, foot[1] - 0.03 * x)))
    rng.shuffle(walls)
    assert slide(walls, turn)[1] < 1e-15


def test_a_floor_whose_points_were_added_up_one_by_one_is_one_line_too():
    turn = 0.3
    x, y = (coordinate / 1000 for coordinate in ten_metres(turn))
    points = [(0.0, 0.0)]
    while len(points) <= 1000:
        points.append((points[-1][0] + x, points[-1][1] + y))
    walls = [Wall(*pair) for pair in itertools.pairwise(points)]
    # A thousand roundings bend the floor by some 1e-14.
    assert slide(walls, turn)[1] < 1e-12


def test_contacts_tell_the_wall_that_was_touched():
    """A ball hops along a floor in ten pieces, listed backwards: piece k from 9 - k to 10 - k."""
    floor = [Wall((9.0 - k, 0.0), (10.0 - k, 0.0)) for k in range(10)]
    ceiling = Wall((0.0, 2.0), (10.0, 2.0))
    ball = Circle((0.4, 1.0), (0.37, 1.0), radius=0.25)
    simulation = Simulation(Scene([ball], [*floor, ceiling]), record_contacts=True)
    simulation.advance_to(25.0)
    contacts = simulation.drain_contacts()
    assert len(contacts) == 17  # at 0.75 s, then every 1.5 s
    assert set(contacts['kind'].tolist()) == {int(ContactKind.WALL)}
    for contact in contacts:
        below = contact['y'] < 1.0
        assert contact['b'] == (9 - math.floor(contact['x']) if below else 10)


def test_of_walls_on_top_of_each_other_the_lowest_number_is_touched():
    walls = [
        Wall((0.0, 0.0), (4.0, 0.0)),
        Wall((9.0, 0.0), (2.0, 0.0)),
        Wall((5.0, 0.0), (6.0, 0.0)),
    ]
    balls = [Circle((x, 1.0), (0.0, -1.0), radius=0.25) for x in (1.0, 3.0, 5.5, 8.0)]
    simulation = Simulation(Scene(balls, walls), record_contacts=True)
    simulation.advance_to(1.0)
    contacts = simulation.drain_contacts()
    assert dict(contacts[['a', 'b']].tolist()) == {0: 0, 1: 0, 2: 1, 3: 1}


def test_a_polygon_with_its_sides_in_pieces_is_the_polygon():
    rng = random.Random(3)
    sides = regular_polygon(5, 3.0, 0.4)
    pieces = [piece for side in sides for piece in in_pieces(rng, side, 8)]
    ball = Circle((0.3, -0.2), (1.0, 0.7), radius=0.2)
    whole, divided = (
        Simulation(Scene([ball], walls), record_contacts=True) for walls in (sides, pieces)
    )
    contacts = []
    for simulation in (whole, divided):
        simulation.advance_to(30.0)
        contacts.append(simulation.drain_contacts())
    assert len(contacts[0]) == len(contacts[1]) > 10
    for name in ('time', 'x', 'y', 'nx', 'ny'):
        # Straight sides let rounding grow only in proportion to the number of contacts.
        assert np.abs(contacts[0][name] - contacts[1][name]).max() < 1e-12


def test_what_bends_or_does_not_touch_stays_apart():
    def segments(walls):
        return len(straighten(tuple(walls)).segments)

    assert segments(box(0, 0, 1, 1)) == 4
    assert segments(regular_polygon(3000, 1.0, 0.1)) == 3000
    assert segments([Wall((0.0, 0.0), (1.0, 0.0)), Wall((1.0, 0.0), (2.0, 1e-14))]) == 2
    assert segments([Wall((0.0, 0.0), (1.0, 0.0)), Wall((1.0 + 1e-14, 0.0), (2.0, 0.0))]) == 2
    assert segments([Wall((0.0, 0.0), (1.0, 0.0)), Wall((0.0, 1e-14), (1.0, 1e-14))]) == 2


def test_ends_inside_of_a_wall_cannot_be_touched():
    walls = [
        Wall((0.0, 0.0), (3.0, 0.0)),
        Wall((3.0, 0.0), (6.0, 0.0)),
        Wall((2.0, 0.0), (2.0, 1.0)),
    ]
    ends = straighten(tuple(walls))
    assert ends.ends.tolist() == [[0.0, 0.0], [6.0, 0.0], [2.0, 1.0]]
    assert ends.end_numbers.tolist() == [0, 1, 2]


def test_a_circle_is_not_lost_between_two_walls_in_line():
    """Head-on at each seam of a tilted floor: the foot of the contact is the seam itself."""
    x, y = ten_metres(0.3)
    points = [(k / 50 * x, k / 50 * y) for k in range(51)]
    walls = [Wall(*pair) for pair in itertools.pairwise(points)]
    balls = [Circle((px - y / 10, py + x / 10), (y, -x), radius=0.2) for px, py in points[1:-1]]
    simulation = Simulation(Scene(balls, walls, moving_circles_collide=False))
    simulation.advance_to(0.2)
    assert simulation.contact_count == len(balls)


def test_the_scenes_with_seams_have_walls_in_line_and_ends_on_walls():
    walls = random_scene('seams', 0).walls
    found = straighten(tuple(walls))
    assert len(found.segments) < len(walls) / 2
    assert len(found.parts) > 20


@pytest.mark.parametrize('turns', [(), (0.5,), (1e-9,), (0.5, 0.75)])
@pytest.mark.parametrize('seed', range(8))
def test_a_circle_slides_past_the_end_of_a_wall_and_round_no_corner(turns, seed):
    """Walls go on from there to the other side, by quarters of a turn, or none does."""
    rng = random.Random(seed)
    turn = 7.0 * rng.random()
    end = ten_metres(turn)
    beyond = [turn - math.pi * quarter for quarter in turns]
    walls = [Wall((0.0, 0.0), end)]
    walls += [Wall((end[0] + math.cos(a), end[1] + math.sin(a)), end) for a in beyond]
    assert slide(walls, turn, until=20.0)[1] < 1e-15
