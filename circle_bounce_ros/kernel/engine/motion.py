"""Where a circle is between two of its own events: on a straight line."""

from __future__ import annotations

from typing import Any

from circle_bounce_ros.kernel.engine.records import Record


def place_at(circle: Record, time: float) -> tuple[Any, Any]:
    """Return where a circle is at a time, if nothing stops it."""
    past = time - circle.time
    return circle.x + circle.vx * past, circle.y + circle.vy * past


def move_to(circle: Record, time: float) -> None:
    """Take a circle along its straight path to a time, and make that its own."""
    past = time - circle.time
    circle.x += circle.vx * past
    circle.y += circle.vy * past
    circle.time = time


def read_positions(moving: Any, state: Any, time: float, rows: Any) -> None:
    """Write where circles are at a time, (n, 2), in the order of the scene."""
    until = time - state[0].epoch
    for circle in moving:
        # As `place_at`, whose call would be a tenth of what a frame of one ball costs.
        past = until - circle.time
        rows[circle.moving_index, 0] = circle.x + circle.vx * past
        rows[circle.moving_index, 1] = circle.y + circle.vy * past
