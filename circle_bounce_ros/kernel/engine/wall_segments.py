"""
From the walls of a scene to straight lines: walls in line that touch each other are one segment.

A circle that slides along a floor of many walls only grazes the ends where they meet, and rounding would turn such a
graze into a contact. So walls in line become one segment, and an end that lies inside of a segment, which
is never touched before the segment is, becomes no static disk. Contacts still tell the wall of the scene.
"""

from __future__ import annotations

import heapq
from collections import defaultdict
from collections.abc import Iterator
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.kernel.engine.records import PART, SEGMENT
from circle_bounce_ros.kernel.impact import wall_frame
from circle_bounce_ros.kernel.scene import Wall

Array = NDArray[Any]

# A point this close to a wall, in roundings of the wall's largest coordinate, is on it. More: walls that are meant to
# bend become straight. Less: points of a straight line that were rounded do not.
ROUNDINGS = 8.0

# So close to a line of many walls are all their ends: each may have been rounded from the one before.
ROUNDINGS_OF_A_LINE = 64.0

# Pairs are looked at in blocks of about so many: memory.
BLOCK = 1 << 20


class Walls(NamedTuple):
    """What the engine makes of the walls of a scene."""

    segments: Array  # (s,) of dtype SEGMENT
    parts: Array  # (p,) of dtype PART
    ends: Array  # (e, 2), m: the ends that can be touched
    end_numbers: Array  # (e,): of the walls that share an end the lowest
    beyond: Array  # (e, 4): two directions of walls that end there, see DISK


class _Lines(NamedTuple):
    """For each wall a line that it is part of: where it starts, its unit normal and its length."""

    start: Array  # (w, 2), m
    frame: Array  # (w, 3)


def straighten(walls: tuple[Wall, ...]) -> Walls:
    """Return the segments of walls, one for walls in line that touch, and the ends that can be touched."""
    first_of: dict[tuple[float, float], int] = {}
    for number, wall in enumerate(walls):
        first_of.setdefault(wall.start, number)
        first_of.setdefault(wall.end, number)
    if not walls:
        none = (np.zeros((0, 2)), np.zeros(0, np.int64), np.zeros((0, 4)))
        return Walls(np.zeros(0, SEGMENT), np.zeros(0, PART), *none)
    row_of = {point: row for row, point in enumerate(first_of)}
    points = np.array(list(first_of))
    ends = np.array([(row_of[wall.start], row_of[wall.end]) for wall in walls])
    lines = _Lines(
        np.array([wall.start for wall in walls]),
        np.array([wall_frame(*wall.start, *wall.end) for wall in walls]),
    )
    rounding = np.finfo(float).eps * np.abs(points[ends]).max(axis=(1, 2))
    on = _points_on_walls(points, ends, lines, ROUNDINGS * rounding)
    segments: list[tuple[Any, ...]] = []
    parts: list[tuple[float, int]] = []
    ending: list[list[tuple[float, float]]] = [[] for _ in points]
    for group in _groups(
        len(walls), *_pairs_in_line(points, ends, lines, ROUNDINGS * rounding, on)
    ):
        for line in _straight(points, ends, rounding, group):
            begin = len(parts)
            if len(line) > 1:
                parts += _make_one(points, ends, lines, line)
            lowest = line[0]
            frame = lines.frame[lowest]
            segments.append((*lines.start[lowest], *frame, lowest, begin, len(parts)))
            first, last = _extremes(points, ends, line) if len(line) > 1 else ends[lowest]
            nx, ny, _ = frame.tolist()
            ending[first].append((-ny, nx))
            ending[last].append((ny, -nx))
    on_wall, point = on
    along, _ = _place(points[point], lines, on_wall)
    close = ROUNDINGS * rounding[on_wall]
    hidden = point[(along > close) & (along < lines.frame[on_wall, 2] - close)]
    seen = np.setdiff1d(np.arange(len(points)), hidden)
    segments.sort(key=lambda segment: segment[5])
    return Walls(
        np.array(segments, SEGMENT),
        np.array(parts, PART),
        points[seen],
        np.array(list(first_of.values()))[seen],
        np.array([_outermost(ending[point]) for point in seen.tolist()]).reshape(-1, 4),
    )


def _outermost(directions: list[tuple[float, float]]) -> tuple[float, float, float, float]:
    """Return the two of several directions that have all others between them; zeros if there are none."""

    def is_first(a: tuple[float, float], sign: float) -> bool:
        return all(sign * (a[0] * b[1] - a[1] * b[0]) >= 0.0 for b in directions)

    first = [a for a in directions if is_first(a, 1.0)]
    last = [a for a in directions if is_first(a, -1.0)]
    return (*first[0], *last[0]) if first and last else (0.0, 0.0, 0.0, 0.0)


def _place(points: Array, lines: _Lines, number: Any) -> tuple[Array, Array]:
    """Return how far points are along lines and, in size, across them."""
    x, y = (points - lines.start[number]).T
    nx, ny, _ = lines.frame[number].T
    return x * ny - y * nx, np.abs(x * nx + y * ny)


def _points_on_walls(
    points: Array, ends: Array, lines: _Lines, close: Array
) -> tuple[Array, Array]:
    """Return pairs of a wall and a point on it: the numbers of both."""
    orders, firsts, counts = [], [], []
    for axis in (0, 1):
        order = np.argsort(points[:, axis], kind='stable')
        values = points[order, axis]
        range_ = points[ends, axis]
        first = np.searchsorted(values, range_.min(axis=1) - close, 'left')
        last = np.searchsorted(values, range_.max(axis=1) + close, 'right')
        orders.append(order)
        firsts.append(first)
        counts.append(last - first)
    found = []
    by_y = counts[1] < counts[0]  # the axis along which fewer points are in the range of a wall
    for axis, walls in ((0, np.flatnonzero(~by_y)), (1, np.flatnonzero(by_y))):
        for number, step in _blocks(counts[axis][walls]):
            wall = walls[number]
            point = orders[axis][firsts[axis][wall] + step]
            along, across = _place(points[point], lines, wall)
            candidates = close[wall]
            on = (
                (across <= candidates)
                & (along >= -candidates)
                & (along <= lines.frame[wall, 2] + candidates)
            )
            found.append((wall[on], point[on]))
    wall, point = (np.concatenate(part) for part in zip(*found, strict=True))
    return wall, point


def _blocks(counts: Array) -> Iterator[tuple[Array, Array]]:
    """Yield all pairs of a number k and a step from 0 to below counts[k], about BLOCK at a time."""
    ends = np.cumsum(counts)
    begin = before = 0
    while begin < len(counts):
        end = max(begin + 1, int(np.searchsorted(ends, before + BLOCK, 'right')))
        number = np.repeat(np.arange(begin, end), counts[begin:end])
        yield number, np.arange(before, before + len(number)) - (ends - counts)[number]
        begin, before = end, int(ends[end - 1])


def _pairs_in_line(
    points: Array, ends: Array, lines: _Lines, close: Array, on: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Return pairs of walls in line that touch each other, measured by the longer one."""
    # The walls that end at each point, point by point.
    order = np.argsort(ends.ravel(), kind='stable') // 2
    counts = np.bincount(ends.ravel(), minlength=len(points))
    firsts = np.cumsum(counts) - counts
    longer, point = on
    found = [(np.zeros(0, np.int64), np.zeros(0, np.int64))]
    for number, step in _blocks(counts[point]):
        a = longer[number]
        b = order[firsts[point[number]] + step]
        asked = (a != b) & (lines.frame[b, 2] <= lines.frame[a, 2])
        a, b = a[asked], b[asked]
        across = [_place(points[ends[b, k]], lines, a)[1] for k in (0, 1)]
        in_line = np.maximum(*across) <= close[a]
        found.append((a[in_line], b[in_line]))
    a, b = (np.concatenate(part) for part in zip(*found, strict=True))
    return a, b


def _groups(count: int, a: Array, b: Array) -> list[list[int]]:
    """Return the numbers from 0 to below a count, those that pairs connect in one list."""
    lowest = list(range(count))

    def root(k: int) -> int:
        while lowest[k] != k:
            lowest[k] = lowest[lowest[k]]
            k = lowest[k]
        return k

    for one, other in zip(a.tolist(), b.tolist(), strict=True):
        low, high = sorted((root(one), root(other)))
        lowest[high] = low
    groups = defaultdict(list)
    for k in range(count):
        groups[root(k)].append(k)
    return list(groups.values())


def _extremes(points: Array, ends: Array, group: list[int]) -> tuple[int, int]:
    """Return the two ends of walls in line between which all others lie, in the direction of the first wall."""
    own = ends[group].ravel()
    direction = points[ends[group[0], 1]] - points[ends[group[0], 0]]
    x, y = (points[own] - points[own[0]]).T
    along = x * direction[0] + y * direction[1]
    return int(own[along.argmin()]), int(own[along.argmax()])


def _straight(points: Array, ends: Array, rounding: Array, group: list[int]) -> list[list[int]]:
    """Return a group of walls in line in as many parts as rounding has bent it into."""
    if len(group) == 1:
        return [group]
    first, last = _extremes(points, ends, group)
    line = _Lines(points[[first]], np.array([wall_frame(*points[first], *points[last])]))
    along, across = _place(points[ends[group].ravel()], line, 0)
    worst = int(across.argmax())
    if across[worst] <= ROUNDINGS_OF_A_LINE * rounding[group].max():
        return [group]
    middle = along.reshape(-1, 2).sum(axis=1) / 2.0
    before = [k for k, at in zip(group, middle.tolist(), strict=True) if at <= along[worst]]
    beyond = [k for k, at in zip(group, middle.tolist(), strict=True) if at > along[worst]]
    if not before or not beyond:
        return [[k] for k in group]
    return [part for half in (before, beyond) for part in _straight(points, ends, rounding, half)]


def _make_one(
    points: Array, ends: Array, lines: _Lines, group: list[int]
) -> list[tuple[float, int]]:
    """Make one line of walls; return up to where along it which of them is touched: the lowest number of several."""
    first, last = _extremes(points, ends, group)
    lines.start[group] = points[first]
    lines.frame[group] = wall_frame(*points[first].tolist(), *points[last].tolist())
    along = [np.sort(_place(points[ends[k]], lines, k)[0]).tolist() for k in group]
    coming = sorted((low, high, k) for (low, high), k in zip(along, group, strict=True))
    borders = sorted({border for pair in along for border in pair})
    parts: list[tuple[float, int]] = []
    there: list[tuple[int, float]] = []
    begun = 0
    for border, beyond in pairwise(borders):
        while begun < len(coming) and coming[begun][0] <= border:
            _, high, k = coming[begun]
            heapq.heappush(there, (k, high))
            begun += 1
        while there and there[0][1] <= border:
            heapq.heappop(there)
        # Between two walls that meet but for rounding the one before goes on.
        number = there[0][0] if there else parts[-1][1]
        if parts and parts[-1][1] == number:
            parts.pop()
        parts.append((beyond, number))
    return parts
