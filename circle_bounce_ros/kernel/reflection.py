"""
What happens at a contact: lesson eq. 2.1-2.4, the vector form, and two free circles.

Functions ending in `_xy` work on components, check nothing and are what the engine calls; the others are
their public faces, and raise ValueError for wrong shapes, a normal of length zero, masses that are not positive
and numbers that are not real, or neither 0 nor between 1e-60 and 1e60 in size; a normal may have any length.
All are pure: they always reflect. Whether bodies approach is the engine's question.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from circle_bounce_ros.kernel.points import components, direction, plain, quantity, vectors


def push_xy(ux: Any, uy: Any, nx: Any, ny: Any, share: Any) -> Any:
    """
    Return the factor of n in an elastic bounce: `2 (u.n) / (n.n share)`.

    `share` is 1 for a locked partner, the sum of the masses for a free one. The normal need not be
    a unit vector: dividing by n.n once is exacter than normalizing first.
    """
    return 2.0 * (ux * nx + uy * ny) / ((nx * nx + ny * ny) * share)


def reflect_xy(vx: Any, vy: Any, nx: Any, ny: Any) -> tuple[Any, Any]:
    """Return `v - 2 (v.n) n / (n.n)`: the part across the surface changes sign."""
    push = push_xy(vx, vy, nx, ny, 1.0)
    return vx - push * nx, vy - push * ny


def exchange_xy(
    ax: Any, ay: Any, bx: Any, by: Any, mass_a: Any, mass_b: Any, nx: Any, ny: Any
) -> tuple[Any, Any, Any, Any]:
    """Return both velocities after two free circles of velocities (ax, ay), (bx, by) collide."""
    push = push_xy(ax - bx, ay - by, nx, ny, mass_a + mass_b)
    px = push * nx
    py = push * ny
    return ax - mass_b * px, ay - mass_b * py, bx + mass_a * px, by + mass_a * py


def reflect(velocity: ArrayLike, normal: ArrayLike) -> NDArray[np.float64]:
    """
    Return the velocity after a completely elastic bounce off a locked body, in vector form.

    `v - 2 (v.n) n`: the component along the normal changes sign, the one along the surface stays,
    so the speed does too.

    Parameters
    ----------
    velocity : (2,) or (n, 2) float, m/s
    normal : (2,) or (n, 2) float, any unit
        Any length but zero; either direction.

    Returns
    -------
    (2,) or (n, 2) float, m/s

    """
    vx, vy = components(velocity, 'velocity')
    nx, ny = direction(normal, 'normal')
    return vectors(*reflect_xy(vx, vy, nx, ny))


class BounceAngles(NamedTuple):
    """The four angles of the lesson, radians, counter-clockwise from +x: float or (n,) float."""

    velocity: Any  # A_v, eq. 2.1
    normal: Any  # A_n, eq. 2.2
    difference: Any  # A_d, eq. 2.3
    after: Any  # A_pc, eq. 2.4


def bounce_angles(velocity: ArrayLike, normal: ArrayLike) -> BounceAngles:
    """
    Return the angles of a bounce in the lesson's own steps, eq. 2.1-2.4.

    A_v = atan(v_v / v_h), A_n = atan((v2 - v1) / (h2 - h1)), both safe in all four quadrants;
    A_d = A_v - A_n; A_pc = A_v - 2 A_d + pi.

    Parameters
    ----------
    velocity : (2,) or (n, 2) float, m/s
    normal : (2,) or (n, 2) float, any unit
        Centre of the other body minus centre of the moving one, any length but zero.

    Returns
    -------
    BounceAngles
        A_v and A_n lie in [-pi, pi]; the others are left as the equations give them.

    """
    vx, vy = components(velocity, 'velocity')
    nx, ny = direction(normal, 'normal')
    angle_v = np.arctan2(vy, vx)
    angle_n = np.arctan2(ny, nx)
    angle_d = angle_v - angle_n
    angle_pc = angle_v - 2.0 * angle_d + np.pi
    return BounceAngles(plain(angle_v), plain(angle_n), plain(angle_d), plain(angle_pc))


def reflect_by_angles(velocity: ArrayLike, normal: ArrayLike) -> NDArray[np.float64]:
    """
    Return the velocity after a bounce off a locked body by the lesson's angles, eq. 2.1-2.4.

    The new components are the old speed times cosine and sine of A_pc. Same result as `reflect`.

    Parameters
    ----------
    velocity : (2,) or (n, 2) float, m/s
    normal : (2,) or (n, 2) float, any unit

    Returns
    -------
    (2,) or (n, 2) float, m/s

    """
    vx, vy = components(velocity, 'velocity')
    speed = np.hypot(vx, vy)
    after = bounce_angles(velocity, normal).after
    return vectors(speed * np.cos(after), speed * np.sin(after))


def exchange(
    velocity_a: ArrayLike,
    velocity_b: ArrayLike,
    mass_a: ArrayLike,
    mass_b: ArrayLike,
    normal: ArrayLike,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """
    Return both velocities after two free circles collide elastically.

    An impulse `2 m_a m_b / (m_a + m_b) ((v_a - v_b).n) n` goes from a to b: momentum and kinetic
    energy both stay. Equal masses exchange their components along the normal.

    Parameters
    ----------
    velocity_a, velocity_b : (2,) or (n, 2) float, m/s
    mass_a, mass_b : float or (n,) float, kg
        Greater than 0.
    normal : (2,) or (n, 2) float, any unit
        Along the line of centres; any length but zero, either direction.

    Returns
    -------
    velocity_a, velocity_b : (2,) or (n, 2) float, m/s

    """
    ax, ay = components(velocity_a, 'velocity_a')
    bx, by = components(velocity_b, 'velocity_b')
    nx, ny = direction(normal, 'normal')
    masses = quantity(mass_a, 'mass_a', positive=True), quantity(mass_b, 'mass_b', positive=True)
    ax, ay, bx, by = exchange_xy(ax, ay, bx, by, *masses, nx, ny)
    return vectors(ax, ay), vectors(bx, by)
