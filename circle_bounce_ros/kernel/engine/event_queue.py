"""
The event queue: a winner tree over the next events of all moving circles.

A binary tree in two lists. Leaf `world.leaf + i` is circle i with the time of its next event; each inner node holds
the smaller of its two children's times and whose it is; node 1 is the next event of all. Of equal times the one that
was entered later goes first: always the same in the same run.
"""

from __future__ import annotations

from circle_bounce_ros.kernel.engine.records import World


def update_all(world: World) -> None:
    """Enter the next contact of every circle."""
    times = world.tree_time
    who = world.tree_who
    for i in range(len(world.moving)):
        times[world.leaf + i] = world.moving[i].time_of_hit
        who[world.leaf + i] = i
    for node in range(world.leaf - 1, 0, -1):
        winner = 2 * node
        if times[winner + 1] < times[winner]:
            winner += 1
        times[node] = times[winner]
        who[node] = who[winner]


def update(world: World, i: int, time: float) -> None:
    """Enter the time of the next event of circle i."""
    times = world.tree_time
    who = world.tree_who
    node = world.leaf + i
    times[node] = time
    while node > 1:
        rival = times[node ^ 1]
        # The winner's number is read after the comparison: that compiles to a conditional move.
        winner = node
        if rival < time:
            time = rival
            winner = node ^ 1
        best = who[winner]
        node >>= 1
        times[node] = time
        who[node] = best
