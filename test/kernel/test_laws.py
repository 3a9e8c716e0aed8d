"""Laws that need no simulation to know: conservation, reversal, and counts from theory."""

import math
import random

import numpy as np
import pytest
from random_scenes import box, place, random_scene

from circle_bounce_ros.kernel import (
    Circle,
    ContactKind,
    Scene,
    Simulation,
    Wall,
    kinetic_energy,
    momentum,
)


def test_energy_stays_through_a_hundred_thousand_contacts():
    rng = random.Random(3)
    circles = place(rng, 60, [0.8, 0.4], 10.0, speed=2.0)
    circles += place(rng, 4, [0.7], 10.0, locked=True, taken=circles)
    simulation = Simulation(Scene(circles, box(-10, -10, 10, 10)))
    before = kinetic_energy(simulation)
    by_hand = sum(c.mass * (c.velocity[0] ** 2 + c.velocity[1] ** 2) / 2 for c in circles)
    assert math.isclose(before, by_hand, rel_tol=1e-14)
    time = 0.0
    while simulation.contact_count < 100_000:
        time += 10.0
        simulation.advance_to(time)
    # A random walk of roundings: about 1e-16 sqrt(100,000) = 3e-14.
    assert abs(kinetic_energy(simulation) / before - 1.0) < 1e-12


def test_momentum_and_energy_stay_where_nothing_is_locked():
    """A cloud that falls in on itself, in the open plane."""
    rng = random.Random(5)
    circles = [
        Circle(
            c.position, (-c.position[0] + 3.0, -c.position[1] - 2.0), radius=c.radius, mass=c.mass
        )
        for c in place(rng, 60, [0.5, 0.2], 10.0)
    ]
    simulation = Simulation(Scene(circles))
    momentum_before, energy_before = momentum(simulation), kinetic_energy(simulation)
    by_hand = np.sum([np.multiply(c.mass, c.velocity) for c in circles], axis=0)
    assert np.allclose(momentum_before, by_hand, rtol=1e-13, atol=0)
    simulation.advance_to(20.0)
    assert simulation.contact_count > 100
    total = sum(c.mass * np.hypot(*c.velocity) for c in circles)
    assert np.abs(momentum(simulation) - momentum_before).max() < 1e-13 * total
    assert abs(kinetic_energy(simulation) / energy_before - 1.0) < 1e-13


def test_the_speed_never_changes_among_locked_bodies():
    scene = random_scene('pass_through', 1)
    simulation = Simulation(scene)
    before = np.hypot(*simulation.velocities.T)
    simulation.advance_to(2000.0)
    assert simulation.contact_count > 2000
    # Some hundred bounces each, an ulp or two a bounce in random directions.
    assert np.abs(np.hypot(*simulation.velocities.T) / before - 1.0).max() < 1e-13


@pytest.mark.parametrize('collide', [True, False])
def test_the_film_runs_backwards(collide):
    """Not chaotic: flat walls at a tilt and equal circles on one line, which exchange velocities."""
    tilted = [(-8.0, -6.0), (9.0, -7.0), (7.0, 6.0), (-5.0, 8.0)]
    walls = [Wall(a, b) for a, b in zip(tilted, tilted[1:] + tilted[:1], strict=True)]
    if collide:
        walls = box(-8.0, -2.0, 8.0, 2.0)
        circles = [
            Circle((x, 0.25), (v, 0.0), radius=0.5)
            for x, v in ((-5.0, 1.0), (-2.0, 3.0), (1.0, -2.0), (4.5, 0.5))
        ]
    else:
        circles = [
            Circle((k - 2.0, 0.3 * k), (1.0 + k, 2.0 - k), radius=0.3 + 0.1 * k) for k in range(5)
        ]
    until = 40.0
    there = Simulation(Scene(circles, walls, moving_circles_collide=collide))
    there.advance_to(until)
    assert there.contact_count > 50
    turned = [
        Circle(p, -v, radius=c.radius)
        for c, p, v in zip(circles, there.positions, there.velocities, strict=True)
    ]
    back = Simulation(Scene(turned, walls, moving_circles_collide=collide))
    back.advance_to(until)
    assert back.contact_count == there.contact_count
    # Errors grow with time only: some 100 roundings of 1e-15.
    assert np.abs(back.positions - [c.position for c in circles]).max() < 1e-12
    assert np.abs(-back.velocities - [c.velocity for c in circles]).max() < 1e-12


@pytest.mark.parametrize(('digits', 'count'), [(0, 3), (1, 31), (2, 314), (3, 3141)])
def test_collisions_of_two_blocks_count_the_digits_of_pi(digits, count):
    """Galperin: masses 1 and 100^k, a wall on one side."""
    wall = Wall((0.0, -2.0), (0.0, 2.0))
    light = Circle((2.0, 0.0), radius=0.5)
    heavy = Circle((4.0, 0.0), (-1.0, 0.0), radius=0.5, mass=100.0**digits)
    simulation = Simulation(Scene([light, heavy], [wall]))
    simulation.advance_to(1000.0)
    assert simulation.contact_count == count
    # Both leave for ever, the light one no faster than the heavy one.
    assert 0.0 <= simulation.velocities[0, 0] <= simulation.velocities[1, 0]


def test_mean_free_path_in_a_sinai_billiard_is_pi_area_over_perimeter():
    side, radius, obstacle = 4.0, 0.1, 1.0
    scene = Scene(
        [
            Circle((1.6, 0.3), (0.6, 0.8), radius=radius),
            Circle((0.0, 0.0), radius=obstacle, locked=True),
        ],
        box(-2, -2, 2, 2),
    )
    simulation = Simulation(scene)
    counts = []
    for block in range(1, 161):
        simulation.advance_to(1000.0 * block)
        counts.append(simulation.contact_count - sum(counts))
    stretches = 1000.0 / np.array(counts)
    free = (side - 2 * radius) ** 2 - math.pi * (obstacle + radius) ** 2
    border = 4 * (side - 2 * radius) + 2 * math.pi * (obstacle + radius)
    expected = math.pi * free / border
    mean = np.mean(stretches)
    error = np.std(stretches, ddof=1) / math.sqrt(len(stretches))
    assert error < 0.006 * expected
    # Four standard errors of the run's own blocks.
    assert abs(mean - expected) < 4 * error


def test_speeds_of_a_gas_become_maxwellian():
    """From equal speeds; in two dimensions the mean of v^4 is twice the square of the mean of v^2."""
    rng = random.Random(9)
    circles = []
    for i in range(14):
        for j in range(14):
            angle = 2 * math.pi * rng.random()
            velocity = (math.cos(angle), math.sin(angle))
            circles.append(Circle((i - 6.5, j - 6.5), velocity, radius=0.3))
    simulation = Simulation(Scene(circles, box(-7, -7, 7, 7)))
    ratios = []
    for time in range(10, 50):
        simulation.advance_to(float(time))
        squares = np.square(simulation.velocities).sum(axis=1)
        ratios.append(np.mean(squares**2) / np.mean(squares) ** 2)
    # 196 circles: fixed total energy lowers it by 2 / N, and 40 samples scatter by about 3 %.
    assert abs(np.mean(ratios) - 2.0) < 0.12


def test_contact_rate_of_hard_disks_is_enskogs():
    """
    Packing fraction 0.2: collisions a disk and second are 2 n sigma chi sqrt(pi T / m).

    Counted in the middle of the box, with the density found there: layers form along the walls.
    """
    rng = random.Random(2)
    side, sigma, phi = 20, 0.6, 0.2
    half = side * math.sqrt(math.pi * sigma**2 / 4 / phi) / 2
    circles = []
    for i in range(side):
        for j in range(side):
            angle, size = 2 * math.pi * rng.random(), math.sqrt(-2 * math.log(1 - rng.random()))
            velocity = (size * math.cos(angle), size * math.sin(angle))
            where = [((k + 0.5) * 2 / side - 1) * half for k in (i, j)]
            circles.append(Circle(where, velocity, radius=sigma / 2))
    simulation = Simulation(Scene(circles, box(-half, -half, half, half)), record_contacts=True)
    simulation.advance_to(10.0)
    simulation.drain_contacts()
    middle, duration = half - 3 * sigma, 60.0
    inside = []
    for sample in range(240):
        simulation.advance_to(10.0 + (sample + 1) * duration / 240)
        inside.append((np.abs(simulation.positions) < middle).all(axis=1).sum())
    contacts = simulation.drain_contacts()
    of_pairs = contacts[contacts['kind'] == ContactKind.CIRCLE]
    counted = ((np.abs(of_pairs['x']) < middle) & (np.abs(of_pairs['y']) < middle)).sum()
    density = np.mean(inside) / (2 * middle) ** 2
    packing = density * math.pi * sigma**2 / 4
    chi = (1 - 7 * packing / 16) / (1 - packing) ** 2
    temperature = kinetic_energy(simulation) / len(circles)
    expected = 2 * density * sigma * chi * math.sqrt(math.pi * temperature)
    measured = 2 * counted / np.mean(inside) / duration
    # Theory is good to 1 %; some 19,000 contacts, not all independent, add about 1 %.
    assert counted > 15_000
    assert abs(measured / expected - 1.0) < 0.02
