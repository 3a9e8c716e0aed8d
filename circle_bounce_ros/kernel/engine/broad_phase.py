"""
The broad phase: cell lists in a hierarchical grid, a level for every class of size.

The plane is cut into square cells without end, once for every level; a cell of a coarser level is 2^shift cells of
the finest wide, so that its borders are borders of all finer levels too. A circle is a resident of the level whose
cells it fits in, where `(column, row)` is its cell, and is entered as a proxy on every coarser level. Two circles of
different levels can touch only when their cells on the coarser one are the same or neighbours; two residents of the
finest level likewise. Residents of a coarser level are large for their cells and may touch across one cell in between.

Each cell has a list. The number of a cell is hashed by its low bits, so that distant cells share a list: that costs a
look at circles which are not near and changes no result. Lists have limited room; when one is full the caller
is told before anything has changed.

A circle beyond the outer bounds, a margin around the grid, is outside (`level == levels`): it is in no list. Its path
is straight and the outer bounds are convex, so it comes back at a known time or never. A circle within the grid bounds
cannot touch one that is outside; one in the margin, or outside, has all that are outside for candidates.
"""

from __future__ import annotations

import math

from circle_bounce_ros.kernel.engine.motion import place_at
from circle_bounce_ros.kernel.engine.records import (
    CIRCLES_AT,
    COUNT_AT,
    DOWN,
    EVERYWHERE,
    REACH_AT,
    Record,
    World,
)

# Cells are wider than they need be by this fraction, so that rounding cannot put two circles that touch out
# of each other's reach.
CELL_MARGIN = 1e-9

# How many cells on: neighbours, and those behind them.
NEAR, FAR = 1, 2

# Of a cell's neighbours, three behind each side and all nine; what is far comes behind them in `world.around`.
CELLS_AROUND_NEAR = 21


# ------------------------------------------------------------------ lists


def list_number(table: Record, column: int, row: int) -> int:
    """Return the number of the list that a cell uses."""
    number: int = (column + (row << table.bits)) & table.mask
    return number


def list_at(table: Record, cell: int) -> int:
    """Return where the list of a cell begins; cell numbers beyond the last start again."""
    at: int = table.first + table.stride * (cell & table.mask)
    return at


def append_to_list(world: World, table: Record, cell: int, i: int) -> None:
    """Append circle i to a list that has room."""
    at = list_at(table, cell)
    count = world.lists[at + COUNT_AT]
    world.lists[at + CIRCLES_AT + count] = i
    world.lists[at + COUNT_AT] = count + 1


def remove_from_list(world: World, table: Record, cell: int, i: int) -> None:
    """Take circle i out of a list; the last one takes its place."""
    lists = world.lists
    at = list_at(table, cell)
    left = lists[at + COUNT_AT] - 1
    lists[at + COUNT_AT] = left
    k = at + CIRCLES_AT
    last = lists[k + left]
    while lists[k] != i:
        k += 1
    lists[k] = last


def has_room(world: World, table: Record, cell: int) -> bool:
    """Return whether a list can take one more."""
    count = world.lists[list_at(table, cell) + COUNT_AT]
    room: bool = CIRCLES_AT + count < table.stride
    return room


def reach_of(world: World, table: Record, cell: int) -> Record:
    """Return what is locked in reach of a cell."""
    return world.reaches[world.lists[list_at(table, cell) + REACH_AT]]


# ------------------------------------------------------------------ from cell to cell


def insert(world: World, i: int, x: float, y: float) -> bool:
    """Enter circle i, which is in no list, in those of its place; False, and nothing changed, if one is full."""
    circle = world.moving[i]
    level = 0
    while world.tables[level].fits < circle.radius:
        level += 1
    own = world.tables[level]
    column = math.floor((x - world.x0) / own.width)
    row = math.floor((y - world.y0) / own.width)
    cell = list_number(own, column, row)
    room = has_room(world, own, cell)
    for coarser in range(level + 1, world.levels):
        proxies = world.tables[world.levels + coarser]
        up = proxies.shift - own.shift
        room = room and has_room(world, proxies, list_number(proxies, column >> up, row >> up))
    if not room:
        return False
    circle.level = level
    circle.column = column
    circle.row = row
    circle.cell = cell
    append_to_list(world, own, cell, i)
    for coarser in range(level + 1, world.levels):
        proxies = world.tables[world.levels + coarser]
        up = proxies.shift - own.shift
        append_to_list(world, proxies, list_number(proxies, column >> up, row >> up), i)
    return True


def remove(world: World, i: int) -> None:
    """Take circle i out of all its lists."""
    circle = world.moving[i]
    own = world.tables[circle.level]
    remove_from_list(world, own, circle.cell, i)
    for coarser in range(circle.level + 1, world.levels):
        proxies = world.tables[world.levels + coarser]
        up = proxies.shift - own.shift
        remove_from_list(
            world, proxies, list_number(proxies, circle.column >> up, circle.row >> up), i
        )


def cross(world: World, i: int, now: float) -> bool:
    """Carry out the change of cell that is predicted for circle i; False, and nothing changed, if a list is full."""
    circle = world.moving[i]
    x, y = place_at(circle, now)
    if circle.level == world.levels:
        if not insert(world, i, x, y):
            return False
        return_to_grid(world, i)
    elif is_beyond_outer_bounds(world, x, y):
        leave_grid(world, i)
    else:
        return step_over(world, i)
    circle.side = EVERYWHERE
    return True


def step_over(world: World, i: int) -> bool:
    """Take circle i into the next cell on its own level, and where that is a new one on coarser levels."""
    circle = world.moving[i]
    own = world.tables[circle.level]
    column = circle.column
    row = circle.row
    if circle.side < DOWN:
        column += 2 * circle.side - 1
    else:
        row += 2 * circle.side - 5
    cell = list_number(own, column, row)
    room = has_room(world, own, cell)
    for coarser in range(circle.level + 1, world.levels):
        proxies = world.tables[world.levels + coarser]
        up = proxies.shift - own.shift
        if column >> up != circle.column >> up or row >> up != circle.row >> up:
            room = room and has_room(world, proxies, list_number(proxies, column >> up, row >> up))
    if not room:
        return False
    for coarser in range(circle.level + 1, world.levels):
        proxies = world.tables[world.levels + coarser]
        up = proxies.shift - own.shift
        if column >> up != circle.column >> up or row >> up != circle.row >> up:
            remove_from_list(
                world, proxies, list_number(proxies, circle.column >> up, circle.row >> up), i
            )
            append_to_list(world, proxies, list_number(proxies, column >> up, row >> up), i)
    remove_from_list(world, own, circle.cell, i)
    append_to_list(world, own, cell, i)
    circle.cell = cell
    circle.column = column
    circle.row = row
    return True


# ------------------------------------------------------------------ outside the grid


def is_beyond_outer_bounds(world: World, x: float, y: float) -> bool:
    """Return whether a place is beyond the outer bounds by the edge: no circle is to leave and return at once."""
    edge = world.edge
    return (
        x < world.outer_x0 - edge
        or x > world.outer_x1 + edge
        or y < world.outer_y0 - edge
        or y > world.outer_y1 + edge
    )


def leave_grid(world: World, i: int) -> None:
    """Take circle i out of the grid."""
    remove(world, i)
    state = world.state[0]
    world.outside[state.outside] = i
    state.outside += 1
    world.moving[i].level = world.levels


def return_to_grid(world: World, i: int) -> None:
    """Remove circle i from those that are outside."""
    state = world.state[0]
    k = 0
    while world.outside[k] != i:
        k += 1
    state.outside -= 1
    world.outside[k] = world.outside[state.outside]


# ------------------------------------------------------------------ candidates


def query_neighbours(world: World, circle: Record, side: int) -> int:
    """
    Write the moving circles in reach of one to `world.near`, or those that have come into reach through a side.

    Returns
    -------
    int
        How many.

    """
    if circle.level == world.levels:
        return query_all(world)
    own = world.tables[circle.level]
    if circle.level == 0:
        count = query_cells(world, own, circle.cell, side, NEAR, 0)
    else:
        count = query_cells(world, own, circle.cell, side, FAR, 0)
        proxies = world.tables[world.levels + circle.level]
        count = query_cells(world, proxies, circle.cell, side, NEAR, count)
    for coarser in range(circle.level + 1, world.levels):
        table = world.tables[coarser]
        up = table.shift - own.shift
        if side == EVERYWHERE or is_border(circle, side, up):
            cell = list_number(table, circle.column >> up, circle.row >> up)
            count = query_cells(world, table, cell, side, NEAR, count)
    if world.state[0].outside > 0 and is_outside_grid(own, circle):
        count = append_outside(world, count)
    return count


def query_cells(world: World, table: Record, cell: int, side: int, reach: int, count: int) -> int:
    """Append the lists of the cells in reach of one, or of the row that came into it through a side."""
    candidates = world.candidates
    lists = world.lists
    first = table.first
    stride = table.stride
    mask = table.mask
    row = 2 * reach + 1
    begin = table.neighbour_offsets + (reach - 1) * CELLS_AROUND_NEAR + row * side
    end = begin + row
    if side == EVERYWHERE:
        end = begin + row * row
    for k in range(begin, end):
        at = first + stride * (
            (cell + world.neighbour_offsets[k]) & mask
        )  # `list_at`, its fields read once
        members = lists[at + COUNT_AT]
        at += CIRCLES_AT
        # Most lists hold none, one or two: copying two always is quicker than asking.
        candidates[count] = lists[at]
        candidates[count + 1] = lists[at + 1]
        for m in range(2, members):
            candidates[count + m] = lists[at + m]
        count += members
    return count


def query_all(world: World) -> int:
    """Write all moving circles to `world.near`."""
    for k in range(len(world.moving)):
        world.candidates[k] = k
    return len(world.moving)


def append_outside(world: World, count: int) -> int:
    """Append the circles that are outside."""
    outside: int = world.state[0].outside
    for k in range(outside):
        world.candidates[count + k] = world.outside[k]
    return count + outside


def is_outside_grid(own: Record, circle: Record) -> bool:
    """Return whether a circle in a cell is outside the grid bounds."""
    inside = 0 <= circle.column < own.columns and 0 <= circle.row < own.rows
    return not inside


def is_border(circle: Record, side: int, up: int) -> bool:
    """Return whether the side through which a circle entered its cell is a border `up` doublings coarser too."""
    line: int = circle.column
    if side >= DOWN:
        line = circle.row
    return ((line + 1 - (side & 1)) & ((1 << up) - 1)) == 0
