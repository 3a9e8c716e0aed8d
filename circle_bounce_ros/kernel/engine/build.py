"""A world from a scene: what moves, what is locked, the grid (`grid_layout.py`) and the event queue."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.kernel.engine.broad_phase import CELL_MARGIN
from circle_bounce_ros.kernel.engine.grid_layout import lay_out, scratch
from circle_bounce_ros.kernel.engine.records import (
    CASCADE,
    DISK,
    LOCKED,
    LOG_ENTRY,
    MOVING,
    NOTHING,
    STATE,
    WALL_END,
    World,
    aligned_zeros,
)
from circle_bounce_ros.kernel.engine.wall_segments import Walls, straighten
from circle_bounce_ros.kernel.impact import NEVER
from circle_bounce_ros.kernel.scene import Scene

Array = NDArray[Any]

# Every number below is a choice that costs time or memory when it is wrong, never a digit, but for the first.

# A circle travels about so many radii before the clocks are set back. More: contact instants lose digits
# (at 1,000 radii about 1e-13 of a radius). Less: the prediction of all events that goes with it costs time.
RADII_PER_SPAN = 1024.0

# More than BURST_LIMIT + BURST_LIMIT_PER_CIRCLE n contacts while nothing travels further than CASCADE_RADII are
# contacts without end. A lower limit could refuse a long chain of simultaneous contacts, or the 180 / a bounces of a
# circle that runs into a wedge of a degrees: these are 18,000 at 0.01. A higher one finds a scene without end later.
# Of circles that pass through each other each is counted on its own, n = 1.
BURST_LIMIT = 20_000
BURST_LIMIT_PER_CIRCLE = 100
CASCADE_RADII = 1e-9

# Contacts are logged in blocks of so many.
LOG_BLOCK = 4096

# More circles than this do not fit into the processor's cache. They are kept in an order in which neighbours are near
# each other in memory, which is up to twice as fast; it also decides between contacts at the very same instant.
MORTON_ABOVE = 4096

# Among more than this the engine prefetches: events of 100,000 then take two thirds of the time. Among fewer, the
# prefetching itself costs more than it saves.
PREFETCH_ABOVE = 16_384


def build(scene: Scene, keep_log: bool) -> World:
    """Return the world of a scene at time zero, in arrays."""
    moving = _moving(scene)
    walls = straighten(tuple(scene.walls))
    disks = _disks(scene, walls)
    grid = lay_out(moving, disks, walls.segments, scene.moving_circles_collide)
    count = len(moving)
    rounds = (count - 1).bit_length()
    leaf = 1 << rounds
    tree_time, tree_who = _event_queue(count, leaf)
    state = np.zeros(1, STATE)
    state['keep_log'] = keep_log
    state['in_order'] = True
    cascades = np.zeros(count if not scene.moving_circles_collide else 1, CASCADE)
    cascades['ends'] = -NEVER
    travel = _typical_speed(moving) / float(moving['radius'].min())
    # A cell may end a width beyond the grid bounds; a circle outside must be a diameter further.
    widest = 2.0 * float(moving['radius'].max())
    far = max(grid.x1 - grid.x0, grid.y1 - grid.y0, grid.widest + widest * (1.0 + CELL_MARGIN))
    return World(
        moving=moving,
        disks=disks,
        segments=walls.segments,
        parts=walls.parts,
        tables=grid.tables,
        lists=grid.lists,
        reaches=grid.reaches,
        candidates=scratch(grid.tables, count),
        neighbour_offsets=grid.neighbour_offsets,
        outside=np.zeros(count, np.int32),
        disk_numbers=grid.disk_numbers,
        segment_numbers=grid.segment_numbers,
        tree_time=tree_time,
        tree_who=tree_who,
        log=np.zeros(LOG_BLOCK, LOG_ENTRY),
        state=state,
        cascades=cascades,
        leaf=leaf,
        rounds=rounds,
        prefetches=count > PREFETCH_ABOVE,
        levels=len(grid.tables) // 2,
        x0=grid.x0,
        y0=grid.y0,
        outer_x0=grid.x0 - far,
        outer_y0=grid.y0 - far,
        outer_x1=grid.x1 + far,
        outer_y1=grid.y1 + far,
        edge=grid.widest,
        span=_power_of_two(RADII_PER_SPAN / travel) if travel > 0.0 else 1.0,
        cascade_span=CASCADE_RADII / travel if travel > 0.0 else 1.0,
        burst_limit=BURST_LIMIT
        + BURST_LIMIT_PER_CIRCLE * (count if scene.moving_circles_collide else 1),
    )


def _moving(scene: Scene) -> Array:
    circles = [(index, c) for index, c in enumerate(scene.circles) if not c.locked]
    if len(circles) > MORTON_ABOVE:
        circles = [
            circles[k] for k in _along_mortons_curve(np.array([c.position for _, c in circles]))
        ]
    moving = aligned_zeros(len(circles), MOVING)
    moving['id'] = [index for index, _ in circles]
    moving['moving_index'] = np.argsort(np.argsort(moving['id']))
    moving['x'], moving['y'] = np.array([c.position for _, c in circles]).T
    moving['vx'], moving['vy'] = np.array([c.velocity for _, c in circles]).T
    moving['radius'] = [c.radius for _, c in circles]
    moving['mass'] = [c.mass for _, c in circles]
    moving['kind'] = NOTHING  # predicted at time 0, first thing
    moving['time_of_cell'] = NEVER
    return moving


def _along_mortons_curve(points: Array) -> Array:
    """Return the order of points along Morton's curve, on which most neighbours are near each other."""
    low, high = points.min(axis=0), points.max(axis=0)
    extent = (high - low).max()
    cells = ((points - low) / (extent if extent > 0.0 else 1.0) * 65535.0).astype(np.uint64)
    key = np.zeros(len(points), np.uint64)
    for bit in range(16):
        for axis in (0, 1):
            digit = (cells[:, axis] >> np.uint64(bit)) & np.uint64(1)
            key |= digit << np.uint64(2 * bit + axis)
    return np.argsort(key, kind='stable')


def _disks(scene: Scene, walls: Walls) -> Array:
    disks = [
        (*circle.position, circle.radius, LOCKED, index, 0.0, 0.0, 0.0, 0.0)
        for index, circle in enumerate(scene.circles)
        if circle.locked
    ]
    disks += [
        (*end, 0.0, WALL_END, number, *beyond)
        for end, number, beyond in zip(
            walls.ends.tolist(), walls.end_numbers.tolist(), walls.beyond.tolist(), strict=True
        )
    ]
    return np.array(disks, DISK)


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


# ------------------------------------------------------------------ the event queue


def _event_queue(count: int, leaf: int) -> tuple[Array, Array]:
    """Return the tree in which all circles have time 0."""
    times = aligned_zeros(2 * leaf, np.dtype(np.float64))
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
