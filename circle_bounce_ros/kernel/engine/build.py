"""A world from a scene: records, levels of cells of the right width, and what is locked entered in them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.kernel.engine.grid import CELL_MARGIN, FAR, NEAR
from circle_bounce_ros.kernel.engine.records import (
    CELL,
    FLAT,
    LOCKED,
    MOVING,
    NOTE,
    NOTHING,
    POST,
    STATE,
    TABLE,
    WALL_END,
    World,
)
from circle_bounce_ros.kernel.impact import NEVER, wall_frame
from circle_bounce_ros.kernel.scene import Scene

Array = NDArray[Any]

# Every number below is a choice that costs time or memory when it is wrong, never a digit, but for the first.

# A circle travels about so many radii before the clocks are set back. More: contact instants lose digits
# (at 1,000 radii about 1e-13 of a radius). Less: the planning afresh that goes with it costs time.
RADII_PER_SPAN = 1024.0

# More than PATIENCE + PATIENCE_PER_CIRCLE n contacts while nothing travels further than CROWD_RADII radii are
# contacts without end. Less patience could refuse a long chain of simultaneous contacts.
PATIENCE = 1000
PATIENCE_PER_CIRCLE = 100
CROWD_RADII = 1e-9

# In a thin scene cells grow to this fraction of the mean gap between circles: fewer borders to cross.
CELLS_PER_GAP = 0.7

# A level is split off for smaller circles where nine of its cells would hold more than this many.
CROWDED = 32

# Its cells, in largest radii, are then as narrow as they can be with guests of up to an eighth of their width.
COARSE = 8.0 / 7.0
GUEST = 1.0 / 8.0

# No more cells than this along the longer side: memory.
MOST_CELLS_A_SIDE = 4096

# Contacts are logged in blocks of so many.
LOG_BLOCK = 4096

# More circles than this do not fit into the processor's cache. They are kept in an order in which neighbours are near
# each other in memory, which is up to twice as fast; it also decides between contacts at the very same instant.
MANY = 4096

CACHE_LINE = 64


def build(scene: Scene, keep_log: bool) -> World:
    """Return the world of a scene at time zero, in arrays."""
    moving = _moving(scene)
    posts, flats = _locked(scene)
    x0, y0, x1, y1 = _home(moving, posts)
    widths = _widths(moving['radius'], x1 - x0, y1 - y0, scene.moving_circles_collide)
    tables, around = _tables(widths, x1 - x0, y1 - y0)
    levels = len(widths)
    moving['level'] = np.searchsorted(tables['fits'][:levels], moving['radius'])
    cells, post_numbers, flat_numbers = _enter_locked(tables[:levels], posts, flats, x0, y0)
    filled, slots = _enter_moving(tables, moving, x0, y0, scene.moving_circles_collide)

    count = len(moving)
    leaf = 1 << max(0, (count - 1).bit_length())
    tree_time, tree_who = _tournament(count, leaf)
    state = np.zeros(1, STATE)
    state['crowd_ends'] = -NEVER
    state['keep_log'] = keep_log
    travel = _typical_speed(moving) / float(moving['radius'].min())
    # A cell of home may end a width beyond it; who is away must be a diameter further.
    widest = 2.0 * float(moving['radius'].max())
    far = max(x1 - x0, y1 - y0, float(widths[-1]) + widest * (1.0 + CELL_MARGIN))
    return World(
        moving=moving,
        posts=posts,
        flats=flats,
        tables=tables,
        cells=cells,
        filled=filled,
        slots=slots,
        near=_scratch(tables, count),
        around=around,
        away=np.zeros(count, np.int32),
        post_numbers=post_numbers,
        flat_numbers=flat_numbers,
        tree_time=tree_time,
        tree_who=tree_who,
        log=np.zeros(LOG_BLOCK, NOTE),
        state=state,
        leaf=leaf,
        levels=levels,
        x0=x0,
        y0=y0,
        porch_x0=x0 - far,
        porch_y0=y0 - far,
        porch_x1=x1 + far,
        porch_y1=y1 + far,
        edge=float(widths[-1]),
        span=_power_of_two(RADII_PER_SPAN / travel) if travel > 0.0 else 1.0,
        crowd_span=CROWD_RADII / travel if travel > 0.0 else 1.0,
        patience=PATIENCE + PATIENCE_PER_CIRCLE * count,
    )


def with_more_room(world: World) -> World:
    """Return the world with twice the room in the lists of every table that has a full one."""
    tables, filled, old = world.tables.copy(), world.filled, world.slots
    blocks = []
    slot = 0
    for table in tables:
        lists = table['mask'] + 1
        members = old[table['slot'] : table['slot'] + lists * table['room']].reshape(lists, -1)
        if filled[table['first'] : table['first'] + lists].max() == table['room']:
            members = np.hstack([members, np.zeros_like(members)])
        table['slot'], table['room'] = slot, members.shape[1]
        slot += members.size
        blocks.append(members.ravel())
    slots = np.concatenate([*blocks, np.zeros(2, np.int32)])
    near = _scratch(tables, len(world.moving))
    return world._replace(tables=tables, slots=slots, near=near)


def _moving(scene: Scene) -> Array:
    circles = [(index, c) for index, c in enumerate(scene.circles) if not c.locked]
    if len(circles) > MANY:
        circles = [circles[k] for k in _along_a_curve(np.array([c.position for _, c in circles]))]
    moving = _aligned(len(circles), MOVING)
    moving['id'] = [index for index, _ in circles]
    moving['rank'] = np.argsort(np.argsort(moving['id']))
    moving['x'], moving['y'] = np.array([c.position for _, c in circles]).T
    moving['vx'], moving['vy'] = np.array([c.velocity for _, c in circles]).T
    moving['radius'] = [c.radius for _, c in circles]
    moving['mass'] = [c.mass for _, c in circles]
    moving['kind'] = NOTHING  # planned for at time 0, first thing
    moving['time_of_cell'] = NEVER
    return moving


def _along_a_curve(points: Array) -> Array:
    """Return the order of points along Morton's curve, on which most neighbours are near each other."""
    low, high = points.min(axis=0), points.max(axis=0)
    cells = ((points - low) / (high - low).max() * 65535.0).astype(np.uint64)
    key = np.zeros(len(points), np.uint64)
    for bit in range(16):
        for axis in (0, 1):
            digit = (cells[:, axis] >> np.uint64(bit)) & np.uint64(1)
            key |= digit << np.uint64(2 * bit + axis)
    return np.argsort(key, kind='stable')


def _locked(scene: Scene) -> tuple[Array, Array]:
    posts = [
        (*circle.position, circle.radius, LOCKED, index)
        for index, circle in enumerate(scene.circles)
        if circle.locked
    ]
    ends: dict[tuple[float, float], int] = {}
    for number, wall in enumerate(scene.walls):
        ends.setdefault(wall.start, number)
        ends.setdefault(wall.end, number)
    posts += [(*end, 0.0, WALL_END, number) for end, number in ends.items()]
    flats = [
        (*wall.start, *wall_frame(*wall.start, *wall.end), number)
        for number, wall in enumerate(scene.walls)
    ]
    return np.array(posts, POST), np.array(flats, FLAT)


def _typical_speed(moving: Array) -> float:
    """Return a speed, m/s, that is seldom exceeded: the initial ones, four times the thermal one."""
    squares = moving['vx'] * moving['vx'] + moving['vy'] * moving['vy']
    # fsum, not sum: no order of adding up can change the result.
    energy = math.fsum((moving['mass'] * squares).tolist()) / 2.0
    thermal = math.sqrt(2.0 * energy / (len(moving) * float(moving['mass'].min())))
    return max(math.sqrt(squares.max()), 4.0 * thermal)


def _power_of_two(value: float) -> float:
    """Return the largest power of two that is not above a value."""
    return math.ldexp(0.5, math.frexp(value)[1])


# ------------------------------------------------------------------ the grid


def _home(moving: Array, posts: Array) -> tuple[float, float, float, float]:
    """Return the box beyond which nothing locked can be touched and nobody starts."""
    widest = 2.0 * float(moving['radius'].max())
    box = []
    for axis in ('x', 'y'):
        low, high = [moving[axis].min()], [moving[axis].max()]
        if len(posts):
            low.append((posts[axis] - posts['radius']).min())
            high.append((posts[axis] + posts['radius']).max())
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

    def least(fitting: Array) -> float:
        widest = 2.0 * float(fitting.max()) * (1.0 + CELL_MARGIN)
        gap = math.sqrt(area / len(fitting)) - widest
        return max(widest, CELLS_PER_GAP * gap, max(width, height) / MOST_CELLS_A_SIDE)

    widths = [least(radii)]
    while collide and 9.0 * widths[-1] ** 2 * len(radii) > CROWDED * area:
        needed = COARSE * float(radii.max()) * (1.0 + CELL_MARGIN) ** 2
        needed = max(needed, max(width, height) / MOST_CELLS_A_SIDE)
        coarse = widths[-1]
        if len(widths) == 1:
            coarse = needed
        elif coarse / 2.0 >= needed:
            coarse /= 2.0
        radii = radii[radii * (1.0 + CELL_MARGIN) <= GUEST * coarse]
        if len(radii) == 0 or least(radii) > coarse / 2.0:
            break
        finer = coarse / 2.0
        while finer / 2.0 >= least(radii):
            finer /= 2.0
        widths[-1] = coarse
        widths.append(finer)
    return np.array(widths[::-1])


def _tables(widths: Array, width: float, height: float) -> tuple[Array, Array]:
    """Return the tables of residents and of guests, without members, and each level's cells in reach."""
    levels = len(widths)
    tables = np.zeros(2 * levels, TABLE)
    around: list[int] = []
    for number, table in enumerate(tables):
        level = number % levels
        columns, rows = (max(1, math.ceil(side / widths[level])) for side in (width, height))
        # Eight cells a side at least, so that five times five have a list each; the finest level has no guests.
        bits = [
            max(2 if level == 0 else 3, _bits(cells)) if number != levels else 0
            for cells in (columns, rows)
        ]
        table['width'] = widths[level]
        table['shift'] = round(math.log2(widths[level] / widths[0]))
        table['bits'], table['mask'] = bits[0], (1 << sum(bits)) - 1
        table['columns'], table['rows'] = columns, rows
        if number < levels:
            guest = tables['fits'][level - 1] if level > 0 else 0.0
            share = 1.0 if level > 0 else 0.5
            table['fits'] = share * widths[level] / (1.0 + CELL_MARGIN) - guest
            if level + 1 < levels:
                table['fits'] = min(table['fits'], GUEST * widths[level + 1])
            table['around'] = len(around)
            around += [*_offsets(NEAR, 1 << bits[0]), *_offsets(FAR, 1 << bits[0])]
        else:
            table['around'] = tables['around'][level]
    return tables, np.array(around, np.int64)


def _bits(cells: int) -> int:
    """Return how many bits number so many cells, if a tenth of them may share the lists of others: memory."""
    return math.ceil(math.log2(cells / 1.1))


def _offsets(reach: int, row: int) -> list[int]:
    """Return the offsets of the cells in reach: those behind the left, right, lower, upper side, and all."""
    steps = range(-reach, reach + 1)
    left_right = [side * reach + step * row for side in (-1, 1) for step in steps]
    down_up = [side * reach * row + step for side in (-1, 1) for step in steps]
    return [*left_right, *down_up, *(x + y * row for x in steps for y in steps)]


def _enter_moving(
    tables: Array, moving: Array, x0: float, y0: float, collide: bool
) -> tuple[Array, Array]:
    """Enter each circle in its cell, and in the lists of residents and guests; return the lists."""
    levels = len(tables) // 2
    first = slot = 0
    filled, slots = [], []
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
        counts = np.bincount(cell, minlength=lists) if collide else np.zeros(lists, np.int64)
        room = 4 if collide else 1
        while room < counts.max() + 1:
            room *= 2
        members = np.zeros((lists, room), np.int32)
        if collide:
            order = np.argsort(cell, kind='stable')
            places = np.arange(len(ids)) - np.repeat(np.cumsum(counts) - counts, counts)
            members[cell[order], places] = ids[order]
        table['first'], table['slot'], table['room'] = first, slot, room
        first += lists
        slot += members.size
        filled.append(counts.astype(np.int32))
        slots.append(members.ravel())
    return np.concatenate(filled), np.concatenate([*slots, np.zeros(2, np.int32)])


def _scratch(tables: Array, count: int) -> Array:
    """Return room for all that `grid.gather` may write."""
    most = (2 * FAR + 1) ** 2
    return np.zeros(most * int(tables['room'].sum()) + 2 * count + 2, np.int32)


def _enter_locked(
    tables: Array, posts: Array, flats: Array, x0: float, y0: float
) -> tuple[Array, Array, Array]:
    """Enter each post and flat in every cell from which a circle of that level could touch it."""
    post_lists: list[list[int]] = []
    flat_lists: list[list[int]] = []
    for table in tables:
        lists = int(table['mask']) + 1
        of_posts: list[list[int]] = [[] for _ in range(lists)]
        of_flats: list[list[int]] = [[] for _ in range(lists)]
        for number, post in enumerate(posts):
            for cell in _cells_near_post(table, post, x0, y0):
                of_posts[cell].append(number)
        for number, flat in enumerate(flats):
            for cell in _cells_near_flat(table, flat, x0, y0):
                of_flats[cell].append(number)
        post_lists += of_posts
        flat_lists += of_flats
    cells = np.zeros(len(post_lists), CELL)
    cells['first_post'], cells['end_post'], post_numbers = _ranges(post_lists)
    cells['first_flat'], cells['end_flat'], flat_numbers = _ranges(flat_lists)
    return cells, post_numbers, flat_numbers


def _cells_near_post(table: Array, post: Array, x0: float, y0: float) -> list[int]:
    half = float(table['width']) / 2.0
    reach = float(post['radius']) + float(table['fits']) * (1.0 + 1e-6)  # far more than rounding
    px, py = float(post['x']), float(post['y'])
    column, row, x, y = _cells(table, (px, px), (py, py), reach, x0, y0)
    beyond = np.hypot(
        np.maximum(np.abs(x - px) - half, 0.0), np.maximum(np.abs(y - py) - half, 0.0)
    )
    return _list_numbers(table, column[beyond <= reach], row[beyond <= reach])


def _cells_near_flat(table: Array, flat: Array, x0: float, y0: float) -> list[int]:
    half = float(table['width']) / 2.0
    reach = float(table['fits']) * (1.0 + 1e-6)
    sx, sy, nx, ny, length = (float(flat[name]) for name in ('x', 'y', 'nx', 'ny', 'length'))
    xs, ys = sorted((sx, sx + length * ny)), sorted((sy, sy - length * nx))
    column, row, x, y = _cells(table, xs, ys, reach, x0, y0)
    # Half the extent of a cell across the wall, and the reach of a circle in it.
    near = np.abs((x - sx) * nx + (y - sy) * ny) <= half * (abs(nx) + abs(ny)) + reach
    return _list_numbers(table, column[near], row[near])


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
    flat: Iterator[int] = (number for numbers in lists for number in numbers)
    return begins, ends, np.fromiter(flat, np.int32)


# ------------------------------------------------------------------ the tournament


def _tournament(count: int, leaf: int) -> tuple[Array, Array]:
    """Return the tree in which everybody has time 0."""
    times = _aligned(2 * leaf, np.dtype(np.float64))
    times[:] = NEVER
    times[leaf : leaf + count] = 0.0
    who = np.zeros(2 * leaf, np.int32)
    who[leaf : leaf + count] = np.arange(count)
    first = leaf
    while first > 1:
        pairs = times[first : 2 * first].reshape(-1, 2)
        winner = np.arange(first, 2 * first, 2) + (pairs[:, 1] < pairs[:, 0])
        first //= 2
        times[first : 2 * first], who[first : 2 * first] = times[winner], who[winner]
    return times, who


def _aligned(count: int, dtype: np.dtype[Any]) -> Array:
    """Return zeros that begin at the start of a cache line."""
    raw = np.zeros(count * dtype.itemsize + CACHE_LINE, np.uint8)
    skip = -raw.ctypes.data % CACHE_LINE
    return raw[skip : skip + count * dtype.itemsize].view(dtype)
