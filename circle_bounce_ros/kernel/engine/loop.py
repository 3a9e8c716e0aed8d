"""From event to event, in order of time."""

from __future__ import annotations

from circle_bounce_ros.kernel.engine.broad_phase import cross
from circle_bounce_ros.kernel.engine.collision_response import bounce_off, collide
from circle_bounce_ros.kernel.engine.motion import move_to
from circle_bounce_ros.kernel.engine.prediction import predict, predict_later
from circle_bounce_ros.kernel.engine.prefetch import prefetch_next
from circle_bounce_ros.kernel.engine.records import CIRCLE, EVERYWHERE, NOTHING, Record, World

# Why `run` came back.
DONE, BUDGET_SPENT, LOG_FULL, LIST_FULL, ENDLESS = 0, 1, 2, 3, 4


def run(world: World, time: float, at_most: int) -> int:
    """
    Carry out all events up to and including a time, but `at_most` so many.

    Returns
    -------
    int
        DONE or BUDGET_SPENT; LOG_FULL or LIST_FULL: make room and call again; ENDLESS: contacts
        without end at one instant. The next event has not been touched then.

    """
    state = world.state[0]
    last = state.events + at_most
    until = time - state.epoch
    while world.tree_time[1] <= until:
        if state.events >= last:
            return BUDGET_SPENT
        i = world.tree_who[1]
        circle = world.moving[i]
        now = max(world.tree_time[1], state.time)
        side = EVERYWHERE
        partner = -1
        if circle.time_of_cell < circle.time_of_hit:
            if not cross(world, i, now):
                return LIST_FULL
            side = circle.side
        elif is_contact(world, circle):
            if now >= world.span and is_beyond_clock(state, now):
                set_clock_back(world, now)
                until = time - state.epoch
                continue
            if state.keep_log and state.logged == len(world.log):
                return LOG_FULL
            if is_endless(world, 0, now):
                return ENDLESS
            state.just_set = 0
            if circle.kind == CIRCLE:
                partner = circle.partner
                collide(world, i, partner, now)
            else:
                bounce_off(world, i, now)
        state.time = now
        state.events += 1
        winner = i
        while i >= 0:  # for the circle and for the one it has hit
            predict(world, i, now, side)
            i = partner
            partner = -1
        if world.prefetches:
            prefetch_next(world, winner)
    return DONE


def is_contact(world: World, circle: Record) -> bool:
    """Return whether the event is a contact that is still valid: a partner that has changed course makes it void."""
    holds: bool = circle.kind != NOTHING
    if circle.kind == CIRCLE:
        holds = world.moving[circle.partner].changes == circle.partner_changes
    return holds


def is_endless(world: World, number: int, now: float) -> bool:
    """Count the contacts of a cascade: those that come close upon each other."""
    cascade = world.cascades[number]
    if now > cascade.ends:
        cascade.ends = now + world.cascade_span
        cascade.count = 0
    cascade.count += 1
    endless: bool = cascade.count > world.burst_limit
    return endless


def is_beyond_clock(state: Record, now: float) -> bool:
    """
    Return whether clocks must be set back before a contact that is due beyond the span.

    Once before a contact is enough. It is due within the span then, or a circle is so slow that the rounding of its
    place is worth more time than that: to set clocks back again would not bring it any closer, for ever.
    """
    if state.just_set != 0:
        state.late = now
    beyond: bool = now > state.late
    return beyond


def set_clock_back(world: World, now: float) -> None:
    """
    Set all clocks back by whole spans, so that digits do not wear out in long runs.

    It is done when a contact is due beyond the span: at instants that the scene fixes, wherever the
    caller stops. All circles move to the new zero and predict afresh. The span is a power of two, so
    the epoch stays exact.
    """
    state = world.state[0]
    back = now - now % world.span  # exact, and no whole number that could be too large
    state.epoch += back
    state.time = max(state.time - back, 0.0)
    state.late = 0.0
    state.just_set = 1
    for number in range(len(world.cascades)):
        world.cascades[number].ends -= back
    # A cell that was entered between the new zero and now stays: nothing changes course in between.
    for i in range(len(world.moving)):
        move_to(world.moving[i], back)
        world.moving[i].time = 0.0
        predict_later(world, i, state.time)
