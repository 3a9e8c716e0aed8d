"""
What a circle does next: the soonest of its contacts, and when it leaves its cell.

The instant of a contact follows from the two bodies alone: it is counted from the later of their own last events,
never from the moment of looking. So neither the grid nor the order of looking can change a digit of it.
"""

from __future__ import annotations

from circle_bounce_ros.kernel.engine.broad_phase import query_neighbours, reach_of
from circle_bounce_ros.kernel.engine.event_queue import update
from circle_bounce_ros.kernel.engine.motion import place_at
from circle_bounce_ros.kernel.engine.records import (
    CIRCLE,
    DOWN,
    EVERYWHERE,
    LEFT,
    LOCKED,
    NOTHING,
    WALL,
    Record,
    World,
)
from circle_bounce_ros.kernel.impact import NEVER, time_to_touch_xy, time_to_wall_xy


def predict(world: World, i: int, now: float, side: int) -> None:
    """
    Predict the next event of circle i and enter it in the event queue.

    `side` EVERYWHERE: afresh. Otherwise the circle has just entered a cell through that side: its
    event stays valid unless what has come into reach is sooner.
    """
    circle = world.moving[i]
    if side == EVERYWHERE:
        circle.time_of_hit = NEVER
        circle.kind = NOTHING
    predict_circles(world, circle, side)
    if circle.level < world.levels:
        predict_locked(world, circle)
    circle.time_of_hit = max(circle.time_of_hit, now)  # rounding must not turn time back
    predict_crossing(world, circle, now)
    update(world, i, min(circle.time_of_hit, circle.time_of_cell))


def predict_later(world: World, i: int, now: float) -> None:
    """Let the loop predict for circle i first thing."""
    circle = world.moving[i]
    circle.time_of_hit = now
    circle.time_of_cell = NEVER
    circle.kind = NOTHING
    update(world, i, now)


def predict_circles(world: World, circle: Record, side: int) -> None:
    """Find the soonest touch of another moving circle, if it is sooner than what is predicted."""
    moving = world.moving
    candidates = world.candidates
    best = circle.time_of_hit
    x = circle.x
    y = circle.y
    vx = circle.vx
    vy = circle.vy
    time = circle.time
    radius = circle.radius
    partner = -1
    for k in range(query_neighbours(world, circle, side)):
        other = moving[candidates[k]]
        # Both at the later of their two times. The circle itself has no relative velocity: never.
        since = max(time, other.time)
        mine = since - time
        past = since - other.time
        ux = other.vx
        uy = other.vy
        dx = (x + vx * mine) - (other.x + ux * past)
        dy = (y + vy * mine) - (other.y + uy * past)
        reach = radius + other.radius
        due = since + time_to_touch_xy(dx, dy, vx - ux, vy - uy, reach, best - since)
        if due < best:
            best = due
            partner = candidates[k]
    if partner >= 0:
        circle.time_of_hit = best
        circle.kind = CIRCLE
        circle.partner = partner
        circle.partner_changes = moving[partner].changes


def predict_locked(world: World, circle: Record) -> None:
    """Find the soonest touch of something locked in reach of the cell, if it is sooner than what is predicted."""
    best = circle.time_of_hit
    x = circle.x
    y = circle.y
    vx = circle.vx
    vy = circle.vy
    time = circle.time
    radius = circle.radius
    reach_of_cell = reach_of(world, world.tables[circle.level], circle.cell)
    for k in range(reach_of_cell.first_disk, reach_of_cell.end_disk):
        number = world.disk_numbers[k]
        disk = world.disks[number]
        reach = radius + disk.radius
        wait = time_to_touch_xy(x - disk.x, y - disk.y, vx, vy, reach, best - time)
        due = time + wait
        if due < best and (disk.kind == LOCKED or is_beyond_walls(circle, disk, wait)):
            best = due
            circle.kind = disk.kind
            circle.partner = number
    for k in range(reach_of_cell.first_segment, reach_of_cell.end_segment):
        number = world.segment_numbers[k]
        segment = world.segments[number]
        due = time + time_to_wall_xy(
            x - segment.x, y - segment.y, vx, vy, radius, segment.nx, segment.ny, segment.length
        )
        if due < best:
            best = due
            circle.kind = WALL
            circle.partner = number
    circle.time_of_hit = best


def is_beyond_walls(circle: Record, disk: Record, wait: float) -> bool:
    """
    Return whether a circle touches an end from beyond the walls that end there, not from beside them.

    From beside them a wall is touched first, unless the circle slides along it: then rounding would make contacts of
    grazes, which come some 1e-8 radii before the end. What is less than 1e-10 radii before it may be rounding too.
    """
    dx = circle.x + circle.vx * wait - disk.x
    dy = circle.y + circle.vy * wait - disk.y
    places = abs(circle.x) + abs(circle.y) + abs(disk.x) + abs(disk.y)
    slack = 1e-10 * circle.radius + 1e-14 * places
    beyond: bool = dx * disk.ax + dy * disk.ay >= -slack and dx * disk.bx + dy * disk.by >= -slack
    return beyond


def predict_crossing(world: World, circle: Record, now: float) -> None:
    """Find when a circle leaves its cell, and through which side; when it comes back, if it is outside."""
    circle.time_of_cell = NEVER
    if circle.level == world.levels:
        circle.time_of_cell = now + wait_to_enter(world, circle, now)
        return
    width = world.tables[circle.level].width
    if circle.vx != 0.0:
        ahead = 1 if circle.vx > 0.0 else 0
        border = world.x0 + width * (circle.column + ahead)
        circle.time_of_cell = circle.time + (border - circle.x) / circle.vx
        circle.side = LEFT + ahead
    if circle.vy != 0.0:
        ahead = 1 if circle.vy > 0.0 else 0
        border = world.y0 + width * (circle.row + ahead)
        time = circle.time + (border - circle.y) / circle.vy
        if time < circle.time_of_cell:
            circle.time_of_cell = time
            circle.side = DOWN + ahead


def wait_to_enter(world: World, circle: Record, now: float) -> float:
    """Return how long the straight path of a circle that is outside takes to the outer bounds."""
    x, y = place_at(circle, now)
    early = 0.0
    late = NEVER
    if circle.vx != 0.0:
        a = (world.outer_x0 - x) / circle.vx
        b = (world.outer_x1 - x) / circle.vx
        early = max(early, min(a, b))
        late = min(late, max(a, b))
    elif x < world.outer_x0 or x > world.outer_x1:
        return NEVER
    if circle.vy != 0.0:
        a = (world.outer_y0 - y) / circle.vy
        b = (world.outer_y1 - y) / circle.vy
        early = max(early, min(a, b))
        late = min(late, max(a, b))
    elif y < world.outer_y0 or y > world.outer_y1:
        return NEVER
    return early if early < late else NEVER
