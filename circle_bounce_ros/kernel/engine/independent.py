"""
Independent circles, one that moves alone or several that pass through each other: each is followed on its own.

No circle depends on another one, so each goes to the time wanted before the next one is looked at. Of the event queue
only the root is used: the earliest time at which there is something to do. Where the work has to be cut at a
time that all circles have reached, the queue tells whose contact is next.

The same contacts at the same instants as `loop` would find, to the last digit.
"""

from __future__ import annotations

from circle_bounce_ros.kernel.engine.broad_phase import list_number
from circle_bounce_ros.kernel.engine.collision_response import bounce_off
from circle_bounce_ros.kernel.engine.event_queue import update, update_all
from circle_bounce_ros.kernel.engine.loop import (
    BUDGET_SPENT,
    DONE,
    ENDLESS,
    LOG_FULL,
    is_beyond_clock,
    is_endless,
    set_clock_back,
)
from circle_bounce_ros.kernel.engine.prediction import predict_crossing, predict_locked
from circle_bounce_ros.kernel.engine.records import DOWN, NOTHING, Record, World
from circle_bounce_ros.kernel.impact import NEVER


def run_independent(world: World, time: float) -> int:
    """
    Carry out all contacts up to and including a time, circle by circle.

    Returns
    -------
    int
        DONE or LOG_FULL, as `loop.run`; ENDLESS: contacts without end at one instant, which other circles have
        not reached or have gone beyond.

    """
    state = world.state[0]
    until = time - state.epoch
    if world.tree_time[1] > until:
        return DONE
    state.in_order = 0
    while True:
        earliest = NEVER
        for i in range(len(world.moving)):
            circle = world.moving[i]
            cascade = world.cascades[i]
            count = cascade.count
            ends = cascade.ends
            while circle.time_of_hit <= until:
                now = circle.time_of_hit
                if now >= world.span and now > state.late:
                    break
                if circle.kind != NOTHING:
                    if state.keep_log and state.logged == len(world.log):
                        cascade.count = count
                        cascade.ends = ends
                        return LOG_FULL
                    # As `is_endless`, in numbers of this function: a tenth faster.
                    if now > ends:
                        ends = now + world.cascade_span
                        count = 0
                    count += 1
                    if count > world.burst_limit:
                        return ENDLESS
                    state.just_set = 0
                    bounce_off(world, i, now)
                follow(world, circle, now)
            earliest = min(earliest, circle.time_of_hit)
        if earliest > until:
            world.tree_time[1] = earliest
            return DONE
        if is_beyond_clock(state, earliest):
            set_clock_back(world, earliest)
            until = time - state.epoch


def run_independent_in_order(world: World, time: float, at_most: int) -> int:
    """
    Carry out all contacts up to and including a time in the order of time, but about `at_most` steps of work.

    Returns
    -------
    int
        DONE, BUDGET_SPENT, LOG_FULL or ENDLESS, as `loop.run`.

    """
    state = world.state[0]
    last = state.events + at_most
    until = time - state.epoch
    if state.in_order == 0 and world.tree_time[1] <= until:
        update_all(world)
        state.in_order = 1
    while world.tree_time[1] <= until:
        if state.events >= last:
            return BUDGET_SPENT
        i = world.tree_who[1]
        now = world.tree_time[1]
        if now >= world.span and is_beyond_clock(state, now):
            set_clock_back(world, now)
            until = time - state.epoch
            continue
        circle = world.moving[i]
        if circle.kind != NOTHING:
            if state.keep_log and state.logged == len(world.log):
                return LOG_FULL
            if is_endless(world, i, now):
                return ENDLESS
            state.just_set = 0
            bounce_off(world, i, now)
        state.time = now
        follow(world, circle, now)
        update(world, i, circle.time_of_hit)
    return DONE


def follow(world: World, circle: Record, now: float) -> None:
    """Predict the next contact of a circle: follow it from cell to cell until something locked is found."""
    circle.time_of_hit = NEVER
    circle.kind = NOTHING
    table = world.tables[circle.level]
    steps = 0
    while True:
        steps += 1
        predict_locked(world, circle)
        predict_crossing(world, circle, now)
        if circle.time_of_hit <= circle.time_of_cell:
            break
        if circle.side < DOWN:
            circle.column += 2 * circle.side - 1
        else:
            circle.row += 2 * circle.side - 5
        # Nothing locked lies outside of the grid bounds.
        if not (0 <= circle.column < table.columns and 0 <= circle.row < table.rows):
            break
        circle.cell = list_number(table, circle.column, circle.row)
    circle.time_of_hit = max(circle.time_of_hit, now)
    world.state[0].events += steps
