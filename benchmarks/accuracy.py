"""What everybody gets wrong: energy, overlaps, and bodies that leave a closed box."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.contestants import Contestant
from benchmarks.scenes import across

Floats = NDArray[np.float64]

ROWS_AT_ONCE = 500


def judge(contestant: Contestant, frames: int, every: int) -> dict[str, Any]:
    """
    Let a gas run and look at it.

    Parameters
    ----------
    contestant : Contestant
    frames : int
        How long.
    every : int
        Overlaps are looked for in every so manieth frame.

    Returns
    -------
    dict
        `energy_error`, relative, at the end; `deepest_overlap`, of the smallest radius, of all frames looked
        at; `escaped`, how many centres are outside of the walls at the end.

    """
    radii = np.array([circle.radius for circle in contestant.moving])
    before = energy(contestant)
    deepest = 0.0
    for frame in range(1, frames + 1):
        contestant.show_frame()
        if frame % every == 0:
            positions = contestant.positions()
            deepest = max(deepest, deepest_of_pairs(positions, radii))
            deepest = max(deepest, deepest_in_walls(contestant, positions, radii))
    outside = signed_distances(contestant, contestant.positions()) < 0.0
    return {
        'energy_error': energy(contestant) / before - 1.0,
        'deepest_overlap': deepest / float(radii.min()),
        'escaped': int(outside.any(axis=1).sum()),
        'count': len(radii),
        'frames': frames,
    }


def energy(contestant: Contestant) -> float:
    """Return the kinetic energy, J."""
    squares = np.square(contestant.velocities()).sum(axis=1)
    return float(0.5 * (contestant.masses * squares).sum())


def deepest_of_pairs(positions: Floats, radii: Floats) -> float:
    """Return the deepest overlap of two circles, m: every pair is looked at."""
    deepest = 0.0
    for first in range(0, len(radii), ROWS_AT_ONCE):
        rows = slice(first, first + ROWS_AT_ONCE)
        offset = positions[rows, None] - positions[None, first:]
        gap = np.hypot(offset[..., 0], offset[..., 1])
        depth = radii[rows, None] + radii[None, first:] - gap
        depth[np.arange(len(depth)), np.arange(len(depth))] = 0.0  # each with itself
        deepest = max(deepest, float(depth.max()))
    return deepest


def deepest_in_walls(contestant: Contestant, positions: Floats, radii: Floats) -> float:
    """Return how deep a circle whose centre is still inside is in a wall, m."""
    distances = signed_distances(contestant, positions)
    inside = (distances >= 0.0).all(axis=1)
    depth = radii[inside, None] - distances[inside]
    return max(0.0, float(depth.max(initial=0.0)))


def signed_distances(contestant: Contestant, positions: Floats) -> Floats:
    """Return how far each centre is to the left of each wall, (n, walls), m: inside of the polygon all are."""
    x, y = positions.T
    return np.stack([across(wall, x, y) for wall in contestant.scene.walls], axis=1)
