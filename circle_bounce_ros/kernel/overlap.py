"""How deep do bodies overlap: asked of a scene before it starts and of a simulation at any time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.kernel import candidates
from circle_bounce_ros.kernel.candidates import Pairs

if TYPE_CHECKING:
    from circle_bounce_ros.kernel.scene import Scene

Floats = NDArray[np.float64]

EPSILON = float(np.finfo(float).eps)

# Candidate pairs of circles, for each circle and at least. Circles that do not overlap have fewer, so the search
# for a deeper overlap ends here.
ENOUGH_FOR_EACH = 32
ENOUGH = 1_000_000


class Overlap(NamedTuple):
    """Two bodies and their overlap: circles by id, or a circle and a wall by number."""

    excess: float  # m, what the overlap has beyond the allowance
    depth: float  # m, negative: the smallest gap
    a: int
    b: int
    b_is_wall: bool


NONE = Overlap(-np.inf, -np.inf, -1, -1, False)


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


def deepest(bodies: Bodies, allowed: float = 0.0, roundings: float = 0.0) -> Overlap:
    """
    Return the pair whose overlap exceeds the allowance most, locked bodies among themselves left out.

    Parameters
    ----------
    bodies : Bodies
    allowed : float, no unit
        The allowance, as a fraction of the smaller radius.
    roundings : float, no unit
        Beside it, in units of 2.2e-16 times the largest coordinate or radius of the pair.

    Returns
    -------
    Overlap
        Its depth is negative when nothing overlaps; then it is the nearest pair found, and the
        gaps of pairs that are no neighbours are not looked at. Where very many circles overlap,
        it is the deepest of the first 32 pairs a circle, a million at least.

    """
    return max(
        _among_circles(bodies, allowed, roundings * EPSILON),
        _with_walls(bodies, allowed, roundings * EPSILON),
    )


def _among_circles(bodies: Bodies, allowed: float, rounding: float) -> Overlap:
    enough = max(ENOUGH, ENOUGH_FOR_EACH * len(bodies.radii))
    best, count = NONE, 0
    size = np.maximum(np.abs(bodies.positions).max(axis=1), bodies.radii)
    for i, j in circle_candidates(bodies):
        radius_i, radius_j = bodies.radii[i], bodies.radii[j]
        gap = np.hypot(*(bodies.positions[i] - bodies.positions[j]).T)
        depth = radius_i + radius_j - gap
        allowance = allowed * np.minimum(radius_i, radius_j)
        excess = depth - allowance - rounding * np.maximum(size[i], size[j])
        k = int(np.argmax(excess))
        a, b = sorted((int(i[k]), int(j[k])))
        best = max(best, Overlap(float(excess[k]), float(depth[k]), a, b, False))
        count += len(i)
        if count > enough and best.excess > 0.0:
            break
    return best


def circle_candidates(bodies: Bodies) -> Iterator[Pairs]:
    """
    Yield the pairs of circles that may overlap, in pieces.

    A grid for each size class, in which every circle of this class or a smaller one looks up its
    own cell and the eight around it. Locked and moving circles have grids of their own: pairs that
    do not count are not made.
    """
    size = candidates.size_classes(bodies.radii)
    moving, locked = np.flatnonzero(~bodies.locked), np.flatnonzero(bodies.locked)
    for level in np.unique(size):
        movers, posts = moving[size[moving] == level], locked[size[locked] == level]
        side = float(np.ldexp(1.0, level + 1))
        smaller = moving[size[moving] < level]
        if bodies.moving_circles_collide:
            yield from candidates.within(bodies.positions, movers, side)
            yield from candidates.between(bodies.positions, movers, smaller, side)
        yield from candidates.between(bodies.positions, posts, smaller, side)
        yield from candidates.between(bodies.positions, posts, movers, side)
        smaller = locked[size[locked] < level]
        yield from candidates.between(bodies.positions, movers, smaller, side)


def _with_walls(bodies: Bodies, allowed: float, rounding: float) -> Overlap:
    """Distance of each moving circle's centre from the nearest point of each wall near it."""
    along = bodies.walls[:, 2:] - bodies.walls[:, :2]
    length = np.hypot(*along.T)
    units = along / length[:, None]
    best = NONE
    size = np.maximum(np.abs(bodies.positions).max(axis=1), bodies.radii)
    size_of_wall = np.abs(bodies.walls).max(axis=1)
    for circle, wall in wall_candidates(bodies):
        radius, unit = bodies.radii[circle], units[wall]
        offset = bodies.positions[circle] - bodies.walls[wall, :2]
        foot = offset[:, 0] * unit[:, 0] + offset[:, 1] * unit[:, 1]
        # Across the flat the distance is taken from the normal: exacter than from the foot.
        across = offset[:, 1] * unit[:, 0] - offset[:, 0] * unit[:, 1]
        beyond = foot - np.clip(foot, 0.0, length[wall])
        depth = radius - np.hypot(across, beyond)
        excess = depth - allowed * radius - rounding * np.maximum(size[circle], size_of_wall[wall])
        k = int(np.argmax(excess))
        best = max(
            best, Overlap(float(excess[k]), float(depth[k]), int(circle[k]), int(wall[k]), True)
        )
    return best


def wall_candidates(bodies: Bodies) -> Iterator[Pairs]:
    """Yield the pairs of a moving circle and a wall that may overlap, in pieces."""
    moving = np.flatnonzero(~bodies.locked)
    yield from candidates.with_segments(bodies.positions, bodies.radii, moving, bodies.walls)
