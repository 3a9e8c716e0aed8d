"""
Broad phase of the search for overlaps: pairs near each other, in arrays, for bodies laid out in any way.

Circles among each other: a grid for each size class. Circles with walls: a tree of boxes. Both find every pair that
overlaps, and a number of others that grows with the number of bodies and not with its square.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Pairs = tuple[Ints, Ints]

# Pairs in one piece: a few dozen megabytes of arrays.
PIECE = 1 << 20

# Up to so many pairs of a circle and a wall, all of them are cheaper than a tree.
FEW = 1 << 22

# Circles below a leaf of the tree.
LEAF = 8

# Boxes are larger by this fraction of the coordinates: more than all roundings of a test together.
SLACK = 1e-14


def size_classes(radii: Floats) -> Ints:
    """Return e of the powers of two above the radii, `2^(e-1) <= radius < 2^e`."""
    return np.frexp(radii)[1].astype(np.int64)


def within(positions: Floats, ids: Ints, side: float) -> Iterator[Pairs]:
    """Yield each pair of circles of one class once that lie in the same cell or in neighbouring ones."""
    if len(ids) < 2:
        return
    key, row = _keys(positions[ids], side)
    order = np.argsort(key, kind='stable')
    ids, key = ids[order], key[order]
    own = np.arange(len(ids))
    # Half of the neighbours: what follows in this cell, the next cell, and three cells of the row above.
    yield from _pieces(ids, ids, own + 1, np.searchsorted(key, key + 1, 'right'))
    yield from _pieces(ids, ids, *_ranges(key, key + row))


def between(positions: Floats, members: Ints, others: Ints, side: float) -> Iterator[Pairs]:
    """Yield pairs of a member of a class and a circle of this or a smaller class in the cells around it."""
    if len(members) == 0 or len(others) == 0:
        return
    key, row = _keys(positions[np.concatenate((members, others))], side)
    asked, key = key[len(members) :], key[: len(members)]
    order = np.argsort(key, kind='stable')
    members, key = members[order], key[order]
    for rows in (0, -row, row):
        yield from _pieces(others, members, *_ranges(key, asked + rows))


def _ranges(key: Ints, asked: Ints) -> Pairs:
    """Return where three neighbouring cells of one row begin and end among sorted keys."""
    return np.searchsorted(key, asked - 1, 'left'), np.searchsorted(key, asked + 1, 'right')


def _keys(positions: Floats, side: float) -> tuple[Ints, int]:
    """Return a number for the cell of each position, and the step of that number from row to row."""
    column, row = (_numbered(np.floor(positions[:, axis] / side)) for axis in (0, 1))
    step = int(column.max()) + 3  # two empty columns, so that the ends of rows are no neighbours
    return column + step * row, step


def _numbered(cells: Floats) -> Ints:
    """Return small whole numbers in the order of the cells, which are neighbours where the cells are."""
    cells = cells - cells.min()
    if cells.max() < 1 << 31:
        return cells.astype(np.int64)
    found, inverse = np.unique(cells, return_inverse=True)
    steps = np.minimum(np.diff(found, prepend=found[0]), 2.0)
    return np.cumsum(steps).astype(np.int64)[inverse.reshape(-1)]


def _pieces(first: Ints, second: Ints, begin: Ints, end: Ints) -> Iterator[Pairs]:
    """Yield the pairs of `first[k]` and all of `second[begin[k]:end[k]]`, a limited number at a time."""
    some = np.flatnonzero(end > begin)
    first, begin, count = first[some], begin[some], (end - begin)[some]
    total = np.cumsum(count)
    for low in range(0, int(total[-1]) if len(total) else 0, PIECE):
        pair = np.arange(low, min(low + PIECE, int(total[-1])))
        k = np.searchsorted(total, pair[[0, -1]], 'right')
        rows = np.arange(k[0], k[1] + 1)
        # How many pairs of each row lie in this piece.
        share = np.minimum(total[rows], pair[-1] + 1) - np.maximum(total[rows] - count[rows], low)
        row = np.repeat(rows, share)
        yield first[row], second[begin[row] + pair - (total[row] - count[row])]


def with_segments(
    positions: Floats, radii: Floats, ids: Ints, segments: Floats
) -> Iterator[Pairs]:
    """Yield pairs of a circle and the number of a segment, (w, 4), that may overlap."""
    number = np.arange(len(segments))
    if len(ids) * len(segments) <= FEW:
        everyone = np.zeros(len(segments), dtype=np.int64)
        for segment, circle in _pieces(number, ids, everyone, everyone + len(ids)):
            yield circle, segment
        return
    ids = ids[_z_order(positions[ids])]
    levels = _boxes(positions[ids], radii[ids])
    # Depth first and in pieces, so that few boxes wait at a time.
    waiting = [(len(levels) - 1, number, np.zeros_like(number))]
    while waiting:
        level, segment, box = waiting.pop()
        if len(segment) > PIECE:
            half = len(segment) // 2
            waiting += [(level, segment[:half], box[:half]), (level, segment[half:], box[half:])]
            continue
        met = _meets(levels[level][box], segments[segment])
        segment, box = segment[met], box[met]
        if level > 0:
            box = np.concatenate((2 * box, 2 * box + 1))
            inside = box < len(levels[level - 1])
            waiting.append((level - 1, np.tile(segment, 2)[inside], box[inside]))
            continue
        begin = LEAF * box
        for found, circle in _pieces(segment, ids, begin, np.minimum(begin + LEAF, len(ids))):
            yield circle, found


def _z_order(positions: Floats) -> Ints:
    """Return the order along a Z-curve through the ranks of x and y, which no layout makes degenerate."""
    code = np.zeros(len(positions), dtype=np.int64)
    for axis in (0, 1):
        rank = np.unique(positions[:, axis], return_inverse=True)[1].reshape(-1)
        for bit in range(int(rank.max()).bit_length()):
            code |= (rank >> bit & 1) << (2 * bit + axis)
    return np.argsort(code, kind='stable')


def _boxes(positions: Floats, radii: Floats) -> list[Floats]:
    """Return the boxes around each `LEAF` circles in a row, (k, 4), then around pairs of those, up to one."""
    grown = (radii + SLACK * (np.abs(positions).max(axis=1) + radii))[:, None]
    starts = np.arange(0, len(radii), LEAF)
    low, high = (
        np.minimum.reduceat(positions - grown, starts),
        np.maximum.reduceat(positions + grown, starts),
    )
    levels = [np.hstack((low, high))]
    while len(low) > 1:
        starts = np.arange(0, len(low), 2)
        low, high = np.minimum.reduceat(low, starts), np.maximum.reduceat(high, starts)
        levels.append(np.hstack((low, high)))
    return levels


def _meets(boxes: Floats, segments: Floats) -> NDArray[np.bool_]:
    """Return whether a segment meets its box: neither along x, y nor the segment's normal are they apart."""
    middle, half = (boxes[:, 2:] + boxes[:, :2]) / 2.0, (boxes[:, 2:] - boxes[:, :2]) / 2.0
    start, along = segments[:, :2], segments[:, 2:] - segments[:, :2]
    grown = half + SLACK * np.abs(segments).max(axis=1)[:, None]
    centre = middle - start - along / 2.0
    near = (np.abs(centre) <= grown + np.abs(along) / 2.0).all(axis=1)
    unit = along / np.hypot(*along.T)[:, None]
    offset = middle - start
    across = offset[:, 1] * unit[:, 0] - offset[:, 0] * unit[:, 1]
    reach = grown[:, 0] * np.abs(unit[:, 1]) + grown[:, 1] * np.abs(unit[:, 0])
    met: NDArray[np.bool_] = near & (np.abs(across) <= reach)
    return met
