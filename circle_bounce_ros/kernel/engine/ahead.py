"""
Looking ahead among very many circles: bring what the next events need into the processor's cache in time.

An event reads the circle, then the lists of its cell, then the circles in them: each tells where the next one is, and
none is in the cache when there are many. The tournament knows long before who is likely to be next: whoever wins a
large part of it. Nothing is read or written here that a result depends on, and in plain Python nothing is done.
"""

from __future__ import annotations

from typing import Any

from circle_bounce_ros.kernel.engine.grid import list_at
from circle_bounce_ros.kernel.engine.records import CIRCLES_AT, COUNT_AT, Record, World

# The winner of one of 2^k parts has its turn within about 2^k events. The rarer the part is won, the more is
# known of what will be needed: the circle, then its lists, then its neighbours. Found by trying, within 10 %.
CIRCLE_AHEAD, LISTS_AHEAD, NEIGHBOURS_AHEAD = 8, 5, 3

# Of a table's cells around, where all nine begin: see `world.around`.
ALL_NINE, END_OF_NINE = 12, 21


def fetch(array: Any, index: int) -> None:
    """Bring an element of an array near: one instruction where it is compiled, see `compilation`."""


def look_ahead(world: World, i: int) -> None:
    """Fetch what the winners of the parts of the tournament need in which circle i has just played."""
    fetch_circle(world, winner_of_part(world, i, CIRCLE_AHEAD))
    fetch_lists(world, world.moving[winner_of_part(world, i, LISTS_AHEAD)])
    fetch_neighbours(world, world.moving[winner_of_part(world, i, NEIGHBOURS_AHEAD)])


def winner_of_part(world: World, i: int, ahead: int) -> int:
    """Return who wins that one of 2^ahead parts of the tournament in which circle i plays."""
    winner: int = world.tree_who[(world.leaf + i) >> max(0, world.rounds - ahead)]
    return winner


def fetch_circle(world: World, i: int) -> None:
    """Fetch a circle and its first matches."""
    fetch(world.moving, i)
    node = world.leaf + i
    fetch(world.tree_time, node)
    fetch(world.tree_time, node >> 1)
    fetch(world.tree_who, node >> 1)


def fetch_lists(world: World, circle: Record) -> None:
    """Fetch the lists of the cells around a circle."""
    if circle.level < world.levels:
        table = world.tables[circle.level]
        for k in range(table.around + ALL_NINE, table.around + END_OF_NINE):
            fetch(world.lists, list_at(table, circle.cell + world.around[k]))


def fetch_neighbours(world: World, circle: Record) -> None:
    """Fetch the circles in those lists, two of each."""
    if circle.level < world.levels:
        table = world.tables[circle.level]
        for k in range(table.around + ALL_NINE, table.around + END_OF_NINE):
            at = list_at(table, circle.cell + world.around[k])
            fetch(world.moving, world.lists[at + CIRCLES_AT])
            if world.lists[at + COUNT_AT] > 1:
                fetch(world.moving, world.lists[at + CIRCLES_AT + 1])
