"""
Whose plan is the earliest: a tournament among all moving circles.

A binary tree in two lists. Leaf `world.leaf + i` is circle i with the time of its plan; each inner node holds
the smaller of its two children's times and whose it is; node 1 is the winner. Equal times: the lower index.
"""

from __future__ import annotations

from circle_bounce_ros.kernel.engine.records import World


def enter(world: World, i: int, time: float) -> None:
    """Give circle i a time and play its matches again, up to the root."""
    times = world.tree_time
    who = world.tree_who
    node = world.leaf + i
    times[node] = time
    who[node] = i
    best = i
    while node > 1:
        rival = node ^ 1
        # The left one of the two wins a draw.
        if times[rival] < time or (times[rival] == time and rival < node):
            time = times[rival]
            best = who[rival]
        node >>= 1
        times[node] = time
        who[node] = best
