"""From event to event, in order of time."""

from __future__ import annotations

import math

from circle_bounce_ros.kernel.engine.bounce import bounce, move_to
from circle_bounce_ros.kernel.engine.grid import cross
from circle_bounce_ros.kernel.engine.plan import plan
from circle_bounce_ros.kernel.engine.records import CIRCLE, EVERYWHERE, NOTHING, World

# Why `run` came back.
DONE, BUDGET_SPENT, CLOCK_FULL, ENDLESS = 0, 1, 2, 3


def run(world: World, until: float, at_most: float) -> int:
    """
    Carry out all events up to and including `until`, but `at_most` so many.

    Returns
    -------
    int
        DONE; BUDGET_SPENT; CLOCK_FULL: `set_clock_back` and call again; ENDLESS: contacts without
        end at one instant, and nothing of the next one has been done.

    """
    last = world.events + at_most
    while world.tree_time[1] <= until:
        if world.events >= last:
            return BUDGET_SPENT
        i = world.tree_who[1]
        circle = world.moving[i]
        now = max(world.tree_time[1], world.time)
        side, partner = EVERYWHERE, -1
        if circle.time_of_cell < circle.time_of_hit:
            side = cross(world, i, now)
        elif _is_contact(world, i):
            if now >= world.span:
                return CLOCK_FULL
            if _is_endless(world, now):
                return ENDLESS
            partner = bounce(world, i, now)
        world.time = now
        world.events += 1
        plan(world, i, now, side)
        if partner >= 0:
            plan(world, partner, now, EVERYWHERE)
    return DONE


def _is_contact(world: World, i: int) -> bool:
    """Return whether the plan still holds: a partner that has changed course makes it void."""
    circle = world.moving[i]
    if circle.kind == CIRCLE:
        return world.moving[circle.partner].changes == circle.partner_changes
    return circle.kind != NOTHING


def _is_endless(world: World, now: float) -> bool:
    if now > world.crowd_ends:
        world.crowd_ends = now + world.crowd_span
        world.crowd = 0
    world.crowd += 1
    return world.crowd > world.patience


def set_clock_back(world: World) -> None:
    """
    Set all clocks back by whole spans, so that digits do not wear out in long runs.

    It is done when a contact is due beyond the span: at instants that the scene fixes, wherever the
    caller stops. All circles move to the new zero and plan afresh. The span is a power of two, so
    the epoch stays exact.
    """
    back = math.floor(world.tree_time[1] / world.span) * world.span
    world.epoch += back
    for circle in world.moving:
        move_to(circle, back)
        circle.time = 0.0
    world.time = max(world.time - back, 0.0)
    world.crowd_ends -= back
    # A cell that was entered between the new zero and now stays: nothing changes course in between.
    for i in range(len(world.moving)):
        plan(world, i, 0.0, EVERYWHERE)
