"""How deep bodies overlap, against every pair one by one; energy and momentum, by hand."""

import math
import random

import numpy as np
import pytest
from lesson_oracles import ULP, distance_to_segment

from circle_bounce_ros.kernel import (
    Circle,
    Scene,
    Simulation,
    Wall,
    deepest_overlap,
    kinetic_energy,
    momentum,
)
from circle_bounce_ros.kernel.overlap import Bodies, deepest

# Coordinates below 16 m and about a dozen roundings.
CLOSE = 100 * ULP


def random_bodies(seed):
    """Return up to 40 bodies in a square of 10 m, often overlapping."""
    rng = random.Random(seed)
    count = rng.randrange(1, 40)
    largest = rng.choice([0.02, 0.3, 3.0])
    positions = [(10 * rng.random(), 10 * rng.random()) for _ in range(count)]
    radii = [largest * (0.1 + rng.random()) for _ in range(count)]
    locked = [rng.random() < 0.3 for _ in range(count)]
    locked[rng.randrange(count)] = False
    walls = [[10 * rng.random() for _ in range(4)] for _ in range(rng.randrange(4))]
    return Bodies(
        np.array(positions),
        np.array(radii),
        np.array(locked),
        np.array(walls).reshape(-1, 4),
        rng.random() < 0.7,
    )


def all_pairs(bodies, allowed=0.0):
    """Return depth, a, b and b_is_wall of every pair that counts."""
    found = []
    for a in range(len(bodies.radii)):
        for b in range(a + 1, len(bodies.radii)):
            if bodies.locked[a] and bodies.locked[b]:
                continue
            both_move = not bodies.locked[a] and not bodies.locked[b]
            if both_move and not bodies.moving_circles_collide:
                continue
            gap = math.dist(bodies.positions[a], bodies.positions[b])
            smaller = min(bodies.radii[a], bodies.radii[b])
            depth = bodies.radii[a] + bodies.radii[b] - gap - allowed * smaller
            found.append((depth, a, b, False))
        if not bodies.locked[a]:
            for number, wall in enumerate(bodies.walls):
                away = distance_to_segment(bodies.positions[a], wall[:2], wall[2:])
                depth = bodies.radii[a] - away - allowed * bodies.radii[a]
                found.append((depth, a, number, True))
    return found


@pytest.mark.parametrize('allowed', [0.0, 1e-12, 0.5])
def test_the_deepest_overlap_is_the_deepest_of_all_pairs(allowed):
    overlapping = 0
    for seed in range(300):
        bodies = random_bodies(seed)
        expected = max(all_pairs(bodies, allowed), default=(-math.inf, -1, -1, False))
        found = deepest(bodies, allowed)
        if expected[0] > 0.0:
            overlapping += 1
            assert found.excess == pytest.approx(expected[0], abs=CLOSE)
            assert found[2:] == expected[1:]
        else:
            # Then it is some pair's gap, the nearest among those that it looked at.
            assert found.excess <= expected[0] + CLOSE
            assert found.excess <= 0.0
    assert 50 < overlapping < 250


def test_nothing_to_overlap_with_is_infinitely_far():
    alone = Bodies.of_scene(Scene([Circle((0, 0), radius=1.0)]))
    assert deepest(alone) == (-math.inf, -math.inf, -1, -1, False)


def test_the_smallest_gap_is_a_negative_depth():
    scene = Scene([Circle((0, 0), radius=1.0), Circle((1.5, 2.0), radius=1.0)])
    assert deepest(Bodies.of_scene(scene)) == (-0.5, -0.5, 0, 1, False)
    scene = Scene([Circle((0, 0), radius=1.0)], [Wall((4, 3), (9, 3)), Wall((-9, 2), (0, 2))])
    assert deepest(Bodies.of_scene(scene)) == (-1.0, -1.0, 0, 1, True)


def test_touching_is_an_overlap_of_depth_zero():
    scene = Scene([Circle((1, 0), radius=1.0), Circle((-1, 0), radius=1.0)])
    assert deepest(Bodies.of_scene(scene)) == (0.0, 0.0, 0, 1, False)


def test_bodies_of_a_scene_are_its_circles_by_id_and_its_walls():
    circles = [Circle((1, 2), radius=0.5, locked=True), Circle((3, 4), (5, 6), radius=0.25)]
    bodies = Bodies.of_scene(Scene(circles, [Wall((7, 8), (9, 10))], moving_circles_collide=False))
    assert bodies.positions.tolist() == [[1.0, 2.0], [3.0, 4.0]]
    assert bodies.radii.tolist() == [0.5, 0.25]
    assert bodies.locked.tolist() == [True, False]
    assert bodies.walls.tolist() == [[7.0, 8.0, 9.0, 10.0]]
    assert bodies.moving_circles_collide is False


def test_a_long_sweep_finds_the_one_overlap_among_many():
    # A wide locked circle whose x range meets all others, and one pair of small ones behind.
    circles = [Circle((0.0, 0.0), radius=50.0, locked=True)]
    circles += [Circle((-49.5 + k, 60.0), radius=0.4) for k in range(100)]
    bodies = Bodies.of_scene(Scene(circles))
    bodies.positions[71] = bodies.positions[70] + (0.6, 0.0)
    found = deepest(bodies)
    assert found[2:] == (70, 71, False)
    assert found.depth == pytest.approx(0.2, abs=CLOSE)


# of a simulation


def disturbed(scene, places):
    """Return a simulation of a scene with its circles put elsewhere, where it would never go."""

    class Disturbed(Simulation):
        positions = np.array(places, dtype=float)

    return Disturbed(scene)


def test_deepest_overlap_of_a_simulation_is_zero_when_nothing_overlaps():
    scene = Scene(
        [Circle((0, 0), (1, 0), radius=1.0), Circle((9, 0), radius=1.0, locked=True)],
        [Wall((0, -3), (9, -3))],
    )
    simulation = Simulation(scene)
    for time in (0.0, 3.5, 7.0, 8.0, 100.0):
        simulation.advance_to(time)
        assert deepest_overlap(simulation) == 0.0


def test_deepest_overlap_of_a_simulation_is_where_its_circles_are_now():
    scene = Scene(
        [
            Circle((5, 5), radius=2.0, locked=True),
            Circle((0, 0), (1, 0), radius=1.0),
            Circle((9, 0), radius=1.0),
        ],
        [Wall((0, -3), (9, -3))],
    )
    assert deepest_overlap(disturbed(scene, [(0, 0), (9, 0)])) == 0.0
    assert deepest_overlap(disturbed(scene, [(0, 0), (1.2, 1.6)])) == 0.0
    # Each kind of partner: moving, locked, wall.
    assert deepest_overlap(disturbed(scene, [(0, 0), (0.9, 1.2)])) == 0.5
    assert deepest_overlap(disturbed(scene, [(5, 2.25), (9, 0)])) == 0.25
    assert deepest_overlap(disturbed(scene, [(5, -2.25), (9, 0)])) == 0.25


def test_kinetic_energy_is_half_of_mass_times_speed_squared():
    scene = Scene(
        [
            Circle((0, 0), (3, 4), radius=1.0, mass=2.0),
            Circle((50, 0), radius=1.0, locked=True, mass=1e9),
            Circle((100, 0), (-1, 0), radius=1.0, mass=0.5),
        ]
    )
    assert kinetic_energy(Simulation(scene)) == 25.0 + 0.25
    assert type(kinetic_energy(Simulation(scene))) is float


def test_momentum_is_the_sum_of_mass_times_velocity():
    scene = Scene(
        [
            Circle((0, 0), (3, 4), radius=1.0, mass=2.0),
            Circle((50, 0), radius=1.0, locked=True, mass=1e9),
            Circle((100, 0), (-1, 0), radius=1.0, mass=0.5),
        ]
    )
    assert momentum(Simulation(scene)).tolist() == [5.5, 8.0]


def test_sums_of_large_and_small_lose_nothing():
    # 1e16 + 1 - 1e16, three times over: a plain sum gives 0.
    speeds = [1e16, 1.0, -1e16] * 3
    circles = [
        Circle((0, 1e6 * k), (v, 2.0 * v), radius=1e5, mass=1.0) for k, v in enumerate(speeds)
    ]
    assert momentum(Simulation(Scene(circles))).tolist() == [3.0, 6.0]


def test_two_free_circles_keep_energy_and_momentum_through_their_contact():
    scene = Scene(
        [
            Circle((0, 0), (3, 0.5), radius=1.0, mass=2.0),
            Circle((5, 0.5), (-1, 0), radius=0.5, mass=7.0),
        ]
    )
    simulation = Simulation(scene)
    energy, total = kinetic_energy(simulation), momentum(simulation)
    simulation.advance_to(10.0)
    assert simulation.contact_count == 1
    # One exchange: a dozen roundings.
    assert kinetic_energy(simulation) == pytest.approx(energy, rel=16 * ULP, abs=0)
    assert momentum(simulation) == pytest.approx(total, abs=16 * ULP * 13.0)
