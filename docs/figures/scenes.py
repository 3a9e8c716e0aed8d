"""Drawings of the packaged scenes: where their circles go, from the contacts that the kernel reports."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.typing import NDArray

from circle_bounce_ros.kernel import Circle as KernelCircle
from circle_bounce_ros.kernel import ContactKind, Simulation
from circle_bounce_ros.scene_file import load_scene

from . import style as s

Points = NDArray[np.float64]


@dataclass(frozen=True)
class View:
    """What to show of a scene."""

    scene: str
    until: float  # s
    tail: float  # s: how much of each path up to then
    contacts: bool = False  # mark the contact points and their normals


SCENES = {
    'lesson': View('lesson', 36.0, 36.0, contacts=True),
    'scene_pegboard': View('pegboard', 6.0, 0.4),
    'scene_gas': View('gas', 1.0, 0.1),
    'scene_mixed': View('mixed', 3.0, 0.6),
    'scene_break': View('break', 0.8, 0.8),
    'scene_digits_of_pi': View('digits_of_pi', 1.7, 1.7),
    'scene_billiard': View('billiard', 20.0, 20.0),
}

# Where so many circles move, lines and borders are thin and the start is not shown.
MANY = 40


def paths(
    simulation: Simulation, until: float, tail: float
) -> tuple[list[Points], NDArray[np.void]]:
    """
    Return the path of each moving circle during `tail` s up to `until`, and the contacts on them.

    Returns
    -------
    list of (k, 2) float, m
        Corners of the paths, in the order of `simulation.ids`.
    (c,) array of dtype CONTACT

    """
    simulation.advance_to(until - tail)
    simulation.drain_contacts()
    corners = {
        i: [at] for i, at in zip(simulation.ids.tolist(), simulation.positions, strict=True)
    }
    simulation.advance_to(until)
    contacts = simulation.drain_contacts()
    circles = simulation.scene.circles
    for contact in contacts:
        point = np.array((contact['x'], contact['y']))
        normal = np.array((contact['nx'], contact['ny']))
        a, b = int(contact['a']), int(contact['b'])
        corners[a].append(point - circles[a].radius * normal)
        if contact['kind'] == ContactKind.CIRCLE:
            corners[b].append(point + circles[b].radius * normal)
    for i, at in zip(simulation.ids.tolist(), simulation.positions, strict=True):
        corners[i].append(at)
    return [np.array(corners[i]) for i in simulation.ids.tolist()], contacts


def trajectories(name: str) -> tuple[Figure, dict[str, float]]:
    """Draw a scene: walls, locked circles, the paths of the moving ones and where they are."""
    view = SCENES[name]
    simulation = Simulation(load_scene(view.scene), record_contacts=True)
    lines, contacts = paths(simulation, view.until, view.tail)
    x_min, y_min, x_max, y_max = _bounds(simulation, lines)
    margin = 0.02 * max(x_max - x_min, y_max - y_min)
    height = min(
        4.6, max(1.6, s.WIDTH * (y_max - y_min + 2 * margin) / (x_max - x_min + 2 * margin))
    )
    figure, (axes,) = s.canvas(height, 1.0)
    s.plane(axes, (x_min - margin, x_max + margin), (y_min - margin, y_max + margin))
    for wall in simulation.scene.walls:
        s.wall(axes, wall.start, wall.end)
    for circle in simulation.scene.circles:
        if circle.locked:
            s.locked(axes, circle.position, circle.radius)
    many = len(lines) > MANY
    axes.add_collection(
        LineCollection(
            lines, colors=s.MOVING, linewidths=0.6 if many else 1.2, alpha=0.8, zorder=3
        )
    )
    discs = [
        Circle((x, y), r)
        for (x, y), r in zip(simulation.positions.tolist(), simulation.radii.tolist(), strict=True)
    ]
    border = 0.6 if many else 1.6
    axes.add_collection(
        PatchCollection(
            discs, facecolor=s.MOVING_FILL, edgecolor=s.MOVING, linewidth=border, zorder=4
        )
    )
    if not many:
        for circle in simulation.scene.circles:
            if not circle.locked:
                s.moving(axes, circle.position, circle.radius, faint=True, border=1.2)
    if view.contacts:
        s.before(axes, lines[0][0], 0.3 * (lines[0][1] - lines[0][0]))
        _mark_contacts(axes, contacts, simulation.scene.circles)
    return figure, {
        't': view.until,
        'moving': len(lines),
        'contacts': simulation.contact_count,
        'x of the first': simulation.positions[0, 0],
        'y of the first': simulation.positions[0, 1],
    }


def _mark_contacts(
    axes: Axes, contacts: NDArray[np.void], circles: Sequence[KernelCircle]
) -> None:
    """Mark contact points, and for those with locked circles the normal from circle to circle."""
    for contact in contacts:
        point = np.array((contact['x'], contact['y']))
        normal = np.array((contact['nx'], contact['ny']))
        if contact['kind'] == ContactKind.LOCKED:
            radius = circles[int(contact['a'])].radius
            s.line(axes, point - radius * normal, point, s.NORMAL, width=1.2)
            s.normal(axes, point, 0.8 * radius * normal)
        s.dot(axes, point, s.NORMAL, 4.5)


def _bounds(simulation: Simulation, lines: list[Points]) -> tuple[float, float, float, float]:
    corners = [np.array((wall.start, wall.end)) for wall in simulation.scene.walls]
    corners += [
        np.array(circle.position) + circle.radius * np.array(((-1.0, -1.0), (1.0, 1.0)))
        for circle in simulation.scene.circles
        if circle.locked
    ]
    for line, r in zip(lines, simulation.radii.tolist(), strict=True):
        corners += [line.min(axis=0)[None] - r, line.max(axis=0)[None] + r]
    every = np.concatenate(corners)
    (x_min, y_min), (x_max, y_max) = every.min(axis=0).tolist(), every.max(axis=0).tolist()
    return x_min, y_min, x_max, y_max
