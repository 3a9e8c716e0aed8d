"""
What the engine keeps: one record a body, and the world that holds them. All in SI units.

The layouts are numpy's, so that compiled code can work on them; run plainly, the engine works on small objects
with the same fields, whose attributes Python finds faster.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.kernel.contact_record import CONTACT_FIELDS, ContactKind

# What a circle is going to touch; the numbers of the first four are those of the contact log.
CIRCLE, LOCKED, WALL, WALL_END, NOTHING = *map(int, ContactKind), len(ContactKind)

# The side of its cell that a circle leaves through. EVERYWHERE: look at all cells around.
LEFT, RIGHT, DOWN, UP, EVERYWHERE = 0, 1, 2, 3, 4


# A moving circle between two of its own events, with its predicted events. It is at `x + vx (t - time)` at
# time t. `changes` counts its changes of course: an event that names it as a partner is void once the count has
# gone on. What others look at comes first: one line of the processor's cache.
MOVING = np.dtype(
    [(name, 'f8') for name in ('x', 'y', 'vx', 'vy', 'time', 'radius', 'mass')]
    + [('changes', 'i4'), ('level', 'i4')]  # its level of the grid; one beyond the last: outside
    + [('time_of_hit', 'f8'), ('time_of_cell', 'f8')]  # predicted: the next touch, the next cell
    + [(name, 'i4') for name in ('kind', 'partner', 'partner_changes', 'side')]
    + [(name, 'i8') for name in ('column', 'row', 'cell')]
    + [('id', 'i4'), ('moving_index', 'i4')],  # its number in the scene, and among those that move
    align=True,
)

# A locked circle, or the end of a wall as a circle of radius 0. The id is that of the circle or the wall. An end is
# touched only beyond the walls that end there, where these point to: (ax, ay) and (bx, by) are the outermost of their
# directions, 0 for a locked circle.
DISK = np.dtype(
    [(name, 'f8') for name in ('x', 'y', 'radius')]
    + [('kind', 'i8'), ('id', 'i8')]
    + [(name, 'f8') for name in ('ax', 'ay', 'bx', 'by')]
)

# A wall segment, of one wall or of several in line: where it starts, its unit normal (direction turned left), its
# length. One of several has a range of `world.parts`; the id is that of the wall, or the lowest.
SEGMENT = np.dtype(
    [(name, 'f8') for name in ('x', 'y', 'nx', 'ny', 'length')]
    + [(name, 'i8') for name in ('id', 'first_part', 'end_part')]
)

# Up to where along its segment a wall is the one that is touched; the first such part counts.
PART = np.dtype([('end', 'f8'), ('id', 'i8')])

# What is locked in reach of a cell: ranges of `world.disk_numbers` and `world.segment_numbers`.
REACH = np.dtype(
    [(name, 'i4') for name in ('first_disk', 'end_disk', 'first_segment', 'end_segment')]
)

# The list of a cell: how many circles are in it, the number of its reach, then the circles.
COUNT_AT, REACH_AT, CIRCLES_AT = 0, 1, 2

# One level of the grid, or the proxies on it: see `broad_phase`.
TABLE = np.dtype(
    [('width', 'f8')]  # of a cell, m
    + [('fits', 'f8')]  # the radius of the largest resident, m
    + [('shift', 'i8')]  # its cells are 2^shift cells of the finest level wide
    + [('bits', 'i8'), ('mask', 'i8')]  # of the number of a list
    + [('first', 'i8'), ('stride', 'i8')]  # its first list in `world.lists`; from one to the next
    + [('neighbour_offsets', 'i8')]  # where its neighbours begin in `world.around`
    + [('columns', 'i8'), ('rows', 'i8')]  # of the grid bounds
)

# `kernel.CONTACT` with all numbers of 8 bytes, so that each is aligned.
LOG_ENTRY = np.dtype(
    [(f.name, 'f8' if issubclass(f.type, np.floating) else 'i8') for f in CONTACT_FIELDS]
)

# All times in the world count from the epoch: clocks are set back before they grow beyond the span.
STATE = np.dtype(
    # late: contacts until then are resolved beyond the span too.
    [(name, 'f8') for name in ('epoch', 'time', 'late')]
    + [(name, 'i8') for name in ('events', 'contacts', 'logged', 'outside', 'keep_log')]
    # just_set: clocks have been set back, and there was no contact since.
    # in_order: the event queue holds the events of independent circles.
    + [(name, 'i8') for name in ('just_set', 'in_order')]
)

# Contacts that come close upon each other: how many there have been, and when the counting starts again.
CASCADE = np.dtype([('count', 'i8'), ('ends', 'f8')])


# One record of any of these, in either backend: see `backends`.
Record = Any

LAYOUTS = {
    'Moving': MOVING,
    'Disk': DISK,
    'Segment': SEGMENT,
    'Part': PART,
    'Reach': REACH,
    'Table': TABLE,
    'LogEntry': LOG_ENTRY,
    'State': STATE,
    'Cascade': CASCADE,
}

CACHE_LINE = 64


def aligned_zeros(count: int, dtype: np.dtype[Any]) -> NDArray[Any]:
    """Return zeros that begin at the start of a cache line."""
    raw = np.zeros(count * dtype.itemsize + CACHE_LINE, np.uint8)
    skip = -raw.ctypes.data % CACHE_LINE
    return raw[skip : skip + count * dtype.itemsize].view(dtype)


def aligned_copy(array: NDArray[Any]) -> NDArray[Any]:
    """Return a copy that begins at the start of a cache line."""
    copy = aligned_zeros(len(array), array.dtype)
    copy[:] = array
    return copy


class World(NamedTuple):
    """Everything that the engine works on: arrays of records, arrays of numbers, constants."""

    moving: Any
    disks: Any
    segments: Any
    parts: Any  # of segments that are several walls
    tables: Any  # of each level the residents, then of each level the proxies
    lists: Any  # of each table, one after the other
    reaches: Any  # the first one is empty
    candidates: Any  # scratch: the circles in reach
    neighbour_offsets: (
        Any  # of each level: to the cells behind each side and to all, for a reach of 1 and of 2
    )
    outside: Any  # the circles that are in no cell
    disk_numbers: Any
    segment_numbers: Any
    tree_time: Any
    tree_who: Any
    log: Any
    state: Any  # one record: what changes and is no array
    cascades: Any  # one for all, or one for each independent circle
    leaf: int  # the first leaf of the event queue
    rounds: int  # levels of the tree above the leaves
    prefetches: bool  # in compiled code: see `prefetch`
    levels: int
    x0: float  # where cell (0, 0) of every level begins
    y0: float
    outer_x0: float
    outer_y0: float
    outer_x1: float
    outer_y1: float
    edge: float  # how far beyond the outer bounds a circle is outside
    span: float
    cascade_span: float
    burst_limit: int
