"""
Who is near: square cells, at least as wide as the widest circle.

Two circles can touch only when their cells are the same or neighbours. The plane has no end, the lists have:
a cell's number is cut to its low bits, so that far-away cells share a list. That costs a look at circles which
are not near and changes no result.

A circle that has gone beyond the porch around everything locked is away: it is in no cell and pays for none. Its
path is straight and the porch convex, so it comes back at a known time or never. Who is inside home cannot
touch who is away; who is on the porch, or away, looks at all that are.
"""

from __future__ import annotations

import math

from circle_bounce_ros.kernel.engine.records import DOWN, EVERYWHERE, LEFT, Grid, Moving, World
from circle_bounce_ros.kernel.impact import NEVER


def list_number(grid: Grid, ix: int, iy: int) -> int:
    """Return the number of the list that cell (ix, iy) uses."""
    return (ix + (iy << grid.bits)) & grid.mask


def settle(world: World, i: int, x: float, y: float) -> None:
    """Enter circle i, which is in no cell, in the one that (x, y) lies in."""
    grid, circle = world.grid, world.moving[i]
    circle.ix = math.floor((x - grid.x0) / grid.width)
    circle.iy = math.floor((y - grid.y0) / grid.width)
    circle.cell = list_number(grid, circle.ix, circle.iy)
    grid.members[circle.cell].append(i)


def cross(world: World, i: int, now: float) -> int:
    """
    Carry out the change of cell that circle i has planned.

    Returns
    -------
    int
        The side whose cells have come into reach.

    """
    grid, circle = world.grid, world.moving[i]
    x, y = place_at(circle, now)
    if circle.away:
        circle.away = False
        world.away.remove(i)
        settle(world, i, x, y)
        return EVERYWHERE
    grid.members[circle.cell].remove(i)
    # One cell beyond the porch: rounding cannot make a circle come and go at one instant.
    x_min, y_min, x_max, y_max = grid.porch
    edge = grid.width
    if x < x_min - edge or x > x_max + edge or y < y_min - edge or y > y_max + edge:
        circle.away = True
        world.away.append(i)
        return EVERYWHERE
    if circle.side < DOWN:
        circle.ix += 2 * circle.side - 1
    else:
        circle.iy += 2 * circle.side - 5
    circle.cell = list_number(grid, circle.ix, circle.iy)
    grid.members[circle.cell].append(i)
    return circle.side


def place_at(circle: Moving, time: float) -> tuple[float, float]:
    """Return where a circle is at a time, if nothing stops it."""
    past = time - circle.time
    return circle.x + circle.vx * past, circle.y + circle.vy * past


def gather(world: World, circle: Moving, side: int) -> list[int]:
    """Return the moving circles in reach of one, or those that have come into reach through a side."""
    if circle.away:
        return list(range(len(world.moving)))
    grid = world.grid
    members, cell, mask = grid.members, circle.cell, grid.mask
    near: list[int] = []
    for offset in grid.around[side]:
        near += members[(cell + offset) & mask]
    if world.away and not (0 <= circle.ix < grid.columns and 0 <= circle.iy < grid.rows):
        near += world.away
    return near


def plan_cell(world: World, circle: Moving, now: float) -> None:
    """Find when a circle leaves its cell, and through which side; when it comes back, if it is away."""
    circle.time_of_cell = NEVER
    if circle.away:
        circle.time_of_cell = now + _wait_to_enter(world.grid.porch, circle, now)
        return
    grid = world.grid
    if circle.vx != 0.0:
        ahead = 1 if circle.vx > 0.0 else 0
        border = grid.x0 + grid.width * (circle.ix + ahead)
        circle.time_of_cell = circle.time + (border - circle.x) / circle.vx
        circle.side = LEFT + ahead
    if circle.vy != 0.0:
        ahead = 1 if circle.vy > 0.0 else 0
        border = grid.y0 + grid.width * (circle.iy + ahead)
        time = circle.time + (border - circle.y) / circle.vy
        if time < circle.time_of_cell:
            circle.time_of_cell = time
            circle.side = DOWN + ahead


def _wait_to_enter(
    porch: tuple[float, float, float, float], circle: Moving, now: float
) -> float:
    """Return how long the straight path of a circle that is away takes to the porch."""
    x_min, y_min, x_max, y_max = porch
    x, y = place_at(circle, now)
    early, late = 0.0, NEVER
    for place, speed, low, high in ((x, circle.vx, x_min, x_max), (y, circle.vy, y_min, y_max)):
        if speed != 0.0:
            first, last = (low - place) / speed, (high - place) / speed
            early = max(early, min(first, last))
            late = min(late, max(first, last))
        elif place < low or place > high:
            return NEVER
    return early if early < late else NEVER
