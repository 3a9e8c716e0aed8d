"""A contact, carried out: both bodies at its instant, their new velocities, a line in the log."""

from __future__ import annotations

import math

from circle_bounce_ros.kernel.contact import unit_xy
from circle_bounce_ros.kernel.engine.records import CIRCLE, WALL, Moving, World
from circle_bounce_ros.kernel.reflection import exchange_xy, push_xy, reflect_xy


def move_to(circle: Moving, time: float) -> None:
    """Take a circle along its straight path to a time, and make that its own."""
    past = time - circle.time
    circle.x += circle.vx * past
    circle.y += circle.vy * past
    circle.time = time


def bounce(world: World, i: int, time: float) -> int:
    """
    Carry out the contact that circle i has planned.

    Returns
    -------
    int
        The other moving circle's index, -1 if there is none.

    """
    circle = world.moving[i]
    move_to(circle, time)
    circle.changes += 1
    if circle.kind == CIRCLE:
        _collide(world, i, circle.partner)
        return circle.partner
    if circle.kind == WALL:
        flat = world.flats[circle.partner]
        # From the circle to the wall: the normal that the velocity goes along.
        towards = 1.0 if circle.vx * flat.nx + circle.vy * flat.ny >= 0.0 else -1.0
        _reflect(world, circle, flat.id, towards * flat.nx, towards * flat.ny)
    else:
        locked = world.locked[circle.partner]
        _reflect(world, circle, locked.id, locked.x - circle.x, locked.y - circle.y)
    return -1


def _collide(world: World, i: int, j: int) -> None:
    # Whichever of the two has the plan: the same order, so the same digits.
    a, b = world.moving[min(i, j)], world.moving[max(i, j)]
    other = world.moving[j]
    move_to(other, world.moving[i].time)
    other.changes += 1
    nx, ny = b.x - a.x, b.y - a.y
    push = push_xy(a.vx - b.vx, a.vy - b.vy, nx, ny, a.mass + b.mass)
    if push <= 0.0:  # Rounding, far from the origin: they do not approach and are let go.
        return
    a.vx, a.vy, b.vx, b.vy = exchange_xy(a.vx, a.vy, b.vx, b.vy, a.mass, b.mass, nx, ny)
    _note(world, a, b.id, CIRCLE, nx, ny, a.mass * b.mass * push)


def _reflect(world: World, circle: Moving, other: int, nx: float, ny: float) -> None:
    push = push_xy(circle.vx, circle.vy, nx, ny, 1.0)
    if push <= 0.0:
        return
    circle.vx, circle.vy = reflect_xy(circle.vx, circle.vy, nx, ny)
    _note(world, circle, other, circle.kind, nx, ny, circle.mass * push)


def _note(
    world: World, a: Moving, b: int, kind: int, nx: float, ny: float, push: float
) -> None:
    """Count a contact and log it. `push` is the impulse divided by the length of (nx, ny)."""
    world.contacts += 1
    if world.keep_log:
        impulse = push * math.sqrt(nx * nx + ny * ny)
        nx, ny = unit_xy(nx, ny)
        x, y = a.x + a.radius * nx, a.y + a.radius * ny
        world.log.append((world.epoch + a.time, a.id, b, kind, x, y, nx, ny, impulse))
