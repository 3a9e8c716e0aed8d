"""
What a circle does next: the soonest of its contacts, and when it leaves its cell.

The instant of a contact follows from the two bodies alone: it is counted from the later of their own last events,
never from the moment of looking. So neither the grid nor the order of looking can change a digit of it.
"""

from __future__ import annotations

from circle_bounce_ros.kernel.engine import tournament
from circle_bounce_ros.kernel.engine.grid import gather, plan_cell
from circle_bounce_ros.kernel.engine.records import (
    CIRCLE,
    EVERYWHERE,
    NOTHING,
    WALL,
    Moving,
    World,
)
from circle_bounce_ros.kernel.impact import NEVER, time_to_touch_xy, time_to_wall_xy


def plan(world: World, i: int, now: float, side: int) -> None:
    """
    Make circle i's plan and enter it in the tournament.

    `side` EVERYWHERE: afresh. Otherwise the circle has just entered a cell through that side: its
    plan holds unless what has come into reach is sooner.
    """
    circle = world.moving[i]
    if side == EVERYWHERE:
        circle.time_of_hit = NEVER
        circle.kind = NOTHING
    if world.collide:
        _plan_circles(world, circle, now, side)
    if not circle.away:
        _plan_locked(world, circle, now)
    plan_cell(world, circle, now)
    tournament.enter(world, i, min(circle.time_of_hit, circle.time_of_cell))


def _plan_circles(world: World, circle: Moving, now: float, side: int) -> None:
    moving = world.moving
    best = circle.time_of_hit
    x, y, vx, vy = circle.x, circle.y, circle.vx, circle.vy
    time, radius = circle.time, circle.radius
    for j in gather(world, circle, side):
        other = moving[j]
        # Both at the later of their two times; the circle itself has no relative velocity: never.
        past = time - other.time
        if past >= 0.0:
            since = time
            dx = x - (other.x + other.vx * past)
            dy = y - (other.y + other.vy * past)
        else:
            since = other.time
            dx = (x - vx * past) - other.x
            dy = (y - vy * past) - other.y
        wait = time_to_touch_xy(
            dx, dy, vx - other.vx, vy - other.vy, radius + other.radius, best - since
        )
        if since + wait < best:
            best = since + wait
            circle.kind = CIRCLE
            circle.partner = j
            circle.partner_changes = other.changes
    if best < circle.time_of_hit:
        circle.time_of_hit = max(best, now)


def _plan_locked(world: World, circle: Moving, now: float) -> None:
    best = circle.time_of_hit
    x, y, vx, vy = circle.x, circle.y, circle.vx, circle.vy
    time, radius = circle.time, circle.radius
    for number in world.grid.locked[circle.cell]:
        locked = world.locked[number]
        dx, dy, reach = x - locked.x, y - locked.y, radius + locked.radius
        wait = time_to_touch_xy(dx, dy, vx, vy, reach, best - time)
        if time + wait < best:
            best = time + wait
            circle.kind = locked.kind
            circle.partner = number
    for number in world.grid.flats[circle.cell]:
        flat = world.flats[number]
        dx, dy = x - flat.x, y - flat.y
        wait = time_to_wall_xy(dx, dy, vx, vy, radius, flat.nx, flat.ny, flat.length)
        if time + wait < best:
            best = time + wait
            circle.kind = WALL
            circle.partner = number
    if best < circle.time_of_hit:
        circle.time_of_hit = max(best, now)
