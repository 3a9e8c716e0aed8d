"""Drawings of the laws that need no simulation to know, and of how the engine predicts."""

from __future__ import annotations

import math
import random

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from circle_bounce_ros.kernel import (
    Circle,
    Scene,
    Simulation,
    Wall,
    kinetic_energy,
    time_to_touch,
    time_to_wall,
)
from circle_bounce_ros.scene_file.rng import direction

from . import style as s

Numbers = dict[str, float]


def box(width: float, height: float) -> list[Wall]:
    """Return the four walls of a box whose lower left corner is the origin."""
    corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]
    return [Wall(corners[k], corners[(k + 1) % 4]) for k in range(4)]


def digits_of_pi() -> tuple[Figure, Numbers]:
    """Draw two masses in front of a wall over time: 31 contacts for masses of 1 and 100."""
    r = 0.05
    scene = Scene(
        [
            Circle((1.0, 0.0), (0.0, 0.0), radius=r, mass=1.0),
            Circle((2.0, 0.0), (-1.0, 0.0), radius=r, mass=100.0),
        ],
        [Wall((0.0, -1.0), (0.0, 1.0))],
    )
    until = 4.1
    simulation = Simulation(scene, record_contacts=True)
    simulation.advance_to(until)
    times = [0.0, *simulation.drain_contacts()['time'].tolist(), until]
    simulation.reset()
    places = []
    for time in times:
        simulation.advance_to(time)
        places.append(simulation.positions[:, 0])
    light, heavy = np.array(places).T
    figure, (axes,) = s.canvas(3.2, 1.0)
    axes.axhspan(-0.14, 0.0, color=s.WALL)
    axes.text(0.04, -0.07, 'wall', color='white', va='center', fontsize=10.0)
    axes.fill_between(times, heavy - r, heavy + r, color=s.MOVING_FILL, linewidth=0)
    axes.plot(times, heavy, color=s.MOVING, linewidth=2.4)
    axes.plot(times, light, color=s.AFTER, linewidth=1.0)
    axes.text(0.25, 1.88, '100 kg', color=s.MOVING)
    axes.text(0.25, 1.06, '1 kg', color=s.AFTER)
    axes.text(
        1.9,
        1.6,
        f'{simulation.contact_count} contacts: the digits of pi',
        ha='center',
        color=s.INK,
    )
    axes.set_xlim(0.0, until)
    axes.set_ylim(-0.14, 2.5)
    axes.set_xlabel('t, s')
    axes.set_ylabel('distance from the wall, m')
    return figure, {'contacts': simulation.contact_count}


def free_path() -> tuple[Figure, Numbers]:
    """Draw a Sinai billiard with its free area, and its mean free path against pi A / P."""
    side, r, post = 2.0, 0.1, 0.5
    open_area = (side - 2 * r) ** 2 - math.pi * (post + r) ** 2
    border = 4 * (side - 2 * r) + 2 * math.pi * (post + r)
    law = math.pi * open_area / border
    numbers = random.Random(1)
    runs, until = [], 3000.0
    for _ in range(40):
        scene = Scene(
            [
                Circle((0.3, 1.2), direction(numbers.random), radius=r),
                Circle((side / 2, side / 2), radius=post, locked=True),
            ],
            box(side, side),
        )
        simulation = Simulation(scene, record_contacts=True)
        simulation.advance_to(until)
        runs.append(simulation.drain_contacts())
    total = sum(len(run) for run in runs)
    measured = len(runs) * until / total  # m, at a speed of 1 m/s

    figure, (left, right) = s.canvas(3.7, 1.0, 1.15)
    s.plane(left, (-0.06, 2.06), (-0.06, 2.06), 'A: open to the centre, P: its border')
    s.area(left, [(r, r), (side - r, r), (side - r, side - r), (r, side - r)], '#DCEBF5')
    angles = np.linspace(0.0, 2.0 * math.pi, 181)
    ring = np.column_stack((np.cos(angles), np.sin(angles))) * (post + r) + 1.0
    s.area(left, ring.tolist(), 'white')
    left.plot(*ring.T, '--', color=s.NORMAL, linewidth=1.2)
    left.plot(
        [r, side - r, side - r, r, r],
        [r, r, side - r, side - r, r],
        '--',
        color=s.NORMAL,
        linewidth=1.2,
    )
    for wall in scene.walls:
        s.wall(left, wall.start, wall.end)
    s.locked(left, (1.0, 1.0), post)
    few = runs[-1][:7]
    centres = np.column_stack((few['x'] - r * few['nx'], few['y'] - r * few['ny']))
    circle = scene.circles[0]
    left.plot(*np.vstack((circle.position, centres)).T, color=s.MOVING, linewidth=1.2, zorder=4)
    s.moving(left, circle.position, r)
    s.before(left, circle.position, (0.25 * circle.velocity[0], 0.25 * circle.velocity[1]))

    for run in runs[:12]:
        count = np.arange(1, len(run) + 1)
        shown = np.unique(np.geomspace(10, len(run), 200).astype(int)) - 1
        right.semilogx(
            count[shown], run['time'][shown] / count[shown], color=s.MOVING, linewidth=0.7
        )
    right.axhline(law, color=s.NORMAL, linestyle='--', linewidth=2.0, zorder=5)
    right.text(4500, 0.97, f'pi A / P = {law:.4f} m', ha='right', color=s.NORMAL)
    right.text(4500, 0.905, f'all {len(runs)} runs: {measured:.4f} m', ha='right', color=s.MOVING)
    right.set_xlabel('contacts of a run (12 runs shown)')
    right.set_ylabel('mean free path, m')
    right.set_xlim(10, 5200)
    right.set_ylim(0.3, 1.03)
    return figure, {'pi A / P': law, 'contacts': total, 'measured': measured}


def speeds() -> tuple[Figure, Numbers]:
    """Draw the speeds of a gas that started with one speed, against the 2-D Maxwell distribution."""
    count, packing, r = 196, 0.3, 0.02
    side = math.sqrt(count * math.pi * r * r / packing)
    a_row = math.isqrt(count)
    numbers = random.Random(1)
    step = side / a_row
    circles = []
    for k in range(count):
        place = ((k % a_row + 0.5) * step, (k // a_row + 0.5) * step)
        circles.append(Circle(place, direction(numbers.random), radius=r))
    simulation = Simulation(Scene(circles, box(side, side)))
    energy = kinetic_energy(simulation)
    seen = []
    for k in range(150):
        simulation.advance_to(0.5 + 0.02 * k)
        seen.append(np.hypot(*simulation.velocities.T))
    sample = np.concatenate(seen)
    figure, (left, right) = s.canvas(3.5, 1.0, 1.2)
    s.plane(
        left, (-0.02 * side, 1.02 * side), (-0.02 * side, 1.02 * side), f'{count} equal circles'
    )
    for wall in simulation.scene.walls:
        s.wall(left, wall.start, wall.end)
    for place in simulation.positions:
        s.moving(left, place, r, border=1.0)
    mean_sq = 2.0 * energy / count
    right.hist(
        sample, bins=30, range=(0.0, 3.0), density=True, color=s.MOVING_FILL, edgecolor=s.MOVING,
        label='the simulation', linewidth=0.8,
    )  # fmt: skip
    v = np.linspace(0.0, 3.0, 200)
    right.plot(
        v,
        2.0 * v / mean_sq * np.exp(-v * v / mean_sq),
        color=s.NORMAL,
        linewidth=2.0,
        label='Maxwell',
    )
    right.axvline(
        1.0, color=s.AFTER, linestyle='--', linewidth=1.4, label='all speeds at the start'
    )
    right.set_xlabel('speed, m/s')
    right.set_ylabel('share, s/m')
    right.set_xlim(0.0, 3.0)
    right.legend(frameon=False, fontsize=10.0)
    error = kinetic_energy(simulation) / energy - 1.0
    return figure, {
        'contacts': simulation.contact_count,
        'mean speed': float(sample.mean()),
        'Maxwell': math.sqrt(math.pi * mean_sq) / 2.0,
        'energy error below 1e-12': abs(error) < 1e-12,
    }


def next_events() -> tuple[Figure, Numbers]:
    """Draw the next events of four circles, and the winner tree that finds the earliest."""
    width, height = 4.0, 3.0
    post = Circle((2.05, 1.35), radius=0.4, locked=True)
    moving = [
        Circle((0.6, 2.3), (0.9, -0.45), radius=0.3),
        Circle((3.2, 0.6), (-0.9, 0.6), radius=0.3),
        Circle((2.8, 2.4), (0.9, -0.25), radius=0.3),
        Circle((0.8, 0.7), (-0.1, -0.5), radius=0.3),
    ]
    walls = box(width, height)
    times = []
    for circle in moving:
        offsets = [
            (o.position[0] - circle.position[0], o.position[1] - circle.position[1])
            for o in (*moving, post)
        ]
        closing = [
            (o.velocity[0] - circle.velocity[0], o.velocity[1] - circle.velocity[1])
            for o in (*moving, post)
        ]
        hits = [
            time_to_touch(offset, speed, circle.radius + o.radius)
            for offset, speed, o in zip(offsets, closing, (*moving, post), strict=True)
            if o is not circle
        ]
        hits += [
            time_to_wall(circle.position, circle.velocity, circle.radius, wall.start, wall.end)
            for wall in walls
        ]
        times.append(min(hits))

    figure, (left, right) = s.canvas(3.7, 1.15, 1.0)
    s.plane(left, (-0.1, width + 0.1), (-0.1, height + 0.1), 'each circle has a next event')
    for wall in walls:
        s.wall(left, wall.start, wall.end)
    s.locked(left, post.position, post.radius)
    first = int(np.argmin(times))
    for k, (circle, time) in enumerate(zip(moving, times, strict=True)):
        (x, y), (vx, vy) = circle.position, circle.velocity
        color = s.AFTER if k == first else s.MOVING
        s.moving(left, (x, y), circle.radius)
        s.moving(left, (x + vx * time, y + vy * time), circle.radius, faint=True)
        s.arrow(left, (x, y), (vx * time, vy * time), color, width=1.6, head=11.0)
        speed = math.hypot(vx, vy)
        s.label(left, (x - 0.16 * vx / speed, y - 0.16 * vy / speed), str(k), s.MOVING)
    _winner_tree(right, times)
    return figure, {f't of {k}': time for k, time in enumerate(times)}


def _winner_tree(axes: Axes, times: list[float]) -> None:
    s.plane(axes, (-0.6, 3.6), (-0.55, 2.7), 'the earliest event is at the root')
    leaves = [(float(k), 0.0) for k in range(4)]
    halves = [(0.5, 1.0), (2.5, 1.0)]
    root = (1.5, 2.0)
    winners = [min((0, 1), key=lambda k: times[k]), min((2, 3), key=lambda k: times[k])]
    champion = min(winners, key=lambda k: times[k])
    for k, leaf in enumerate(leaves):
        won = k == champion
        s.line(axes, leaf, halves[k // 2], s.AFTER if won else s.HELP, width=2.0 if won else 1.0)
    for k, half in enumerate(halves):
        won = winners[k] == champion
        s.line(axes, half, root, s.AFTER if won else s.HELP, width=2.0 if won else 1.0)
    nodes = [
        *((place, k) for k, place in enumerate(leaves)),
        *((place, winners[k]) for k, place in enumerate(halves)),
        (root, champion),
    ]
    for place, k in nodes:
        axes.text(
            *place,
            f'circle {k}\n{times[k]:.3f} s',
            ha='center',
            va='center',
            fontsize=9.5,
            zorder=8,
            bbox={
                'boxstyle': 'round,pad=0.35',
                'facecolor': '#F1E8F6' if k == champion else 'white',
                'edgecolor': s.AFTER if k == champion else s.HELP,
            },
        )
