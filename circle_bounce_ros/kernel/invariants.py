"""What must not change while circles bounce."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.kernel.overlap import Bodies, deepest
from circle_bounce_ros.kernel.simulation import Simulation


def kinetic_energy(simulation: Simulation) -> float:
    """Return the total kinetic energy, `sum(m v^2) / 2`, J. No contact changes it."""
    squares = np.square(simulation.velocities).sum(axis=1)
    return 0.5 * math.fsum(simulation.masses * squares)


def momentum(simulation: Simulation) -> NDArray[np.float64]:
    """Return the total momentum, `sum(m v)`, (2,), N s. Only walls and locked circles change it."""
    parts = simulation.masses[:, None] * simulation.velocities
    return np.array([math.fsum(parts[:, 0]), math.fsum(parts[:, 1])])


def deepest_overlap(simulation: Simulation) -> float:
    """
    Return how deep the deepest overlap is, m; 0 when nothing overlaps.

    Moving circles against moving ones (unless they pass through each other), locked ones and walls.
    """
    bodies = Bodies.of_scene(simulation.scene)
    bodies.positions[simulation.ids] = simulation.positions
    return max(deepest(bodies).depth, 0.0)
