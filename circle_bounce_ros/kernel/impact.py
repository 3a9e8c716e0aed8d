"""
When bodies will touch: circle and circle, circle and wall. A wall's end is a circle of radius 0.

Functions ending in `_xy` work on plain numbers, check nothing and are what the engine calls; the others are
their public faces, and raise ValueError for wrong shapes, negative lengths and numbers that are not real, or
neither 0 nor between 1e-60 and 1e60 in size: these keep clear of overflow and underflow.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from circle_bounce_ros.kernel.contact import gap_sq_xy
from circle_bounce_ros.kernel.points import components, plain, point, quantity

NEVER = math.inf


def time_to_touch_xy(
    dx: float, dy: float, du: float, dv: float, reach: float, limit: float = NEVER
) -> float:
    """
    Return when two circles first touch, or `NEVER` if that is surely not before `limit`.

    (dx, dy), (du, dv) are position and velocity of one relative to the other, either way round. See
    `time_to_touch` for the equation; a later time than `limit` may be returned.
    """
    closing = dx * du + dy * dv
    gap_sq: float = gap_sq_xy(dx, dy, reach)
    # sqrt(root) <= -closing below, so the time is at least gap_sq / (-2 closing): most leave here.
    if closing >= 0.0 or gap_sq > -2.0 * closing * limit:
        return NEVER
    if gap_sq <= 0.0:
        return 0.0
    # b^2 - a c without the cancellation of its two large terms: a reach^2 - (d x u)^2.
    cross = dx * dv - dy * du
    root = (du * du + dv * dv) * (reach * reach) - cross * cross
    if root <= 0.0:
        return NEVER
    return gap_sq / (math.sqrt(root) - closing)


def time_to_wall_xy(
    x: float, y: float, vx: float, vy: float, radius: float, nx: float, ny: float, length: float
) -> float:
    """
    Return when a circle first touches the flat of a wall, `NEVER` if it does not.

    (x, y) is the centre relative to the start of the wall, (nx, ny) the wall's unit normal, its
    direction turned left by 90 degrees.
    """
    side = x * nx + y * ny
    speed = vx * nx + vy * ny
    if side < 0.0:
        side = -side
        speed = -speed
    if speed >= 0.0:
        return NEVER
    wait = (side - radius) / -speed
    if wait < 0.0:
        wait = 0.0
    along = (x + vx * wait) * ny - (y + vy * wait) * nx
    if along < 0.0 or along > length:
        return NEVER
    return wait


def time_to_touch(offset: ArrayLike, relative_velocity: ArrayLike, reach: ArrayLike) -> Any:
    """
    Return when two circles first touch.

    The smaller root of |offset + relative_velocity t| = reach, in the form that keeps its digits
    when the gap is small: c / (sqrt(b^2 - a c) - b), with a = u.u, b = d.u, c = d.d - reach^2, and
    b^2 - a c taken as a reach^2 - (d x u)^2.

    Parameters
    ----------
    offset : (2,) or (n, 2) float, m
        Centre of b minus centre of a.
    relative_velocity : (2,) or (n, 2) float, m/s
        Velocity of b minus velocity of a.
    reach : float or (n,) float, m
        Sum of the radii, at least 0.

    Returns
    -------
    float or (n,) float, s
        `inf` when they miss, graze or move apart; 0 when they already touch and close in.

    """
    dx, dy = components(offset, 'offset')
    du, dv = components(relative_velocity, 'relative_velocity')
    rows = np.broadcast(dx, dy, du, dv, quantity(reach, 'reach'))
    times = np.array([time_to_touch_xy(*map(float, row)) for row in rows])
    return plain(times.reshape(rows.shape))


def time_to_wall(
    position: ArrayLike,
    velocity: ArrayLike,
    radius: ArrayLike,
    start: ArrayLike,
    end: ArrayLike,
) -> Any:
    """
    Return when a circle first touches a wall, its flat or one of its ends, from either side.

    The flat is reached after (radius - |s|) / (rate of |s|), with s the distance of the centre
    across the wall; the ends are circles of radius 0.

    Parameters
    ----------
    position : (2,) or (n, 2) float, m
        Centre of the circle.
    velocity : (2,) or (n, 2) float, m/s
    radius : float or (n,) float, m
        At least 0.
    start, end : (2,) float, m
        The ends of the wall, two different points.

    Returns
    -------
    float or (n,) float, s
        `inf` when it misses, grazes an end, moves away or along; 0 when it touches and closes in.

    """
    x, y = components(position, 'position')
    vx, vy = components(velocity, 'velocity')
    (sx, sy), (ex, ey) = point(start, 'start'), point(end, 'end')
    nx, ny, length = wall_frame(sx, sy, ex, ey)
    rows = np.broadcast(x, y, vx, vy, quantity(radius, 'radius'))
    times = []
    for row in rows:
        px, py, ux, uy, r = map(float, row)
        flat = time_to_wall_xy(px - sx, py - sy, ux, uy, r, nx, ny, length)
        ends = (time_to_touch_xy(px - cx, py - cy, ux, uy, r) for cx, cy in ((sx, sy), (ex, ey)))
        times.append(min(flat, *ends))
    return plain(np.array(times).reshape(rows.shape))


def wall_frame(sx: float, sy: float, ex: float, ey: float) -> tuple[float, float, float]:
    """
    Return a wall's unit normal (nx, ny), its direction turned left, and its length.

    Raises
    ------
    ValueError
        When the two ends are the same point.

    """
    dx, dy = ex - sx, ey - sy
    length = math.sqrt(dx * dx + dy * dy)  # not hypot: its last digit differs between Pythons
    if length == 0.0:
        raise ValueError(f'end: must differ from start, got {(ex, ey)} for both')
    return (sy - ey) / length, dx / length, length  # sy - ey, not -dy: no negative zero
