"""Drawings of the first half of the lesson: have they touched, where, and when (eq. 1.1-1.5)."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from circle_bounce_ros.kernel import (
    boxes_overlap,
    contact_normal,
    contact_point,
    distance,
    in_contact,
    time_to_touch,
    time_to_wall,
)

from . import style as s

Numbers = dict[str, float]


def distance_between_centres() -> tuple[Figure, Numbers]:
    """Draw dh, dv and D of two circles: eq. 1.1."""
    (h1, v1), r1 = (1.0, 1.0), 0.45
    (h2, v2), r2 = (2.8, 2.2), 0.6
    d = distance((h1, v1), (h2, v2))
    figure, (axes,) = s.canvas(3.3, 1.0)
    s.plane(axes, (-1.0, 6.7), (-0.15, 3.15))
    s.arrow(axes, (-0.4, 0.15), (4.5, 0.0), s.HELP, width=1.0, head=10.0)
    s.arrow(axes, (-0.4, 0.15), (0.0, 2.85), s.HELP, width=1.0, head=10.0)
    s.label(axes, (4.0, 0.38), 'h, m', s.HELP)
    s.label(axes, (-0.72, 2.85), 'v, m', s.HELP)
    for x, y, name in ((h1, v1, '1'), (h2, v2, '2')):
        s.line(axes, (x, y), (x, 0.15), s.HELP, ':')
        s.line(axes, (x, y), (-0.4, y), s.HELP, ':')
        s.label(axes, (x, -0.03), f'h{name}')
        s.label(axes, (-0.65, y), f'v{name}')
    s.moving(axes, (h1, v1), r1)
    s.locked(axes, (h2, v2), r2)
    s.measure(axes, (h1, v1), (h2, v1))
    s.measure(axes, (h2, v1), (h2, v2))
    s.measure(axes, (h1, v1), (h2, v2), s.NORMAL)
    s.label(axes, (2.1, 0.82), 'dh')
    s.label(axes, (3.0, 1.32), 'dv')
    s.label(axes, (1.75, 1.73), 'D', s.NORMAL)
    s.label(axes, (h1 - 0.1, v1 + 0.62), '1, moving', s.MOVING)
    s.label(axes, (h2 - 1.25, v2 + 0.42), '2, locked', s.LOCKED)
    s.label(axes, (4.05, 2.2), f'dh = h2 - h1 = {h2 - h1:.2f} m', align='left')
    s.label(axes, (4.05, 1.85), f'dv = v2 - v1 = {v2 - v1:.2f} m', align='left')
    s.label(axes, (4.05, 1.5), f'D = {d:.3f} m', s.NORMAL, align='left')
    return figure, {'dh': h2 - h1, 'dv': v2 - v1, 'D': d}


def contact_test() -> tuple[Figure, Numbers]:
    """Draw two circles apart, touching and overlapping: eq. 1.2-1.5."""
    r1, r2 = 0.4, 0.6
    figure, panels = s.canvas(2.7, 1.0, 1.0, 1.0)
    numbers: Numbers = {'r1 + r2': r1 + r2}
    cases = ((1.3, 'apart', '>'), (1.0, 'touching', '='), (0.75, 'overlapping', '<'))
    for axes, (d, name, sign) in zip(panels, cases, strict=True):
        a, b = (-d / 2.0, 0.0), (d / 2.0, 0.0)
        s.plane(axes, (-1.3, 1.3), (-1.25, 1.05), name)
        s.moving(axes, a, r1)
        s.locked(axes, b, r2)
        s.dot(axes, a)
        s.dot(axes, b)
        s.measure(axes, (a[0], 0.72), (b[0], 0.72), s.NORMAL)
        s.label(axes, (0.0, 0.88), 'D', s.NORMAL)
        s.line(axes, a, b, s.NORMAL)
        # The sum of the radii, laid off from the first centre on.
        for place in (a, b):
            s.line(axes, (place[0], -0.8), (place[0], 0.8), s.HELP, ':')
        s.measure(axes, (a[0], -0.72), (a[0] + r1 + r2, -0.72))
        s.label(axes, (a[0] + (r1 + r2) / 2.0, -0.88), 'r1 + r2')
        answer = in_contact(a, r1, b, r2)
        s.label(axes, (0.0, -1.15), f'{d * d:.2f} {sign} {(r1 + r2) ** 2:.2f}: {answer}')
        numbers[f'D {name}'] = distance(a, b)
        numbers[f'{name}: in contact'] = answer
    return figure, numbers


def squares() -> tuple[Figure, Numbers]:
    """Draw two circles whose squares overlap at a corner, and where squares are wrong at all."""
    r = 0.5
    a, b = (0.0, 0.0), (0.85, 0.8)
    gap = distance(a, b) - 2.0 * r
    figure, (left, right) = s.canvas(3.5, 1.0, 1.0)
    s.plane(left, (-1.0, 2.0), (-0.75, 1.5), 'squares overlap, circles do not')
    s.area(left, [(0.35, 0.3), (0.5, 0.3), (0.5, 0.5), (0.35, 0.5)], '#F2C84B')
    s.moving(left, a, r)
    s.locked(left, b, r)
    s.square(left, a, r, s.MOVING)
    s.square(left, b, r, s.LOCKED)
    s.dot(left, a)
    s.dot(left, b)
    s.line(left, a, b, s.NORMAL)
    s.label(left, (-0.95, 1.25), f'D = {distance(a, b):.3f} m', s.NORMAL, align='left')
    s.label(left, (-0.95, 1.02), f'r1 + r2 = {2 * r:.3f} m', align='left')
    s.label(left, (0.75, -0.3), f'boxes_overlap: {boxes_overlap(a, r, b, r)}', align='left')
    s.label(left, (0.75, -0.53), f'in_contact: {in_contact(a, r, b, r)}', align='left')

    # All places of the second centre: a square of half-width r1 + r2 around a circle of that radius.
    middles = (np.arange(800) + 0.5) / 400.0 - 1.0
    x, y = np.meshgrid(middles, middles)
    places = np.column_stack((x.ravel(), y.ravel()))
    boxes = boxes_overlap(a, r, places, r)
    wrong = boxes & ~in_contact(a, r, places, r)
    s.plane(right, (-1.5, 1.5), (-1.1, 1.3), 'all places of the second centre')
    s.area(right, [(-1, -1), (1, -1), (1, 1), (-1, 1)], '#F2C84B')
    right.add_patch(Circle(a, 2 * r, facecolor='#DCEBF5', edgecolor=s.NORMAL, zorder=2))
    s.square(right, a, 2 * r, s.INK)
    s.moving(right, a, r)
    s.dot(right, a)
    s.measure(right, a, (1.0, 0.0))
    s.label(right, (0.75, 0.15), 'r1 + r2')
    s.label(right, (0.0, -0.72), 'circles touch', s.NORMAL)
    share = float(wrong.sum() / boxes.sum())
    s.label(
        right,
        (0.0, 1.12),
        f'wrong in the yellow corners: {100 * share:.0f} % of the square',
        size=9.5,
    )
    return figure, {
        'D': distance(a, b),
        'gap': gap,
        'boxes overlap': boxes_overlap(a, r, b, r),
        'in contact': in_contact(a, r, b, r),
        'wrong share': round(share, 2),
    }


def point_and_normal() -> tuple[Figure, Numbers]:
    """Draw where a circle touches another one and a wall, and the normals."""
    a, r1, b, r2 = (0.0, 0.0), 0.5, (1.2, 0.5), 0.8
    point, n = contact_point(a, r1, b), contact_normal(a, b)
    figure, (left, right) = s.canvas(3.6, 1.0, 1.0)
    s.plane(left, (-0.95, 2.25), (-1.0, 1.5), 'circle and circle')
    s.moving(left, a, r1)
    s.locked(left, b, r2)
    s.line(left, a, b, s.HELP, '--')
    across = (-n[1], n[0])
    s.line(
        left,
        (point[0] - 0.95 * across[0], point[1] - 0.95 * across[1]),
        (point[0] + 0.7 * across[0], point[1] + 0.7 * across[1]),
        s.HELP,
        '--',
    )
    s.normal(left, point, 0.65 * n)
    s.dot(left, a)
    s.dot(left, b)
    s.star(left, point)
    s.label(left, (a[0], -0.18), '(h1, v1)', s.MOVING)
    s.label(left, (b[0] + 0.12, b[1] + 0.2), '(h2, v2)', s.LOCKED)
    s.label(left, (0.98, 0.17), 'n', s.NORMAL)
    s.label(left, (0.95, -0.72), 'tangent', s.HELP, align='left')
    s.label(left, (-0.85, 1.2), f'contact point\n({point[0]:.3f}, {point[1]:.3f}) m', align='left')
    s.pointer(left, point, (-0.3, 0.98))

    start, end = (-1.0, -0.75), (1.2, -0.2)
    along = contact_normal(start, end)
    center = (0.1, 0.1)
    offset = (center[0] - start[0]) * along[0] + (center[1] - start[1]) * along[1]
    foot = (start[0] + offset * along[0], start[1] + offset * along[1])
    r = distance(center, foot)
    n = contact_normal(center, foot)
    s.plane(right, (-1.45, 1.75), (-1.25, 1.25), 'circle and wall')
    s.moving(right, center, r)
    s.wall(right, start, end)
    s.line(right, center, foot, s.HELP, '--')
    s.normal(right, foot, 0.6 * n)
    s.dot(right, center)
    touch = contact_point(center, r, foot)
    s.star(right, touch)
    s.label(right, (0.34, 0.02), 'r', s.MOVING)
    s.label(right, (foot[0] + 0.32, foot[1] - 0.45), 'n', s.NORMAL)
    s.label(right, (1.0, -0.75), 'foot of the\nperpendicular', align='left', size=9.5)
    s.pointer(right, touch, (0.98, -0.6))
    s.label(right, (-1.0, -0.5), 'wall', s.WALL)
    return figure, {'x': point[0], 'y': point[1], 'nx': n_of(a, b)[0], 'ny': n_of(a, b)[1]}


def n_of(a: s.Point, b: s.Point) -> tuple[float, float]:
    """Return the normal of two centres as plain numbers."""
    x, y = contact_normal(a, b).tolist()
    return x, y


def first_touch() -> tuple[Figure, Numbers]:
    """Draw a circle that frames would let overlap or pass, and the instant of its first touch."""
    start, velocity, r1 = np.array((-2.0, 0.7)), np.array((3.0, 0.0)), 0.3
    other, r2 = np.array((0.35, 0.3)), 0.45
    offset = other - start
    wait = time_to_touch(offset, -velocity, r1 + r2)
    period = 0.36
    figure, (left, right) = s.canvas(3.2, 1.35, 1.0)
    s.plane(left, (-2.5, 1.8), (-0.75, 1.5), 'frames against the instant of first touch')
    s.locked(left, other, r2)
    for k in range(4):
        s.moving(left, start + velocity * (k * period), r1, faint=True)
        s.label(left, (start[0] + velocity[0] * k * period, 1.17), f'frame {k}', s.HELP, size=9.0)
    at = start + velocity * wait
    s.line(left, start, start + velocity * 3 * period, s.HELP, ':')
    s.moving(left, at, r1)
    s.dot(left, at)
    point = contact_point(at, r1, other)
    s.star(left, point)
    s.before(left, start, 0.25 * velocity)
    s.label(left, (-1.45, 0.5), 'v', s.MOVING)
    s.label(left, (-1.2, -0.3), f'first touch\nt = {wait:.4f} s')
    s.pointer(left, point, (-0.75, -0.05))

    times = np.linspace(0.0, 1.15, 200)
    gaps = np.hypot(*(offset[:, None] - velocity[:, None] * times))
    right.plot(times, gaps, color=s.NORMAL, linewidth=1.8)
    right.axhline(r1 + r2, color=s.INK, linestyle='--', linewidth=1.0)
    right.fill_between(times, gaps, r1 + r2, where=list(gaps <= r1 + r2), color=s.LOCKED_FILL)
    for k in range(4):
        t = k * period
        gap = distance(start + velocity * t, other)
        right.plot([t], [gap], 'o', color='white', markeredgecolor=s.MOVING, markersize=7)
    s.star(right, (wait, r1 + r2))
    right.set_xlim(0.0, 1.15)
    right.set_ylim(0.0, 2.6)
    right.set_xlabel('t, s')
    right.set_ylabel('D, m')
    right.text(0.03, r1 + r2 + 0.07, 'r1 + r2', color=s.INK)
    right.text(wait - 0.04, 0.45, 'first\ntouch', ha='right', color=s.INK, linespacing=1.0)
    right.set_title('distance of the centres', fontsize=s.TEXT)
    return figure, {'t': wait, 'D': distance(at, other), 'r1 + r2': r1 + r2}


def wall_and_ends() -> tuple[Figure, Numbers]:
    """Draw a circle that meets the flat of a wall and one that meets its end."""
    start, end, r = (-1.0, -0.35), (1.3, 0.35), 0.35
    figure, (axes,) = s.canvas(3.4, 1.0)
    s.plane(axes, (-3.3, 3.6), (-1.05, 1.8))
    nx, ny = -0.7, 2.3
    length = math.hypot(nx, ny)
    nx, ny = nx / length, ny / length
    for side in (-1.0, 1.0):
        s.line(
            axes,
            (start[0] + side * r * nx, start[1] + side * r * ny),
            (end[0] + side * r * nx, end[1] + side * r * ny),
            s.NORMAL,
            '--',
            zorder=4,
        )
    tilt = math.atan2(end[1] - start[1], end[0] - start[0])
    for center, turn in ((start, tilt + math.pi / 2), (end, tilt - math.pi / 2)):
        arc = np.linspace(turn, turn + math.pi, 60)
        ring = np.column_stack((np.cos(arc), np.sin(arc))) * r + center
        axes.plot(*ring.T, '--', color=s.NORMAL, linewidth=1.0, zorder=4)
        s.dot(axes, center, s.WALL, 6.0)
    s.wall(axes, start, end)
    numbers: Numbers = {}
    for name, place, velocity in (
        ('flat', (-1.1, 1.35), (1.2, -1.2)),
        ('end', (2.75, 1.05), (-1.0, -0.75)),
    ):
        wait = time_to_wall(place, velocity, r, start, end)
        at = (place[0] + velocity[0] * wait, place[1] + velocity[1] * wait)
        s.moving(axes, place, r, faint=True)
        s.moving(axes, at, r)
        s.line(axes, place, at, s.HELP, ':')
        s.before(axes, place, (0.55 * velocity[0], 0.55 * velocity[1]))
        s.dot(axes, at)
        s.star(axes, contact_point(at, r, end if name == 'end' else (at[0] - nx, at[1] - ny)))
        numbers[f't {name}'] = wait
    flat, touch_end = numbers['t flat'], numbers['t end']
    s.label(axes, (-1.55, 1.35), f'meets the flat after {flat:.3f} s', align='right')
    s.label(axes, (1.45, 1.6), f'meets the end after {touch_end:.3f} s', align='left')
    text = 'the centre cannot pass this line:\nparallels of the flat, arcs around the ends'
    s.label(axes, (0.85, -0.72), text, s.NORMAL, align='left', size=9.5)
    s.pointer(axes, (0.71, -0.19), (0.92, -0.54))
    text = 'wall end: a locked\ncircle of radius 0'
    s.label(axes, (-1.45, -0.75), text, s.WALL, align='right', size=9.5)
    s.pointer(axes, start, (-1.42, -0.66))
    return figure, numbers
