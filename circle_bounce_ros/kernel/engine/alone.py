"""
A circle that moves alone, or circles that pass through each other: each is followed on its own, without a queue.

Of the tournament only the top is used: the earliest time at which there is something to do.

The same contacts at the same instants as `loop` would find, to the last digit.
"""

from __future__ import annotations

from circle_bounce_ros.kernel.engine.bounce import bounce_off
from circle_bounce_ros.kernel.engine.grid import list_number
from circle_bounce_ros.kernel.engine.loop import DONE, ENDLESS, LOG_FULL, set_clock_back
from circle_bounce_ros.kernel.engine.plan import plan_cell, plan_locked
from circle_bounce_ros.kernel.engine.records import DOWN, NOTHING, Record, World
from circle_bounce_ros.kernel.impact import NEVER


def run_alone(world: World, time: float) -> int:
    """
    Carry out all contacts up to and including a time, circle by circle.

    Returns
    -------
    int
        DONE, LOG_FULL or ENDLESS, as `loop.run`.

    """
    state = world.state[0]
    until = time - state.epoch
    if world.tree_time[1] > until:
        return DONE
    while True:
        earliest = NEVER
        for i in range(len(world.moving)):
            circle = world.moving[i]
            crowd = 0
            crowd_ends = -NEVER
            while circle.time_of_hit <= until and circle.time_of_hit < world.span:
                now = circle.time_of_hit
                if circle.kind != NOTHING:
                    if state.keep_log and state.notes == len(world.log):
                        return LOG_FULL
                    if now > crowd_ends:
                        crowd_ends = now + world.crowd_span
                        crowd = 0
                    crowd += 1
                    if crowd > world.patience:
                        state.time = now
                        world.tree_who[1] = i
                        return ENDLESS
                    bounce_off(world, i, now)
                state.events += 1
                follow(world, circle, now)
            earliest = min(earliest, circle.time_of_hit)
        if earliest > until:
            world.tree_time[1] = earliest
            return DONE
        set_clock_back(world, earliest)
        until = time - state.epoch


def follow(world: World, circle: Record, now: float) -> None:
    """Make the plan of a circle: follow it from cell to cell until something locked is found."""
    circle.time_of_hit = NEVER
    circle.kind = NOTHING
    table = world.tables[circle.level]
    while True:
        plan_locked(world, circle)
        plan_cell(world, circle, now)
        if circle.time_of_hit <= circle.time_of_cell:
            break
        if circle.side < DOWN:
            circle.column += 2 * circle.side - 1
        else:
            circle.row += 2 * circle.side - 5
        # Nothing locked lies outside of home.
        if not (0 <= circle.column < table.columns and 0 <= circle.row < table.rows):
            break
        circle.cell = list_number(table, circle.column, circle.row)
    circle.time_of_hit = max(circle.time_of_hit, now)
