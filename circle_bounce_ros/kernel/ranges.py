"""
Between which magnitudes a scene is exact: what its numbers may be, by themselves and compared with each other.

Inside of these ranges plain and compiled code agree to the bit, nothing leaves a closed box and nothing overflows.
docs/exactness.md has them in a table, with what ends where.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from circle_bounce_ros.kernel.overlap import Bodies

if TYPE_CHECKING:
    from circle_bounce_ros.kernel.scene import Scene

# The radius of a circle that moves, by the largest coordinate or radius. Places are known to 1e-16 of that: at
# 1e-15 circles still stay in a closed box, at 1e-16 they leave it.
SMALLEST_RADIUS = 1e-12

# A speed, in radii of the smallest circle that moves, per second. After a second, times are known to 1e-16 s: in that
# time the fastest circle travels 1e-4 of a radius.
LARGEST_SPEED = 1e12

# The mass of a circle that others hit, in largest masses. A light circle may become faster than the heavy ones were
# by the root of their ratio.
SMALLEST_MASS = 1e-24


def first_fault(scene: Scene, bodies: Bodies) -> tuple[str, str] | None:
    """Return place and problem of a number that is out of range beside others of its scene, if there is one."""
    moving = np.flatnonzero(~bodies.locked)
    circles = [scene.circles[index] for index in moving.tolist()]
    radii = bodies.radii[moving]
    least = int(radii.argmin())
    size = max(
        float(np.abs(numbers).max(initial=0.0))
        for numbers in (bodies.positions, bodies.radii, bodies.walls)
    )
    if radii[least] < SMALLEST_RADIUS * size:
        rule = f'at least {SMALLEST_RADIUS:g} of the largest coordinate or radius, {size:g} m'
        return _fault(moving[least], 'radius', rule, radii[least])
    speeds = np.hypot(*np.array([circle.velocity for circle in circles]).T)
    fastest = int(speeds.argmax())
    if speeds[fastest] > LARGEST_SPEED * radii[least]:
        rule = f'at most {LARGEST_SPEED:g} smallest radii a second, {LARGEST_SPEED * radii[least]:g} m/s'
        return _fault(moving[fastest], 'velocity', rule, speeds[fastest])
    masses = np.array([circle.mass for circle in circles])
    lightest = int(masses.argmin())
    if scene.moving_circles_collide and masses[lightest] < SMALLEST_MASS * masses.max():
        rule = f'at least {SMALLEST_MASS:g} of the largest mass, {masses.max():g} kg'
        return _fault(moving[lightest], 'mass', rule, masses[lightest])
    return None


def _fault(index: int, key: str, rule: str, value: float) -> tuple[str, str]:
    return f'circles[{index}].{key}', f'must be {rule}, got {value:g}'
