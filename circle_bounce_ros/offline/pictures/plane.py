"""Circles and walls in the plane, for the pictures that show where things are."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from numpy.typing import NDArray

from circle_bounce_ros.kernel import Scene
from circle_bounce_ros.offline.observables import Window
from circle_bounce_ros.offline.pictures.style import LOCKED, LOCKED_FILL, WALL
from circle_bounce_ros.offline.source import Source

RIM = 0.02  # of the longer side, around what is to be seen


def view_of(source: Source) -> Window:
    """Return what is to be seen of the plane: everything that stands still, else where circles go."""
    scene = source.scene
    spots = [end for wall in scene.walls for end in (wall.start, wall.end)]
    around = [c for c in scene.circles if c.locked or not spots]
    for circle in around:
        (x, y), r = circle.position, circle.radius
        spots += [(x - r, y - r), (x + r, y + r)]
    if not scene.walls or np.ptp(np.array(spots), axis=0).min() == 0.0:
        # Nothing keeps the circles in.
        radii = np.array([[circle.radius] for circle in source.moving])
        for frame in source.frames():
            spots.append(tuple((frame.positions - radii).min(axis=0)))
            spots.append(tuple((frame.positions + radii).max(axis=0)))
    low, high = np.array(spots).min(axis=0), np.array(spots).max(axis=0)
    rim = RIM * float((high - low).max())
    left, bottom = (low - rim).tolist()
    right, top = (high + rim).tolist()
    return Window((left, bottom), (right, top))


def show_plane(axes: Axes, view: Window) -> None:
    """Make a panel a piece of the plane, metres alike in x and y."""
    axes.set_xlim(view.low[0], view.high[0])
    axes.set_ylim(view.low[1], view.high[1])
    axes.set_aspect('equal')
    axes.set_xlabel('x / m')
    axes.set_ylabel('y / m')


def draw_still(axes: Axes, scene: Scene) -> None:
    """Draw walls and locked circles."""
    for wall in scene.walls:
        (x1, y1), (x2, y2) = wall.start, wall.end
        axes.plot([x1, x2], [y1, y2], color=WALL, linewidth=2.5, solid_capstyle='round', zorder=2)
    locked = [circle for circle in scene.circles if circle.locked]
    if locked:
        spots = np.array([circle.position for circle in locked])
        radii = np.array([circle.radius for circle in locked])
        draw_circles(axes, spots, radii, LOCKED_FILL, LOCKED, hatch='////')


def draw_circles(
    axes: Axes,
    spots: NDArray[np.float64],
    radii: NDArray[np.float64],
    fill: str,
    border: str,
    **options: Any,
) -> None:
    """Draw many circles at once: positions (n, 2), m, and radii (n,), m."""
    axes.add_collection(
        EllipseCollection(
            2.0 * radii,
            2.0 * radii,
            np.zeros(len(radii)),
            units='xy',
            offsets=spots,
            offset_transform=axes.transData,
            facecolors=fill,
            edgecolors=border,
            linewidths=0.7,
            zorder=1.5,
            **options,
        )
    )
