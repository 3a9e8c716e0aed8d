"""The collision response: both bodies at the instant of their contact, their new velocities, a line in the log."""

from __future__ import annotations

import math

from circle_bounce_ros.kernel.contact import unit_xy
from circle_bounce_ros.kernel.engine.motion import move_to
from circle_bounce_ros.kernel.engine.records import CIRCLE, WALL, Record, World
from circle_bounce_ros.kernel.reflection import exchange_xy, push_xy, reflect_xy


def collide(world: World, i: int, j: int, time: float) -> None:
    """Resolve the contact of two moving circles."""
    a = world.moving[i]
    b = world.moving[j]
    if a.id > b.id:  # Whichever of the two has the event: the same order, so the same digits.
        a = world.moving[j]
        b = world.moving[i]
    move_to(a, time)
    move_to(b, time)
    a.changes += 1
    b.changes += 1
    nx = b.x - a.x
    ny = b.y - a.y
    push = push_xy(a.vx - b.vx, a.vy - b.vy, nx, ny, a.mass + b.mass)
    if push > 0.0:  # Else rounding, far from the origin: they do not approach and are let go.
        before = a.vx, a.vy, b.vx, b.vy
        a.vx, a.vy, b.vx, b.vy = exchange_xy(a.vx, a.vy, b.vx, b.vy, a.mass, b.mass, nx, ny)
        after = a.vx, a.vy, b.vx, b.vy
        log_contact(world, a, b.id, CIRCLE, nx, ny, a.mass * b.mass * push, before, after)


def bounce_off(world: World, i: int, time: float) -> None:
    """Resolve the contact with something locked that is predicted for circle i."""
    circle = world.moving[i]
    move_to(circle, time)
    circle.changes += 1
    if circle.kind == WALL:
        segment = world.segments[circle.partner]
        other = wall_at(world, segment, circle.x, circle.y)
        nx = segment.nx
        ny = segment.ny
        # From the circle to the wall: the way that the velocity goes.
        if circle.vx * nx + circle.vy * ny < 0.0:
            nx = -nx
            ny = -ny
    else:
        disk = world.disks[circle.partner]
        other = disk.id
        nx = disk.x - circle.x
        ny = disk.y - circle.y
    push = push_xy(circle.vx, circle.vy, nx, ny, 1.0)
    if push > 0.0:
        before = circle.vx, circle.vy, 0.0, 0.0
        circle.vx, circle.vy = reflect_xy(circle.vx, circle.vy, nx, ny)
        after = circle.vx, circle.vy, 0.0, 0.0
        log_contact(world, circle, other, circle.kind, nx, ny, circle.mass * push, before, after)


def wall_at(world: World, segment: Record, x: float, y: float) -> int:
    """Return the number of the wall that a circle at (x, y) touches at a segment."""
    number: int = segment.id
    low = segment.first_part
    high = segment.end_part - 1
    if low <= high:
        along = (x - segment.x) * segment.ny - (y - segment.y) * segment.nx
        while low < high:
            middle = (low + high) // 2
            if world.parts[middle].end < along:
                low = middle + 1
            else:
                high = middle
        number = world.parts[low].id
    return number


def log_contact(
    world: World,
    a: Record,
    b: int,
    kind: int,
    nx: float,
    ny: float,
    push: float,
    before: tuple[float, float, float, float],
    after: tuple[float, float, float, float],
) -> None:
    """
    Count a contact and log it.

    `push` is the impulse divided by the length of (nx, ny); before and after are the velocities of a, then of b.
    """
    state = world.state[0]
    state.contacts += 1
    if state.keep_log:
        line = world.log[state.logged]
        state.logged += 1
        line.time = state.epoch + a.time
        line.a = a.id
        line.b = b
        line.kind = kind
        line.impulse = push * math.sqrt(nx * nx + ny * ny)
        nx, ny = unit_xy(nx, ny)
        line.nx = nx + 0.0  # nobody wants to read a negative zero
        line.ny = ny + 0.0
        line.x = a.x + a.radius * line.nx
        line.y = a.y + a.radius * line.ny
        line.ax0, line.ay0, line.bx0, line.by0 = before
        line.ax1, line.ay1, line.bx1, line.by1 = after
