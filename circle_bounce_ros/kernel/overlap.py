"""How deep do bodies overlap: asked of a scene before it starts and of a simulation at any time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from circle_bounce_ros.kernel.scene import Scene

Floats = NDArray[np.float64]


class Overlap(NamedTuple):
    """Two bodies and their overlap: circles by id, or a circle and a wall by number."""

    depth: float  # m, negative: the smallest gap
    a: int
    b: int
    b_is_wall: bool


NONE = Overlap(-np.inf, -1, -1, False)


@dataclass(frozen=True)
class Bodies:
    """Where everything is at one instant, circles by id, locked ones included."""

    positions: Floats  # (n, 2), m
    radii: Floats  # (n,), m
    locked: NDArray[np.bool_]  # (n,)
    walls: Floats  # (w, 4), m: start and end of each
    moving_circles_collide: bool

    @staticmethod
    def of_scene(scene: Scene) -> Bodies:
        """Return the bodies of a scene at time zero."""
        return Bodies(
            np.array([circle.position for circle in scene.circles], dtype=float).reshape(-1, 2),
            np.array([circle.radius for circle in scene.circles], dtype=float),
            np.array([circle.locked for circle in scene.circles], dtype=bool),
            np.array([wall.start + wall.end for wall in scene.walls], dtype=float).reshape(-1, 4),
            scene.moving_circles_collide,
        )


def deepest(bodies: Bodies, allowed: float = 0.0) -> Overlap:
    """
    Return the pair whose overlap is the deepest, locked bodies among themselves left out.

    Parameters
    ----------
    bodies : Bodies
    allowed : float, no unit
        Counts overlaps from this fraction of the smaller radius on.

    Returns
    -------
    Overlap
        Its depth is negative when nothing overlaps; then it is the nearest pair found, and the
        gaps of pairs whose x ranges do not meet are not looked at.

    """
    return max(_among_circles(bodies, allowed), _with_walls(bodies, allowed))


def _among_circles(bodies: Bodies, allowed: float) -> Overlap:
    """Sweep along x: the k-th next circle is looked at while any range still reaches it."""
    left = bodies.positions[:, 0] - bodies.radii
    order = np.argsort(left, kind='stable')
    position, radius, locked = bodies.positions[order], bodies.radii[order], bodies.locked[order]
    left = left[order]
    right = position[:, 0] + radius
    best = NONE
    first: NDArray[np.intp] = np.arange(len(order))
    step = 0
    while True:
        step += 1
        first = first[first + step < len(order)]
        first = first[left[first + step] <= right[first]]
        if len(first) == 0:
            return best
        second = first + step
        asked = ~(locked[first] & locked[second])
        if not bodies.moving_circles_collide:
            asked &= locked[first] | locked[second]
        i, j = first[asked], second[asked]
        if len(i) == 0:
            continue
        gap = np.hypot(*(position[i] - position[j]).T)
        depth = radius[i] + radius[j] - gap - allowed * np.minimum(radius[i], radius[j])
        k = int(np.argmax(depth))
        a, b = sorted((int(order[i[k]]), int(order[j[k]])))
        best = max(best, Overlap(float(depth[k]), a, b, False))


def _with_walls(bodies: Bodies, allowed: float) -> Overlap:
    """Distance of each moving circle's centre from the nearest point of each wall."""
    ids = np.flatnonzero(~bodies.locked)
    position, radius = bodies.positions[ids], bodies.radii[ids]
    best = NONE
    for number, (sx, sy, ex, ey) in enumerate(bodies.walls):
        start, along = np.array((sx, sy)), np.array((ex - sx, ey - sy))
        length = np.hypot(*along)
        unit = along / length
        offset = position - start
        inside = np.clip(offset @ unit, 0.0, length)
        # Across the flat the distance is taken from the normal: exacter than from the foot.
        across = np.abs(offset @ np.array((-unit[1], unit[0])))
        beyond = offset @ unit - inside
        depth = radius - np.hypot(across, beyond) - allowed * radius
        k = int(np.argmax(depth))
        best = max(best, Overlap(float(depth[k]), int(ids[k]), number, True))
    return best
