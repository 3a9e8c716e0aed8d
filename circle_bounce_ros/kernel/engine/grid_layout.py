"""
The grid of a scene: levels of cells of the right width, and all circles entered in them.

How the engine uses it says `broad_phase`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.kernel.engine.broad_phase import CELL_MARGIN, FAR, NEAR
from circle_bounce_ros.kernel.engine.records import (
    CIRCLES_AT,
    COUNT_AT,
    REACH,
    REACH_AT,
    TABLE,
    World,
    aligned_copy,
)

Array = NDArray[Any]

# Every number below is a choice that costs time or memory when it is wrong, never a digit.

# In a thin scene cells grow to so much of the mean gap between circles: fewer borders to cross, more circles in reach.
# Of several levels the finer ones stay narrower, for larger circles look through them too.
GAPS_A_CELL = 1.0
GAPS_A_CELL_OF_LEVELS = 0.7

# A level is split off for smaller circles where nine of its cells would hold more than this many.
SPLIT_ABOVE = 32

# Its cells, in largest radii, are then as narrow as they can be with proxies of up to an eighth of their width.
PROXY = 1.0 / 8.0
COARSE = 1.0 / (1.0 - PROXY)

# No more cells than this along the longer side: memory.
MOST_CELLS_A_SIDE = 4096

# No more room in the lists of a table than for this many entries, or so many for each circle: memory. Where most
# circles are in few cells, as beside one that is far away, lists are long: then there are fewer, shared by more cells.
MOST_ROOM = 1 << 22
MOST_ROOM_A_CIRCLE = 64

# The shortest list of a cell has room for four circles: more of one size do not fit into a cell as wide as they are.
LEAST_STRIDE = CIRCLES_AT + 4


class Grid(NamedTuple):
    """The cells of a world; the grid bounds go from (x0, y0) to (x1, y1), the arrays are those of `World`."""

    x0: float
    y0: float
    x1: float
    y1: float
    widest: float  # of a cell, m
    tables: Array
    lists: Array
    neighbour_offsets: Array
    reaches: Array
    disk_numbers: Array
    segment_numbers: Array


def lay_out(moving: Array, disks: Array, segments: Array, collide: bool) -> Grid:
    """Return the grid for what moves and what is locked; who moves is told level and cell."""
    x0, y0, x1, y1 = _bounds(moving, disks)
    widths = _widths(moving['radius'], x1 - x0, y1 - y0, collide)
    levels = len(widths)
    for halvings in range(MOST_CELLS_A_SIDE.bit_length()):
        tables, neighbour_offsets = _tables(widths, x1 - x0, y1 - y0, halvings)
        moving['level'] = np.searchsorted(tables['fits'][:levels], moving['radius'])
        if not collide or _has_room(tables[:levels], moving, x0, y0):
            break
    lists = _enter_moving(tables, moving, x0, y0, collide)
    locked = _enter_locked(tables[:levels], lists, disks, segments, x0, y0)
    return Grid(x0, y0, x1, y1, float(widths[-1]), tables, lists, neighbour_offsets, *locked)


def with_more_room(world: World) -> World:
    """Return the world with lists twice as long in every table that has a full one."""
    tables = world.tables.copy()
    blocks = []
    first = 0
    for table in tables:
        block = _lists_of(world.lists, table)
        if CIRCLES_AT + block[:, COUNT_AT].max() == table['stride']:
            block = np.hstack([block, np.zeros_like(block)])
        table['first'], table['stride'] = first, block.shape[1]
        first += block.size
        blocks.append(block.ravel())
    lists = aligned_copy(np.concatenate(blocks))
    candidates = scratch(tables, len(world.moving))
    return world._replace(tables=tables, lists=lists, candidates=candidates)


def _lists_of(lists: Array, table: Array) -> Array:
    """Return the lists of a table, one a row."""
    count, stride = int(table['mask']) + 1, int(table['stride'])
    return lists[table['first'] : table['first'] + count * stride].reshape(count, stride)


def scratch(tables: Array, count: int) -> Array:
    """Return room for all that `broad_phase.query_neighbours` may write."""
    most = (2 * FAR + 1) ** 2
    return np.zeros(most * int(tables['stride'].sum()) + 2 * count + 2, np.int32)


def _bounds(moving: Array, disks: Array) -> tuple[float, float, float, float]:
    """Return the box beyond which nothing locked can be touched and no circle starts."""
    widest = 2.0 * float(moving['radius'].max())
    box = []
    for axis in ('x', 'y'):
        low, high = [moving[axis].min()], [moving[axis].max()]
        if len(disks):
            low.append((disks[axis] - disks['radius']).min())
            high.append((disks[axis] + disks['radius']).max())
        box.append((float(min(low)) - widest, float(max(high)) + widest))
    (x0, x1), (y0, y1) = box
    return x0, y0, x1, y1


def _widths(radii: Array, width: float, height: float, collide: bool) -> Array:
    """
    Return the widths of the cells of each level, finest first, each a power of two times the finest.

    One level serves all circles unless nine of its cells would hold more than CROWDED of them; then
    the circles that are small for its cells get a level of their own, and so on.
    """
    area = width * height

    def least(fitting: Array, gaps: float) -> float:
        widest = 2.0 * float(fitting.max()) * (1.0 + CELL_MARGIN)
        gap = math.sqrt(area / len(fitting)) - widest
        return max(widest, gaps * gap, max(width, height) / MOST_CELLS_A_SIDE)

    widths = [least(radii, GAPS_A_CELL)]
    while collide and 9.0 * widths[-1] ** 2 * len(radii) > SPLIT_ABOVE * area:
        needed = COARSE * float(radii.max()) * (1.0 + CELL_MARGIN) ** 2
        needed = max(needed, max(width, height) / MOST_CELLS_A_SIDE)
        coarse = widths[-1]
        if len(widths) == 1:
            coarse = needed
        elif coarse / 2.0 >= needed:
            coarse /= 2.0
        radii = radii[radii * (1.0 + CELL_MARGIN) <= PROXY * coarse]
        if len(radii) == 0:
            break
        narrowest = least(radii, GAPS_A_CELL_OF_LEVELS)
        finer = coarse / 2.0
        if narrowest > finer:
            break
        while finer / 2.0 >= narrowest:
            finer /= 2.0
        widths[-1] = coarse
        widths.append(finer)
    return np.array(widths[::-1])


def _tables(widths: Array, width: float, height: float, halvings: int) -> tuple[Array, Array]:
    """
    Return the tables of residents and of proxies, without members, and each level's cells in reach.

    Of as many lists as there are cells, half along each side for each halving.
    """
    levels = len(widths)
    tables = np.zeros(2 * levels, TABLE)
    neighbour_offsets: list[int] = []
    for number, table in enumerate(tables):
        level = number % levels
        columns, rows = (max(1, math.ceil(side / widths[level])) for side in (width, height))
        # Eight cells a side at least, so that five times five have a list each; the finest level has no proxies.
        bits = [
            max(2 if level == 0 else 3, _bits(cells) - halvings) if number != levels else 0
            for cells in (columns, rows)
        ]
        table['width'] = widths[level]
        table['shift'] = round(math.log2(widths[level] / widths[0]))
        table['bits'], table['mask'] = bits[0], (1 << sum(bits)) - 1
        table['columns'], table['rows'] = columns, rows
        if number < levels:
            proxy = tables['fits'][level - 1] if level > 0 else 0.0
            share = 1.0 if level > 0 else 0.5
            table['fits'] = share * widths[level] / (1.0 + CELL_MARGIN) - proxy
            if level + 1 < levels:
                table['fits'] = min(table['fits'], PROXY * widths[level + 1])
            table['neighbour_offsets'] = len(neighbour_offsets)
            neighbour_offsets += [*_offsets(NEAR, 1 << bits[0]), *_offsets(FAR, 1 << bits[0])]
        else:
            table['neighbour_offsets'] = tables['neighbour_offsets'][level]
    return tables, np.array(neighbour_offsets, np.int64)


def _bits(cells: int) -> int:
    """Return how many bits number so many cells, if a tenth of them may share the lists of others: memory."""
    return math.ceil(math.log2(cells / 1.1))


def _offsets(reach: int, row: int) -> list[int]:
    """Return the offsets of the cells in reach: those behind the left, right, lower, upper side, and all."""
    steps = range(-reach, reach + 1)
    left_right = [side * reach + step * row for side in (-1, 1) for step in steps]
    down_up = [side * reach * row + step for side in (-1, 1) for step in steps]
    return [*left_right, *down_up, *(x + y * row for x in steps for y in steps)]


def _has_room(tables: Array, moving: Array, x0: float, y0: float) -> bool:
    """Return whether lists as long as the longest, of residents or of proxies, do not take too much."""
    most = max(MOST_ROOM, MOST_ROOM_A_CIRCLE * len(moving))
    for level, table in enumerate(tables):
        there = moving[moving['level'] <= level]
        column, row = (
            np.floor((there[name] - zero) / table['width']).astype(np.int64)
            for name, zero in (('x', x0), ('y', y0))
        )
        cell = (column + (row << table['bits'])) & table['mask']
        longest = int(np.bincount(cell, minlength=1).max(initial=0))
        if (int(table['mask']) + 1) * longest > most:
            return False
    return True


def _enter_moving(tables: Array, moving: Array, x0: float, y0: float, collide: bool) -> Array:
    """Enter each circle in its cell, and in the lists of residents and proxies; return the lists."""
    levels = len(tables) // 2
    first = 0
    blocks = []
    for number, table in enumerate(tables):
        level = number % levels
        mine = moving['level'] == level if number < levels else moving['level'] < level
        width = table['width']
        column = np.floor((moving['x'] - x0) / width).astype(np.int64)
        row = np.floor((moving['y'] - y0) / width).astype(np.int64)
        if number >= levels:
            # As `grid` does: from the cell on the own level, so that rounding is the same.
            up = table['shift'] - tables['shift'][moving['level']]
            column, row = moving['column'] >> np.maximum(up, 0), moving['row'] >> np.maximum(up, 0)
        cell = (column + (row << table['bits'])) & table['mask']
        if number < levels:
            for name, values in (('column', column), ('row', row), ('cell', cell)):
                moving[name][mine] = values[mine]
        ids, lists = np.flatnonzero(mine), int(table['mask']) + 1
        cell = cell[mine]
        counts = np.bincount(cell, minlength=lists)
        stride = LEAST_STRIDE if collide else CIRCLES_AT
        while collide and stride < CIRCLES_AT + counts.max() + 1:
            stride *= 2
        block = np.zeros((lists, stride), np.int32)
        if collide:
            order = np.argsort(cell, kind='stable')
            places = np.arange(len(ids)) - np.repeat(np.cumsum(counts) - counts, counts)
            block[:, COUNT_AT] = counts
            block[cell[order], CIRCLES_AT + places] = ids[order]
        table['first'], table['stride'] = first, stride
        first += block.size
        blocks.append(block.ravel())
    return aligned_copy(np.concatenate(blocks))


def _enter_locked(
    tables: Array, lists: Array, disks: Array, segments: Array, x0: float, y0: float
) -> tuple[Array, Array, Array]:
    """Enter each static disk and wall segment in every cell from which a circle of that level could touch it."""
    in_reach: list[tuple[list[int], list[int]]] = [([], [])]
    for table in tables:
        of_cell: dict[int, tuple[list[int], list[int]]] = {}
        for number, disk in enumerate(disks):
            for cell in _cells_near_disk(table, disk, x0, y0):
                of_cell.setdefault(cell, ([], []))[0].append(number)
        for number, segment in enumerate(segments):
            for cell in _cells_near_segment(table, segment, x0, y0):
                of_cell.setdefault(cell, ([], []))[1].append(number)
        numbers = np.arange(len(in_reach), len(in_reach) + len(of_cell))
        _lists_of(lists, table)[list(of_cell), REACH_AT] = numbers
        in_reach += of_cell.values()
    reaches = np.zeros(len(in_reach), REACH)
    reaches['first_disk'], reaches['end_disk'], disk_numbers = _ranges([a for a, _ in in_reach])
    reaches['first_segment'], reaches['end_segment'], segment_numbers = _ranges(
        [b for _, b in in_reach]
    )
    return reaches, disk_numbers, segment_numbers


def _cells_near_disk(table: Array, disk: Array, x0: float, y0: float) -> list[int]:
    half = float(table['width']) / 2.0
    reach = float(disk['radius']) + float(table['fits']) * (1.0 + 1e-6)  # far more than rounding
    px, py = float(disk['x']), float(disk['y'])
    column, row, x, y = _cells(table, (px, px), (py, py), reach, x0, y0)
    beyond = np.hypot(
        np.maximum(np.abs(x - px) - half, 0.0), np.maximum(np.abs(y - py) - half, 0.0)
    )
    return _list_numbers(table, column[beyond <= reach], row[beyond <= reach])


def _cells_near_segment(table: Array, segment: Array, x0: float, y0: float) -> list[int]:
    half = float(table['width']) / 2.0
    reach = float(table['fits']) * (1.0 + 1e-6)
    sx, sy, nx, ny, length = (float(segment[name]) for name in ('x', 'y', 'nx', 'ny', 'length'))
    xs, ys = sorted((sx, sx + length * ny)), sorted((sy, sy - length * nx))
    column, row, x, y = _cells(table, xs, ys, reach, x0, y0)
    # Half the extent of a cell across the wall, and the reach of a circle in it.
    candidates = np.abs((x - sx) * nx + (y - sy) * ny) <= half * (abs(nx) + abs(ny)) + reach
    return _list_numbers(table, column[candidates], row[candidates])


def _cells(
    table: Array, xs: Any, ys: Any, reach: float, x0: float, y0: float
) -> tuple[Array, Array, Array, Array]:
    """Return column, row and centre of all cells that a box meets."""
    width = float(table['width'])
    ranges = [
        np.arange(
            math.floor((low - reach - zero) / width), math.floor((high + reach - zero) / width) + 1
        )
        for (low, high), zero in ((xs, x0), (ys, y0))
    ]
    column, row = (axis.ravel() for axis in np.meshgrid(*ranges))
    return column, row, x0 + (column + 0.5) * width, y0 + (row + 0.5) * width


def _list_numbers(table: Array, column: Array, row: Array) -> list[int]:
    numbers = (column + (row << int(table['bits']))) & int(table['mask'])
    return list(np.unique(numbers).tolist())


def _ranges(lists: list[list[int]]) -> tuple[Array, Array, Array]:
    """Return where each list begins and ends in all of them one after the other."""
    ends = np.cumsum([len(numbers) for numbers in lists])
    begins = np.concatenate([[0], ends[:-1]])
    segment: Iterator[int] = (number for numbers in lists for number in numbers)
    return begins, ends, np.fromiter(segment, np.int32)
