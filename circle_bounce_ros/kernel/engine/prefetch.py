"""
Prefetching among very many circles: bring what the next events need into the processor's cache in time.

An event reads the circle, then the lists of its cell, then the circles in them: each tells where the next one is, and
none is in the cache when there are many. The event queue tells long before which circle is likely to be next: the
winner of a large subtree. Nothing is read or written here that a result depends on, and plain Python does nothing.
"""

from __future__ import annotations

from typing import Any

from circle_bounce_ros.kernel.engine.broad_phase import list_at
from circle_bounce_ros.kernel.engine.records import CIRCLES_AT, COUNT_AT, Record, World

# The winner of one of 2^k subtrees has its turn within about 2^k events. The larger the subtree, the more is
# known of what will be needed: the circle, then its lists, then its neighbours. Found by trying, within 10 %.
CIRCLE_AHEAD, LISTS_AHEAD, NEIGHBOURS_AHEAD = 8, 5, 3

# Of a table's cells around, where all nine begin: see `world.around`.
ALL_NINE, END_OF_NINE = 12, 21


def fetch(array: Any, index: int) -> None:
    """Bring an element of an array near: one instruction where it is compiled, see `compilation`."""


def prefetch_next(world: World, i: int) -> None:
    """Fetch what the winners of the subtrees need that circle i is in."""
    fetch_circle(world, winner_of_subtree(world, i, CIRCLE_AHEAD))
    fetch_lists(world, world.moving[winner_of_subtree(world, i, LISTS_AHEAD)])
    fetch_neighbours(world, world.moving[winner_of_subtree(world, i, NEIGHBOURS_AHEAD)])


def winner_of_subtree(world: World, i: int, ahead: int) -> int:
    """Return the winner of that one of 2^ahead subtrees that circle i is in."""
    winner: int = world.tree_who[(world.leaf + i) >> max(0, world.rounds - ahead)]
    return winner


def fetch_circle(world: World, i: int) -> None:
    """Fetch a circle and its first nodes of the tree."""
    fetch(world.moving, i)
    node = world.leaf + i
    fetch(world.tree_time, node)
    fetch(world.tree_time, node >> 1)
    fetch(world.tree_who, node >> 1)


def fetch_lists(world: World, circle: Record) -> None:
    """Fetch the lists of the cells around a circle."""
    if circle.level < world.levels:
        table = world.tables[circle.level]
        for k in range(table.neighbour_offsets + ALL_NINE, table.neighbour_offsets + END_OF_NINE):
            fetch(world.lists, list_at(table, circle.cell + world.neighbour_offsets[k]))


def fetch_neighbours(world: World, circle: Record) -> None:
    """Fetch the circles in those lists, two of each."""
    if circle.level < world.levels:
        table = world.tables[circle.level]
        for k in range(table.neighbour_offsets + ALL_NINE, table.neighbour_offsets + END_OF_NINE):
            at = list_at(table, circle.cell + world.neighbour_offsets[k])
            fetch(world.moving, world.lists[at + CIRCLES_AT])
            if world.lists[at + COUNT_AT] > 1:
                fetch(world.moving, world.lists[at + CIRCLES_AT + 1])
