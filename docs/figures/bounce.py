"""Drawings of the second half of the lesson: what happens at a contact (eq. 2.1-2.4)."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from circle_bounce_ros.kernel import (
    bounce_angles,
    contact_normal,
    contact_point,
    distance,
    exchange,
    reflect,
)

from . import style as s

Numbers = dict[str, float]


def reflection() -> tuple[Figure, Numbers]:
    """Draw a bounce off a horizontal, a vertical and a tilted surface."""
    figure, panels = s.canvas(3.5, 1.0, 1.0, 1.0)
    r = 0.32
    numbers: Numbers = {}
    cases = (
        ('horizontal', np.array((0.0, -1.0)), np.array((1.0, -0.8))),
        ('vertical', np.array((1.0, 0.0)), np.array((0.8, 1.0))),
        ('tilted', np.array((0.6, -0.8)), np.array((1.35, 0.0))),
    )
    for axes, (name, n, velocity) in zip(panels, cases, strict=True):
        new = reflect(velocity, n)
        center = np.zeros(2)
        point = r * n
        tangent = np.array((-n[1], n[0]))
        s.plane(axes, (-1.75, 1.75), (-2.15, 1.65), f'{name} surface')
        s.wall(axes, point - 1.35 * tangent, point + 1.35 * tangent)
        s.moving(axes, center, r)
        across, along = (velocity @ n) * n, velocity - (velocity @ n) * n
        # The components of both, as the sides of their rectangles.
        s.line(axes, -velocity, -velocity + along, s.HELP, ':')
        s.line(axes, -velocity + along, center, s.HELP, ':')
        s.line(axes, new, new - along, s.HELP, ':')
        s.before(axes, center - velocity, velocity)
        s.after(axes, center, new)
        s.normal(axes, point, 0.75 * n)
        s.dot(axes, center, size=3.0)
        numbers[f"{name} v'h"], numbers[f"{name} v'v"] = (round(c, 12) for c in new.tolist())
        out = 0.28
        tail = -velocity - out * (velocity / math.hypot(*velocity))
        tip = new + out * (new / math.hypot(*new))
        s.label(axes, tail, 'v', s.MOVING)
        s.label(axes, tip, "v'", s.AFTER)
        s.label(axes, point + 0.6 * n + 0.2 * tangent, 'n', s.NORMAL)
        s.label(
            axes, 0.5 * along - across - (0.16 + 0.22 * abs(n[0])) * n, 'along', s.HELP, size=9.0
        )
        s.label(axes, -0.66 * across, 'across', s.HELP, size=9.0)
        numbers[f'{name} vh'], numbers[f'{name} vv'] = velocity.tolist()
        s.caption(axes, f"v = {_vector(velocity)}\nv' = {_vector(new)}")
    return figure, numbers


def angles() -> tuple[Figure, Numbers]:
    """Draw the four angles of eq. 2.1-2.4."""
    a, r1, b, r2 = np.zeros(2), 0.5, np.array((1.2, 0.5)), 0.8
    velocity = np.array((3.0, 4.0))
    found = bounce_angles(velocity, b - a)
    new = reflect(velocity, b - a)
    n = contact_normal(a, b)
    scale = 0.34
    figure, (left, right) = s.canvas(3.5, 3.3, 4.25)
    for axes in (left, right):
        s.moving(axes, a, r1)
        s.locked(axes, b, r2)
        s.line(axes, a, (2.2, 0.0), s.HELP, ':')
        s.line(axes, a, b, s.HELP, '--')
        s.star(axes, contact_point(a, r1, b))
        s.dot(axes, a)
    s.plane(left, (-0.95, 2.35), (-1.4, 1.6), 'before: eq. 2.1, 2.2, 2.3')
    s.before(left, a, scale * velocity)
    s.normal(left, a, 1.75 * n)
    middle = s.angle(left, a, 0.0, found.normal, 0.95, s.NORMAL)
    s.label(left, (middle[0] + 0.22, middle[1] - 0.02), 'A_n', s.NORMAL)
    middle = s.angle(left, a, 0.0, found.velocity, 0.33, s.MOVING)
    s.label(left, (0.18, -0.17), 'A_v', s.MOVING)
    middle = s.angle(left, a, found.normal, found.difference, 0.72, s.INK)
    s.label(left, (middle[0] + 0.2, middle[1] + 0.17), 'A_d')
    s.label(left, (0.86, 1.4), 'v', s.MOVING)
    s.label(left, (1.72, 0.86), 'n', s.NORMAL)

    s.plane(right, (-2.15, 2.1), (-1.4, 1.6), 'after: eq. 2.4')
    s.after(right, a, scale * new)
    s.line(right, -0.25 * velocity, a, s.MOVING, ':', 1.6)
    s.line(right, a, -1.35 * n, s.HELP, '--')
    middle = s.angle(right, a, 0.0, found.after, 0.78, s.AFTER)
    s.label(right, (-0.02, 0.97), 'A_pc', s.AFTER)
    back = found.normal + math.pi
    for turn in (found.difference, -found.difference):
        middle = s.angle(right, a, back, turn, 0.95, s.INK)
        s.label(right, (middle[0] * 1.2, middle[1] * 1.2), 'A_d')
    s.label(right, (-1.87, 0.22), "v'", s.AFTER)
    s.label(right, (-0.62, -1.05), 'where v comes from', s.MOVING, align='left', size=9.5)
    s.label(right, (-1.3, -0.56), 'line of\ncentres', s.HELP, align='right', size=9.5)
    s.caption(
        left,
        f'A_v = {_degrees(found.velocity)}   A_n = {_degrees(found.normal)}   '
        f'A_d = {_degrees(found.difference)}',
    )
    s.caption(right, f'A_pc = A_v - 2 A_d + 180° = {_degrees(found.after)}')
    return figure, {
        'D': distance(a, b),
        'A_v': math.degrees(found.velocity),
        'A_n': math.degrees(found.normal),
        'A_d': math.degrees(found.difference),
        'A_pc': math.degrees(found.after),
        "v'h": new[0],
        "v'v": new[1],
    }


def _vector(value: NDArray[np.float64]) -> str:
    return f'({value[0]:.2f}, {value[1]:.2f}) m/s'


def _degrees(radians: float) -> str:
    return f'{math.degrees(radians):.1f}°'


def exchange_of_velocities() -> tuple[Figure, Numbers]:
    """Draw two free circles that collide, of equal and of unequal masses."""
    figure, panels = s.canvas(3.3, 1.0, 1.0)
    a, r1 = np.zeros(2), 0.5
    velocity = np.array((2.0, 0.0))
    numbers: Numbers = {}
    for axes, (name, mass, r2) in zip(
        panels, (('1 kg and 1 kg', 1.0, 0.5), ('1 kg and 3 kg', 3.0, 0.8)), strict=True
    ):
        n = np.array((0.8, 0.6))
        b = a + (r1 + r2) * n
        new_a, new_b = exchange(velocity, (0.0, 0.0), 1.0, mass, n)
        s.plane(axes, (-1.75, 2.7), (-1.7, 1.65), name)
        s.moving(axes, a, r1)
        s.moving(axes, b, r2)
        s.line(axes, a - 0.5 * n, b + 0.4 * n, s.HELP, '--')
        s.before(axes, a - 0.75 * velocity, 0.75 * velocity)
        s.after(axes, a, 0.75 * new_a)
        s.after(axes, b, 0.75 * new_b)
        s.star(axes, contact_point(a, r1, b))
        s.label(axes, (-1.3, 0.2), 'v', s.MOVING)
        tip = a + 0.75 * new_a
        s.label(axes, (tip[0] + 0.28, tip[1] - 0.08), "v1'", s.AFTER)
        tip = b + 0.75 * new_b
        s.label(axes, (tip[0] + 0.02, tip[1] - 0.24), "v2'", s.AFTER)
        s.label(axes, a + np.array((-0.2, 0.25)), '1', s.MOVING)
        s.label(axes, b + np.array((-0.2, 0.3)), '2', s.MOVING)
        s.caption(axes, f"v1' = {_vector(new_a)}   v2' = {_vector(new_b)}")
        for body, new in ((1, new_a), (2, new_b)):
            numbers[f"{mass:g} kg v{body}'h"], numbers[f"{mass:g} kg v{body}'v"] = (
                round(c, 12) for c in new.tolist()
            )
    return figure, numbers
