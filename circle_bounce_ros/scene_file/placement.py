"""Places for circles in a region, clear of each other and of everything that is there already."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from circle_bounce_ros.kernel import Circle, Wall
from circle_bounce_ros.scene_file.rng import Draw, choose, uniform

Point = tuple[float, float]

# Circles are placed as if they were larger by this fraction, so that rounding makes no overlap.
CLEARANCE = 1e-6

# Tries at random before a circle counts as one that cannot fit. Near packing 0.45 one try in a hundred succeeds,
# so a circle with that much room is never given up; that a region is full shows within a second.
TRIES = 20_000

# Lattices are tried from the widest spacing that could hold the group downwards, in steps of this fraction.
LATTICE_STEP = 0.01

# ... to where the lattice has about this many places for each circle: if those do not do, hardly any is free.
MOST_PLACES = 20


class Region(NamedTuple):
    """The box in which circles are placed, whole circles inside."""

    left: float  # m
    bottom: float
    right: float
    top: float

    @property
    def area(self) -> float:
        """The area, m^2."""
        return (self.right - self.left) * (self.top - self.bottom)

    def shrunk(self, by: float) -> Region:
        """Return where the centre of a circle of radius `by` may be."""
        return Region(self.left + by, self.bottom + by, self.right - by, self.top - by)


class Room:
    """
    What a circle in a region must keep clear of, sorted into cells by where a centre might meet it.

    Parameters
    ----------
    region : Region
    largest : float, m
        The largest radius that will be asked for.
    count : int
        How many circles are expected: there are not many more cells than that, however small the circles.

    """

    def __init__(self, region: Region, largest: float, count: int) -> None:
        self._region = region
        self._largest = largest * (1.0 + CLEARANCE)
        most = math.isqrt(count) + 1
        width, height = region.right - region.left, region.top - region.bottom
        self._columns = max(1, min(most, int(width / (2.0 * largest))))
        self._rows = max(1, min(most, int(height / (2.0 * largest))))
        self._per_x = self._columns / width
        self._per_y = self._rows / height
        cells = self._columns * self._rows
        self._circles: list[list[tuple[float, float, float]]] = [[] for _ in range(cells)]
        self._walls: list[list[Wall]] = [[] for _ in range(cells)]

    def add_circle(self, x: float, y: float, radius: float) -> None:
        """Take up room with a circle."""
        for cell in self._cells(Region(x, y, x, y), radius + self._largest):
            self._circles[cell].append((x, y, radius))

    def add_wall(self, wall: Wall) -> None:
        """Take up room with a wall."""
        (sx, sy), (ex, ey) = wall.start, wall.end
        box = Region(min(sx, ex), min(sy, ey), max(sx, ex), max(sy, ey))
        for cell in self._cells(box, self._largest):
            self._walls[cell].append(wall)

    def is_free(self, x: float, y: float, radius: float) -> bool:
        """Return whether a circle with its centre in the region has room there."""
        cell = self._row(y) * self._columns + self._column(x)
        radius *= 1.0 + CLEARANCE
        for other_x, other_y, other_radius in self._circles[cell]:
            dx, dy, reach = other_x - x, other_y - y, other_radius + radius
            if dx * dx + dy * dy < reach * reach:
                return False
        return all(_distance_sq(x, y, wall) >= radius * radius for wall in self._walls[cell])

    def _column(self, x: float) -> int:
        return min(max(int((x - self._region.left) * self._per_x), 0), self._columns - 1)

    def _row(self, y: float) -> int:
        return min(max(int((y - self._region.bottom) * self._per_y), 0), self._rows - 1)

    def _cells(self, box: Region, margin: float) -> Iterator[int]:
        """Yield the cells of all centres that may be within a margin of a box."""
        near = box.shrunk(-margin)
        region = self._region
        if near.right < region.left or near.left > region.right:
            return
        if near.top < region.bottom or near.bottom > region.top:
            return
        for row in range(self._row(near.bottom), self._row(near.top) + 1):
            for column in range(self._column(near.left), self._column(near.right) + 1):
                yield row * self._columns + column


def one_after_the_other(
    region: Region, radii: list[float], circles: list[Circle], walls: list[Wall], draw: Draw
) -> list[Point]:
    """
    Return a random place for each circle (random sequential placement).

    Parameters
    ----------
    region : Region
    radii : list of float, m
        Largest first.
    circles, walls : list
        What to keep clear of.
    draw : function

    Returns
    -------
    list of (float, float), m
        Fewer than there are radii when one of the circles found no room.

    """
    room = _furnished(region, radii, circles, walls)
    positions: list[Point] = []
    for radius in radii:
        place = _free_place(room, region.shrunk(radius * (1.0 + CLEARANCE)), radius, draw)
        if place is None:
            break
        positions.append(place)
        room.add_circle(*place, radius)
    return positions


def on_a_lattice(
    region: Region, radii: list[float], circles: list[Circle], walls: list[Wall], draw: Draw
) -> list[Point]:
    """
    Return places on the widest lattice with enough free ones; random numbers say which of them stay empty.

    Parameters and what is returned are those of `one_after_the_other`; every place has room for the
    largest circle.
    """
    room = _furnished(region, radii, circles, walls)
    largest = radii[0]
    # Twice the clearance, so that neighbours and walls at the border are beyond it whatever the rounding.
    tightest = 2.0 * largest * (1.0 + 2.0 * CLEARANCE)
    centres = region.shrunk(0.5 * tightest)
    # A hexagonal lattice has one place in sqrt(3) / 2 spacing^2, and at a border more than its share.
    spacing = tightest + math.sqrt(2.0 / math.sqrt(3.0) * region.area / len(radii))
    smallest = max(tightest, _spacing_of(MOST_PLACES * len(radii), region))
    most: list[Point] = []
    while spacing > smallest:
        spacing = max(smallest, spacing * (1.0 - LATTICE_STEP))
        for places in _lattices(centres, spacing):
            if len(places) <= len(most):
                continue
            free = [place for place in places if room.is_free(*place, largest)]
            if len(free) >= len(radii):
                return [free[i] for i in choose(draw, len(radii), len(free))]
            most = max(most, free, key=len)
    return most


def _spacing_of(places: int, region: Region) -> float:
    """Return a spacing at which a region, however narrow, has about so many places."""
    longer_side = max(region.right - region.left, region.top - region.bottom)
    return max(longer_side / places, math.sqrt(region.area / places))


def _free_place(room: Room, centres: Region, radius: float, draw: Draw) -> Point | None:
    if centres.left > centres.right or centres.bottom > centres.top:
        return None
    for _ in range(TRIES):
        x = uniform(draw, centres.left, centres.right)
        y = uniform(draw, centres.bottom, centres.top)
        if room.is_free(x, y, radius):
            return x, y
    return None


def _furnished(
    region: Region, radii: list[float], circles: list[Circle], walls: list[Wall]
) -> Room:
    room = Room(region, radii[0], len(radii) + len(circles))
    for circle in circles:
        room.add_circle(*circle.position, circle.radius)
    for wall in walls:
        room.add_wall(wall)
    return room


def _lattices(centres: Region, spacing: float) -> Iterator[list[Point]]:
    """Yield the places of three lattices: hexagonal with rows along x, then along y, and square."""
    width, height = centres.right - centres.left, centres.top - centres.bottom
    if width < 0.0 or height < 0.0:
        return
    for places, x, y in (
        (_hexagonal(width, height, spacing), 0, 1),
        (_hexagonal(height, width, spacing), 1, 0),
        (_square(width, height, spacing), 0, 1),
    ):
        yield [(centres.left + place[x], centres.bottom + place[y]) for place in places]


def _hexagonal(width: float, height: float, spacing: float) -> Iterator[Point]:
    """Yield a hexagonal lattice of at least this spacing, stretched so that it fills the box."""
    full = int(width / spacing) + 1
    shifted = int(width / spacing + 0.5)
    # Every second row is shifted by half a step: either it loses a place, or all rows end half a step early.
    if shifted == full:
        step, short_row = width / (full - 0.5), full
    else:
        step, short_row = width / max(full - 1, 1), full - 1
    rows = _spread(height, spacing * math.sqrt(0.75))
    for number, y in enumerate(rows):
        odd = number % 2
        for k in range(short_row if odd else full):
            yield (k + 0.5 * odd) * step, y


def _square(width: float, height: float, spacing: float) -> Iterator[Point]:
    return ((x, y) for y in _spread(height, spacing) for x in _spread(width, spacing))


def _spread(length: float, spacing: float) -> list[float]:
    """Return as many numbers as fit from 0 to `length` at this spacing, spread evenly; one alone in the middle."""
    gaps = int(length / spacing)
    return [length * (k / gaps) for k in range(gaps + 1)] if gaps else [0.5 * length]


def _distance_sq(x: float, y: float, wall: Wall) -> float:
    """Return the squared distance of a point from the nearest point of a wall."""
    (sx, sy), (ex, ey) = wall.start, wall.end
    along_x, along_y = ex - sx, ey - sy
    share = ((x - sx) * along_x + (y - sy) * along_y) / (along_x * along_x + along_y * along_y)
    share = min(max(share, 0.0), 1.0)
    dx, dy = sx + share * along_x - x, sy + share * along_y - y
    return dx * dx + dy * dy
