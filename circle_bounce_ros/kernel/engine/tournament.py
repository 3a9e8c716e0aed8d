"""
Whose plan is the earliest: a tournament among all moving circles.

A binary tree in two lists. Leaf `world.leaf + i` is circle i with the time of its plan; each inner node holds
the smaller of its two children's times and whose it is; node 1 is the winner. Of equal
times that of the later match goes first: always the same in the same run.
"""

from __future__ import annotations

from circle_bounce_ros.kernel.engine.records import World


def enter_all(world: World) -> None:
    """Give all circles the times of their contacts, and play all matches."""
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


def enter(world: World, i: int, time: float) -> None:
    """Give circle i a time and play its matches again, up to the root."""
    times = world.tree_time
    who = world.tree_who
    node = world.leaf + i
    times[node] = time
    while node > 1:
        rival = times[node ^ 1]
        # The winner's number is read after the match, not in it: that compiles to a conditional move.
        winner = node
        if rival < time:
            time = rival
            winner = node ^ 1
        best = who[winner]
        node >>= 1
        times[node] = time
        who[node] = best
