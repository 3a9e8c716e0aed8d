"""Bodies that touch, far from the origin: places are rounded there, and that is no overlap."""

import itertools
import math

import numpy as np
import pytest

from circle_bounce_ros.kernel import Circle, Scene, SceneError, Simulation, Wall, kinetic_energy

RADIUS = 1e-3
FAR = [0.0, 0.1, 10.0, 1000.0, 1e8]


@pytest.mark.parametrize('x', FAR)
@pytest.mark.parametrize('tilt', [0.0, 0.1, 0.7, math.pi / 2.0, 2.0])
def test_a_row_of_touching_balls_is_a_scene(x, tilt):
    for k in range(50):
        start, step = x + 0.0137 * k, 2.0 * RADIUS
        Scene(
            [
                Circle(
                    (start + step * i * math.cos(tilt), start + step * i * math.sin(tilt)),
                    radius=RADIUS,
                )
                for i in range(5)
            ]
        )


@pytest.mark.parametrize('x', FAR)
def test_a_polygon_of_balls_that_touch_it_is_a_scene(x):
    for corners in range(3, 30):
        angle = [2.0 * math.pi * k / corners for k in range(corners + 1)]
        points = [(x + math.cos(a), -x + math.sin(a)) for a in angle]
        walls = [Wall(start, end) for start, end in itertools.pairwise(points)]
        inner = math.cos(math.pi / corners) - RADIUS
        middles = [a + math.pi / corners for a in angle[:-1]]
        Scene(
            [
                Circle((x + inner * math.cos(a), -x + inner * math.sin(a)), radius=RADIUS)
                for a in middles
            ],
            walls,
        )


@pytest.mark.parametrize('x', FAR)
def test_what_is_more_than_rounding_is_an_overlap_and_told_as_it_is(x):
    overlap = 1e-10 + 64 * 2.0**-52 * x
    nearer = [
        Circle((x, 0.0), radius=RADIUS),
        Circle((x + 2 * RADIUS - overlap, 0), radius=RADIUS),
    ]
    depth = 2.0 * RADIUS - (nearer[1].position[0] - nearer[0].position[0])
    with pytest.raises(SceneError, match='must not overlap') as refused:
        Scene(nearer)
    # Six digits are told.
    assert float(str(refused.value).split()[-2]) == pytest.approx(depth, rel=1e-5)


@pytest.mark.parametrize('x', [0.0, 10.0, 1000.0])
def test_the_cradle_passes_the_velocity_on_from_any_place(x):
    row = [Circle((x + 2.0 * RADIUS * i, 0.0), radius=RADIUS) for i in range(5)]
    striker = Circle((x - 0.01, 0.0), (1.0, 0.0), radius=RADIUS)
    simulation = Simulation(Scene([striker, *row]))
    simulation.advance_to(0.02)
    assert kinetic_energy(simulation) == pytest.approx(0.5, rel=1e-15)
    # Six contacts, each of them rounded.
    expected = np.array([[0.0, 0.0]] * 5 + [[1.0, 0.0]])
    assert simulation.velocities == pytest.approx(expected, abs=6 * 2.0**-52)
