"""
The scenes that everybody gets. The smallest circles have a radius of 1 m, frames last 1/60 s.

Circles are placed at random without overlap, one after the other, and have velocities as in a gas at rest.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

from circle_bounce_ros.kernel import Circle, Scene, Wall

FRAME = 1.0 / 60.0  # s
SEED = 1

# Disks cover this part of the box.
PACKING = 0.3

# The standard deviation of each component of the velocities, in smallest radii per frame: the speed of the packaged
# gas, ten radii a second. What an event-driven engine costs grows with it, what a fixed step costs does not.
SPEED = 1.0 / 6.0

Point = tuple[float, float]
Rule = Callable[[float, float, float], bool]


class Kind(NamedTuple):
    """So many circles that are alike."""

    count: int
    radius: float  # m
    mass: float = 1.0  # kg
    locked: bool = False


def gas(count: int, packing: float = PACKING, speed: float = SPEED) -> Scene:
    """Return equal disks in a square."""
    return in_a_square([Kind(count, 1.0)], packing, speed)


def mixed(count: int) -> Scene:
    """Return disks with radii and masses 2:1, half of them large, among 20 locked circles."""
    small = Kind(count // 2, 1.0)
    return in_a_square([Kind(20, 2.0, locked=True), Kind(count // 2, 2.0, 2.0), small], PACKING)


def sizes(count: int, ratio: float, share: float) -> Scene:
    """Return disks of which a share is `ratio` times as large as the others, and as heavy."""
    large = round(count * share)
    return in_a_square([Kind(large, ratio), Kind(count - large, 1.0)], PACKING)


def ghosts(count: int) -> Scene:
    """Return balls that pass through each other, among 100 locked circles of three times their radius."""
    posts = in_a_square([Kind(100, 3.0, locked=True), Kind(1, 1.0)], PACKING)
    rng = random.Random(SEED)
    box = bounds(posts.walls)
    room = Room(2.0 * 3.0)
    for post in posts.circles[:100]:
        room.add(post.position, post.radius)
    balls = [
        Circle(room.find(box, 1.0, rng), velocity(rng, SPEED), radius=1.0) for _ in range(count)
    ]
    return Scene([*posts.circles[:100], *balls], posts.walls, moving_circles_collide=False)


def one_ball() -> Scene:
    """Return one ball and one locked circle in a box."""
    circles = [
        Circle((0.0, 0.0), radius=3.0, locked=True),
        Circle((-6.0, 2.0), (60.0 * SPEED, 23.0 * SPEED), radius=1.0),
    ]
    return Scene(circles, polygon([(-10.0, -10.0), (10.0, -10.0), (10.0, 10.0), (-10.0, 10.0)]))


def in_a_square(kinds: Iterable[Kind], packing: float, speed: float = SPEED) -> Scene:
    """Return circles that cover so much of a square."""
    return in_a_polygon(kinds, packing, 4, speed)


def in_a_polygon(
    kinds: Iterable[Kind], packing: float, corners: int, speed: float = SPEED
) -> Scene:
    """Return circles in a regular polygon; but for the square no side lies along an axis."""
    kinds = list(kinds)
    area = math.pi * sum(kind.count * kind.radius**2 for kind in kinds) / packing
    outer = math.sqrt(2.0 * area / (corners * math.sin(2.0 * math.pi / corners)))
    start = math.pi / 4.0 if corners == 4 else 0.3
    angles = [start + 2.0 * math.pi * k / corners for k in range(corners)]
    walls = polygon([(outer * math.cos(angle), outer * math.sin(angle)) for angle in angles])

    def fits(x: float, y: float, radius: float) -> bool:
        return all(across(wall, x, y) >= radius * (1.0 + 1e-9) for wall in walls)

    rng = random.Random(SEED)
    room = Room(2.0 * max(kind.radius for kind in kinds))
    circles = []
    for kind in sorted(kinds, key=lambda kind: -kind.radius):
        for _ in range(kind.count):
            place = room.find(bounds(walls), kind.radius, rng, fits)
            room.add(place, kind.radius)
            moves = velocity(rng, speed / math.sqrt(kind.mass))
            circles.append(
                Circle(
                    place,
                    (0.0, 0.0) if kind.locked else moves,
                    radius=kind.radius,
                    mass=kind.mass,
                    locked=kind.locked,
                )
            )
    return Scene(circles, walls)


def velocity(rng: random.Random, radii_per_frame: float) -> Point:
    """Return a velocity, m/s, whose components are normal with this deviation."""
    deviation = radii_per_frame / FRAME
    return rng.gauss(0.0, deviation), rng.gauss(0.0, deviation)


def polygon(points: list[Point]) -> list[Wall]:
    """Return walls from each point to the next and back to the first."""
    return [Wall(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]


def across(wall: Wall, x: Any, y: Any) -> Any:
    """Return how far a point lies, or points lie, to the left of a wall, m."""
    (sx, sy), (ex, ey) = wall.start, wall.end
    return ((ex - sx) * (y - sy) - (ey - sy) * (x - sx)) / math.dist(wall.start, wall.end)


def bounds(walls: Iterable[Wall]) -> tuple[Point, Point]:
    """Return the box around walls."""
    xs, ys = zip(*(wall.start for wall in walls), strict=True)
    return (min(xs), min(ys)), (max(xs), max(ys))


class Room:
    """
    Circles in square cells that are no smaller than any of them.

    Parameters
    ----------
    width : float, m
        Of a cell: the largest diameter.

    """

    def __init__(self, width: float) -> None:
        self._width = width
        self._cells: dict[tuple[int, int], list[tuple[float, float, float]]] = {}

    def add(self, place: Point, radius: float) -> None:
        """Put a circle there."""
        self._cells.setdefault(self._cell(*place), []).append((*place, radius))

    def find(
        self,
        box: tuple[Point, Point],
        radius: float,
        rng: random.Random,
        fits: Rule | None = None,
    ) -> Point:
        """Return a random place in a box where a circle touches no other, and that a rule allows."""
        (left, bottom), (right, top) = box
        while True:
            x = rng.uniform(left + radius, right - radius)
            y = rng.uniform(bottom + radius, top - radius)
            if self._is_free(x, y, radius) and (fits is None or fits(x, y, radius)):
                return x, y

    def _cell(self, x: float, y: float) -> tuple[int, int]:
        return math.floor(x / self._width), math.floor(y / self._width)

    def _is_free(self, x: float, y: float, radius: float) -> bool:
        column, row = self._cell(x, y)
        return not any(
            (x - a) ** 2 + (y - b) ** 2 < (radius + c) ** 2
            for dx in (-1, 0, 1)
            for dy in (-1, 0, 1)
            for a, b, c in self._cells.get((column + dx, row + dy), ())
        )
