"""
The ranges of docs/exactness.md, limit by limit.

Just inside of each plain and compiled code agree to the bit, nothing leaves a closed box, and every call returns; just
outside the scene is refused at the place.
"""

import math
import random

import numpy as np
import pytest
from random_scenes import regular_polygon

from circle_bounce_ros.kernel import Circle, Scene, SceneError, Simulation, Wall
from circle_bounce_ros.kernel.engine import compilation

MODES = [False, True] if compilation.is_available() else [False]


def in_a_box(
    *, radius=0.02, size=1.0, speed=1.0, slow=1.0, light=1.0, shift=0.0, collide=True, seed=1
):
    """Return eight balls in a closed box with tilted walls; every other is slow and light."""
    rng = random.Random(seed)
    walls = [
        Wall(*(tuple((c + shift) * size for c in end) for end in (wall.start, wall.end)))
        for wall in regular_polygon(5, 1.0, 0.3)
    ]
    balls = []
    for k in range(8):
        x, y = (shift + 0.08 * ((k % 4) - 1.5 + 4 * (axis and k // 4)) for axis in (0, 1))
        angle = 7.0 * rng.random()
        pace = speed * (slow if k % 2 else 1.0)
        balls.append(
            Circle(
                (x * size, y * size),
                (pace * math.cos(angle), pace * math.sin(angle)),
                radius=radius,
                mass=light if k % 2 else 1.0,
            )
        )
    return Scene(balls, walls, moving_circles_collide=collide)


def run(scene, until, compiled):
    """Return the log of contacts and the state after a time or 20,000 steps, whatever comes first."""
    simulation = Simulation(scene, record_contacts=True, compiled=compiled)
    for _ in range(20):
        if simulation.advance_to(until, at_most=1_000):
            break
    return simulation


def inside(wall, points):
    (sx, sy), (ex, ey) = wall.start, wall.end
    return ((ex - sx) * (points[:, 1] - sy) - (ey - sy) * (points[:, 0] - sx) > 0.0).all()


INSIDE = {
    'radius and largest coordinate': {'radius': 1.05e-12},
    'radius and a box far from the origin': {'radius': 2e-11, 'shift': 15.0},
    'radius, passing through': {'radius': 1.05e-12, 'collide': False},
    'speed and smallest radius': {'speed': 0.99e12 * 0.02},
    'speed and smallest radius, both small': {'radius': 1.05e-12, 'speed': 1.0},
    'slow beside fast': {'slow': 1e-50, 'radius': 1e-9},
    'very slow beside fast': {'slow': 1e-10, 'radius': 1.05e-12},
    'light beside heavy': {'light': 1.01e-24},
    'light beside heavy, very small': {'light': 1.01e-24, 'radius': 1.05e-12},
    'light beside heavy, passing through': {'light': 1e-60, 'collide': False},
    'large lengths': {'size': 1e59, 'radius': 2e57, 'speed': 1e59},
    'small lengths': {'size': 1e-58, 'radius': 2e-60, 'speed': 1e-58},
    'small lengths and slow': {'size': 1e-58, 'radius': 2e-60, 'speed': 1.01e-60},
}


@pytest.mark.parametrize('name', INSIDE)
def test_inside_of_the_ranges_a_scene_is_exact(name):
    options = INSIDE[name]
    scene = in_a_box(**options)
    until = 30.0 * options.get('size', 1.0) / options.get('speed', 1.0)
    runs = [run(scene, until, compiled) for compiled in MODES]
    assert runs[0].contact_count > 30
    assert all(inside(wall, runs[0].positions) for wall in scene.walls)
    states = [
        (r.positions.tobytes(), r.velocities.tobytes(), r.drain_contacts().tobytes()) for r in runs
    ]
    assert states[0] == states[-1]


@pytest.mark.parametrize('power', [-190, 190])
def test_a_scene_in_other_units_has_the_same_bits(power):
    """Powers of two, near both ends of the range: nothing overflows or loses digits to underflow."""
    unit = 2.0**power
    runs = []
    for factor in (1.0, unit):
        scene = in_a_box(size=factor, radius=0.02 * factor, speed=factor)
        runs.append(run(scene, 20.0, MODES[-1]))
    assert runs[0].contact_count > 100
    assert (runs[0].positions * unit).tobytes() == runs[1].positions.tobytes()


OUTSIDE = {
    'radius': (lambda: in_a_box(radius=0.95e-12), 'circles[0].radius'),
    'radius far from the origin': (
        lambda: in_a_box(radius=2e-11, shift=25.0),
        'circles[0].radius',
    ),
    'a wall far away': (
        lambda: Scene([Circle((0, 0), radius=1)], [Wall((1.1e12, 0), (1.1e12, 1))]),
        'circles[0].radius',
    ),
    'a locked circle that is vast': (
        lambda: Scene([Circle((2e12, 0), radius=1e12, locked=True), Circle((0, 0), radius=1)]),
        'circles[1].radius',
    ),
    'speed': (lambda: in_a_box(speed=1.01e12 * 0.02), 'circles['),
    'speed in a box of 2 m': (
        lambda: Scene([Circle((0, 0), (1e22, 0.3e22), radius=0.1)], regular_polygon(4, 1.4, 0.0)),
        'circles[0].velocity',
    ),
    'speed that is hardly one': (
        lambda: Circle((0, 0), (0.0, 0.99e-60), radius=1),
        'velocity',
    ),
    'mass': (lambda: in_a_box(light=0.99e-24), 'circles[1].mass'),
    'length': (lambda: Circle((1.01e60, 0), radius=1e50), 'position[0]'),
    'small radius': (lambda: Circle((0, 0), radius=0.99e-60), 'radius'),
    'small mass': (lambda: Circle((0, 0), radius=1, mass=0.99e-60), 'mass'),
    'short wall': (lambda: Wall((0, 0), (0, 0.99e-60)), 'end'),
}


@pytest.mark.parametrize('name', OUTSIDE)
def test_outside_of_the_ranges_it_is_refused(name):
    make, place = OUTSIDE[name]
    with pytest.raises(SceneError, match='must ') as caught:
        make()
    assert caught.value.place.startswith(place)


def test_a_refusal_tells_rule_and_value():
    scene = [Circle((0, 0), radius=1), Circle((2, 2), radius=1e-16)]
    with pytest.raises(SceneError) as caught:
        Scene(scene)
    rule = 'circles[1].radius: must be at least 1e-12 of the largest coordinate or radius, 2 m, got 1e-16'
    assert str(caught.value) == rule


def test_locked_circles_and_walls_may_be_as_small_as_they_like():
    disks = [Circle((0.5, 0.0), radius=1e-60, locked=True)]
    walls = [Wall((0.0, 0.5), (0.0, 0.5 + 1e-16))]
    balls = [Circle((0.0, 0.0), v, radius=0.1) for v in ((1.0, 0.0), (0.0, 1.0))]
    simulation = Simulation(Scene([*balls, *disks], walls, moving_circles_collide=False))
    simulation.advance_to(1.0)
    assert simulation.contact_count == 2
    assert np.allclose(simulation.velocities, [(-1.0, 0.0), (0.0, -1.0)])


@pytest.mark.parametrize('collide', [True, False])
def test_clocks_set_back_for_a_fast_circle_do_not_stop_a_slow_one(collide):
    """The slow one gets to the tilted wall though clocks tick in less than rounding of its place is worth."""
    c, s = math.cos(0.3), math.sin(0.3)
    wall = Wall((-c, -s), (c, s))
    slow = Circle((-0.5 * s, 0.5 * c), (1e-10 * s, -1e-10 * c), radius=1e-9)
    fast = Circle((50.0, 50.0), (1.0, 0.0), radius=1e-9)
    scene = Scene([slow, fast], [wall], moving_circles_collide=collide)
    for compiled in MODES:
        simulation = run(scene, 6e9, compiled)
        assert simulation.time == 6e9
        assert simulation.contact_count == 1


def test_many_circles_beside_one_that_is_far_away_take_little_memory():
    """All are in one cell of thousands: lists as long as that, one for each cell, would take gigabytes."""
    row = [
        Circle((3.0 * (k % 100), 3.0 * (k // 100)), (1.0, 0.5), radius=1.0) for k in range(3000)
    ]
    scene = Scene([*row, Circle((1e11, 1e11), radius=1.0)])
    world = Simulation(scene, compiled=MODES[-1])._engine.world
    assert len(world.lists) * 4 < 50e6
