"""
Have two circles touched, where, and along which normal (lesson eq. 1.1-1.5).

Functions ending in `_xy` work on components, check nothing and are what the engine calls. The others are
their public faces: they take points as (2,) or (n, 2), and raise ValueError for other shapes, negative radii and
numbers that are not real, or neither 0 nor between 1e-60 and 1e60 in size.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from circle_bounce_ros.kernel.points import (
    components,
    direction,
    in_range,
    plain,
    quantity,
    vectors,
)


def gap_sq_xy(dx: Any, dy: Any, reach: Any) -> Any:
    """Return `dh^2 + dv^2 - (r1 + r2)^2`: lesson eq. 1.5, positive while two circles are apart."""
    return dx * dx + dy * dy - reach * reach


def unit_xy(dx: float, dy: float) -> tuple[float, float]:
    """Return the unit vector along (dx, dy)."""
    length = math.sqrt(dx * dx + dy * dy)
    return dx / length, dy / length


def distance(center_a: ArrayLike, center_b: ArrayLike) -> Any:
    """
    Return the distance between two centres, `D = (dh^2 + dv^2)^(1/2)`: lesson eq. 1.1.

    Parameters
    ----------
    center_a, center_b : (2,) or (n, 2) float, m

    Returns
    -------
    float or (n,) float, m

    """
    ax, ay = components(center_a, 'center_a')
    bx, by = components(center_b, 'center_b')
    return plain(np.hypot(bx - ax, by - ay))


def in_contact(
    center_a: ArrayLike, radius_a: ArrayLike, center_b: ArrayLike, radius_b: ArrayLike
) -> Any:
    """
    Return whether two circles are in contact, `dh^2 + dv^2 <= (r1 + r2)^2`: lesson eq. 1.2-1.5.

    Touching exactly counts as contact. No root is taken.

    Parameters
    ----------
    center_a, center_b : (2,) or (n, 2) float, m
    radius_a, radius_b : float or (n,) float, m
        At least 0.

    Returns
    -------
    bool or (n,) bool

    """
    ax, ay = components(center_a, 'center_a')
    bx, by = components(center_b, 'center_b')
    reach = quantity(radius_a, 'radius_a') + quantity(radius_b, 'radius_b')
    dx, dy = bx - ax, by - ay
    in_range(np.maximum(abs(dx), abs(dy)) / 2.0, 'center_b - center_a')
    return plain(gap_sq_xy(dx, dy, reach) <= 0.0)


def boxes_overlap(
    center_a: ArrayLike, radius_a: ArrayLike, center_b: ArrayLike, radius_b: ArrayLike
) -> Any:
    """
    Return whether the bounding squares of two circles overlap; touching squares count.

    The lesson's cheap alternative. Squares can overlap at their corners while the circles do not
    touch, so it never misses a contact but reports some that are none: a broad phase.

    Parameters
    ----------
    center_a, center_b : (2,) or (n, 2) float, m
    radius_a, radius_b : float or (n,) float, m
        At least 0.

    Returns
    -------
    bool or (n,) bool

    """
    ax, ay = components(center_a, 'center_a')
    bx, by = components(center_b, 'center_b')
    reach = quantity(radius_a, 'radius_a') + quantity(radius_b, 'radius_b')
    return plain(np.asarray((abs(bx - ax) <= reach) & (abs(by - ay) <= reach)))


def contact_normal(center_a: ArrayLike, center_b: ArrayLike) -> NDArray[np.float64]:
    """
    Return the unit vector from a to b, the normal of a contact between them.

    Two circles touch in a single point of the line of centres; a wall is touched in the foot of
    the perpendicular, which then takes the place of `center_b`.

    Parameters
    ----------
    center_a, center_b : (2,) or (n, 2) float, m

    Returns
    -------
    (2,) or (n, 2) float, no unit

    Raises
    ------
    ValueError
        When two centres coincide: there is no normal.

    """
    ax, ay = components(center_a, 'center_a')
    bx, by = components(center_b, 'center_b')
    dx, dy = direction(vectors(bx - ax, by - ay), 'center_b - center_a')
    if dx.ndim == 0:
        return vectors(*unit_xy(float(dx), float(dy)))
    units = [unit_xy(*pair) for pair in zip(dx.tolist(), dy.tolist(), strict=True)]
    return np.array(units).reshape(-1, 2)


def contact_point(
    center_a: ArrayLike, radius_a: ArrayLike, center_b: ArrayLike
) -> NDArray[np.float64]:
    """
    Return the single point in which a circle touches what lies towards `center_b`.

    Parameters
    ----------
    center_a, center_b : (2,) or (n, 2) float, m
    radius_a : float or (n,) float, m
        At least 0.

    Returns
    -------
    (2,) or (n, 2) float, m

    Raises
    ------
    ValueError
        When two centres coincide.

    """
    ax, ay = components(center_a, 'center_a')
    nx, ny = components(contact_normal(center_a, center_b), 'normal', any_size=True)
    radius = quantity(radius_a, 'radius_a')
    return vectors(ax + radius * nx, ay + radius * ny)
