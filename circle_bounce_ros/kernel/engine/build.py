"""A world from a scene: records, and cells of the right width with what is locked entered in them."""

from __future__ import annotations

import math

from circle_bounce_ros.kernel.engine import tournament
from circle_bounce_ros.kernel.engine.grid import list_number, settle
from circle_bounce_ros.kernel.engine.records import (
    LOCKED,
    WALL_END,
    Flat,
    Grid,
    Locked,
    Moving,
    World,
)
from circle_bounce_ros.kernel.impact import wall_frame
from circle_bounce_ros.kernel.scene import Scene

# Every tolerance of the engine, with what it does.

# A circle travels about so many radii before the clocks are set back. More: contact instants lose digits
# (at 1,000 radii about 1e-13 of a radius). Less: the planning afresh that goes with it costs time.
RADII_PER_SPAN = 1024.0

# More than PATIENCE + PATIENCE_PER_CIRCLE n contacts while nothing travels further than CROWD_RADII radii are
# contacts without end. Less patience could refuse a long chain of simultaneous contacts.
PATIENCE = 1000
PATIENCE_PER_CIRCLE = 100
CROWD_RADII = 1e-9

# Cells are wider than the widest circle by this fraction, so that rounding cannot put two circles that touch
# into cells that are no neighbours.
CELL_MARGIN = 1e-9

# In a thin scene cells grow to this fraction of the mean spacing: fewer borders to cross.
CELLS_PER_SPACING = 0.5

# No more cells than this along the longer side: memory.
MOST_CELLS_A_SIDE = 4096


def build(scene: Scene, keep_log: bool) -> World:
    """Return the world of a scene at time zero."""
    moving = [
        Moving(index, *circle.position, *circle.velocity, circle.radius, circle.mass)
        for index, circle in enumerate(scene.circles)
        if not circle.locked
    ]
    locked = [
        Locked(LOCKED, index, *circle.position, circle.radius)
        for index, circle in enumerate(scene.circles)
        if circle.locked
    ]
    flats = []
    ends: dict[tuple[float, float], int] = {}
    for number, wall in enumerate(scene.walls):
        flats.append(Flat(number, *wall.start, *wall_frame(*wall.start, *wall.end)))
        ends.setdefault(wall.start, number)
        ends.setdefault(wall.end, number)
    locked += [Locked(WALL_END, number, *end, 0.0) for end, number in ends.items()]

    travel = _typical_speed(moving) / min(circle.radius for circle in moving)
    world = World(
        moving,
        locked,
        flats,
        _make_grid(moving, locked),
        scene.moving_circles_collide,
        keep_log,
        span=_power_of_two(RADII_PER_SPAN / travel) if travel > 0.0 else 1.0,
        crowd_span=CROWD_RADII / travel if travel > 0.0 else 1.0,
        patience=PATIENCE + PATIENCE_PER_CIRCLE * len(moving),
    )
    _enter_locked(world)
    for i, circle in enumerate(moving):
        settle(world, i, circle.x, circle.y)
        tournament.enter(world, i, circle.time_of_hit)
    return world


def _typical_speed(moving: list[Moving]) -> float:
    """Return a speed, m/s, that is seldom exceeded: the initial ones, four times the thermal one."""
    squares = [circle.vx * circle.vx + circle.vy * circle.vy for circle in moving]
    # fsum, not sum: that one rounds differently since Python 3.12.
    energy = math.fsum(circle.mass * sq for circle, sq in zip(moving, squares, strict=True)) / 2.0
    lightest = min(circle.mass for circle in moving)
    thermal = math.sqrt(2.0 * energy / (len(moving) * lightest))
    return max(math.sqrt(max(squares)), 4.0 * thermal)


def _power_of_two(value: float) -> float:
    """Return the largest power of two that is not above a value."""
    return math.ldexp(0.5, math.frexp(value)[1])


def _make_grid(moving: list[Moving], locked: list[Locked]) -> Grid:
    widest = 2.0 * max(circle.radius for circle in moving)
    discs = [(circle.x, circle.y, 0.0) for circle in moving]
    discs += [(post.x, post.y, post.radius) for post in locked]
    # Beyond home nothing locked can be touched.
    x0, y0 = (min(disc[k] - disc[2] for disc in discs) - widest for k in (0, 1))
    x1, y1 = (max(disc[k] + disc[2] for disc in discs) + widest for k in (0, 1))
    spacing = math.sqrt((x1 - x0) * (y1 - y0) / len(moving))
    longer = max(x1 - x0, y1 - y0)
    width = max(
        widest * (1.0 + CELL_MARGIN), CELLS_PER_SPACING * spacing, longer / MOST_CELLS_A_SIDE
    )
    far = max(longer, 2.0 * width)
    columns, rows = (max(1, math.ceil(side / width)) for side in (x1 - x0, y1 - y0))
    return Grid(x0, y0, width, columns, rows, (x0 - far, y0 - far, x1 + far, y1 + far))


def _enter_locked(world: World) -> None:
    """Enter each locked circle and flat in every cell from which a circle could touch it."""
    grid = world.grid
    half = grid.width / 2.0
    margin = 1e-6 * grid.width  # far more than rounding, for a cell too many now and then
    for number, post in enumerate(world.locked):
        reach = post.radius + half + margin
        box = (post.x - reach, post.y - reach, post.x + reach, post.y + reach)
        for ix, iy, x, y in _cells(grid, *box):
            away = math.hypot(max(abs(x - post.x) - half, 0.0), max(abs(y - post.y) - half, 0.0))
            if away <= reach:
                _enter(grid.locked[list_number(grid, ix, iy)], number)
    for number, flat in enumerate(world.flats):
        reach = half + margin
        end_x, end_y = flat.x + flat.length * flat.ny, flat.y - flat.length * flat.nx
        box = (
            min(flat.x, end_x) - reach,
            min(flat.y, end_y) - reach,
            max(flat.x, end_x) + reach,
            max(flat.y, end_y) + reach,
        )
        # Half the extent of a cell across the wall.
        across = half * (abs(flat.nx) + abs(flat.ny))
        for ix, iy, x, y in _cells(grid, *box):
            if abs((x - flat.x) * flat.nx + (y - flat.y) * flat.ny) <= reach + across:
                _enter(grid.flats[list_number(grid, ix, iy)], number)


def _cells(
    grid: Grid, x_min: float, y_min: float, x_max: float, y_max: float
) -> list[tuple[int, int, float, float]]:
    """Return column, row and centre of the cells that a box meets."""
    w = grid.width
    columns = range(math.floor((x_min - grid.x0) / w), math.floor((x_max - grid.x0) / w) + 1)
    rows = range(math.floor((y_min - grid.y0) / w), math.floor((y_max - grid.y0) / w) + 1)
    return [
        (ix, iy, grid.x0 + (ix + 0.5) * w, grid.y0 + (iy + 0.5) * w) for ix in columns for iy in rows
    ]


def _enter(members: list[int], number: int) -> None:
    """Add a number to a list that far-away cells share, once."""
    if number not in members:
        members.append(number)
