"""A group of a scene file -> circles: how many, how large, where, how fast."""

from __future__ import annotations

import math
from typing import Any

from circle_bounce_ros.kernel import Circle, SceneError, Wall
from circle_bounce_ros.scene_file import rng
from circle_bounce_ros.scene_file.placement import Point, Region, on_a_lattice, one_after_the_other
from circle_bounce_ros.scene_file.rng import Draw
from circle_bounce_ros.scene_file.walls import box_corners
from circle_bounce_ros.scene_file.wording import shown

# Circles of a scene that has groups: what a short text may fill the memory with.
LARGEST_COUNT = 100_000

# Circles placed one after the other at random jam at a packing of 0.547; from here on it is no use to begin so.
LATTICE_FROM_PACKING = 0.45


def fill(
    group: dict[str, Any], index: int, seed: int, circles: list[Circle], walls: list[Wall]
) -> list[Circle]:
    """
    Return the circles of a group.

    Drawn in this order: all radii (none when they are equal), all positions, all velocities.

    Parameters
    ----------
    group : dict
        As the schema has it.
    index : int
        The group's number in the file.
    seed : int
    circles, walls : list
        What is there already.

    Raises
    ------
    SceneError
        When the group cannot be: too many circles, none, a region without area, no room.

    """
    draw = rng.draws_of_group(seed, index)
    locked = group.get('locked', False)
    speed = group.get('speed', 0)
    if locked and speed != 0:
        raise SceneError('speed', f'must be 0 m/s for a locked group, got {shown(speed)}')
    corners = box_corners(group['region'], 'region')
    (left, bottom), (right, top) = corners[0], corners[2]
    region = Region(float(left), float(bottom), float(right), float(top))
    radii = _radii(group, region.area, draw)
    if len(circles) + len(radii) > LARGEST_COUNT:
        rule = f'must leave the scene with at most {LARGEST_COUNT} circles'
        raise SceneError('', f'{rule}, got {len(circles) + len(radii)}')
    positions = _positions(region, radii, circles, walls, draw)
    return [
        Circle(
            position,
            (0.0, 0.0) if locked else _velocity(speed, draw),
            radius=radius,
            mass=group.get('mass', 1.0),
            locked=locked,
        )
        for position, radius in zip(positions, radii, strict=True)
    ]


def _radii(group: dict[str, Any], area: float, draw: Draw) -> list[float]:
    """Return the radius of each circle, largest first: they find room while there is most of it."""
    count = int(group.get('count', 0))
    covered = group.get('packing', 0.0) * area
    if 'radius' not in group:
        return [math.sqrt(covered / (count * math.pi))] * count
    smallest, largest = _range(group['radius'])
    if not count:
        _check_count(covered, smallest, largest)
    if smallest == largest:
        return [largest] * (count or max(1, round(covered / (math.pi * largest * largest))))
    if count:
        radii = [rng.uniform(draw, smallest, largest) for _ in range(count)]
    else:
        radii = _radii_that_cover(covered, smallest, largest, draw)
    return sorted(radii, reverse=True)


def _range(radius: float | list[float]) -> tuple[float, float]:
    smallest, largest = radius if isinstance(radius, list) else (radius, radius)
    if not smallest <= largest:
        rule = f'must be >= radius[0], which is {shown(smallest)} m'
        raise SceneError('radius[1]', f'{rule}, got {shown(largest)}')
    return float(smallest), float(largest)


def _check_count(covered: float, smallest: float, largest: float) -> None:
    fewest, most = (covered / math.pi / radius / radius for radius in (largest, smallest))
    if fewest < 0.5:
        raise SceneError('radius', f'must be small enough for one circle, got {fewest:.3g} of one')
    if most > LARGEST_COUNT:
        problem = f'must be large enough for at most {LARGEST_COUNT} circles, got {most:.6g}'
        raise SceneError('radius', problem)


def _radii_that_cover(covered: float, smallest: float, largest: float, draw: Draw) -> list[float]:
    """Return random radii whose disks cover an area, as nearly as the last one allows."""
    radii: list[float] = []
    left = covered
    while True:
        radius = rng.uniform(draw, smallest, largest)
        disk = math.pi * radius * radius
        if radii and disk > 2.0 * left:
            return radii
        radii.append(radius)
        left -= disk


def _positions(
    region: Region, radii: list[float], circles: list[Circle], walls: list[Wall], draw: Draw
) -> list[Point]:
    """Return places by the way that suits the packing; what fails there may fit the other way."""
    covered = math.pi * sum(radius * radius for radius in radii)
    ways = [one_after_the_other, on_a_lattice]
    if covered >= LATTICE_FROM_PACKING * region.area:
        ways.reverse()
    most = 0
    for way in ways:
        positions = way(region, radii, circles, walls, draw)
        if len(positions) == len(radii):
            return positions
        most = max(most, len(positions))
    rule = 'must fit into its region without overlap'
    raise SceneError('', f'{rule}, got room for {most} of {len(radii)} circles')


def _velocity(speed: float | dict[str, float], draw: Draw) -> tuple[float, float]:
    if isinstance(speed, dict):
        return rng.maxwell(draw, speed['maxwell'])
    if speed == 0:
        return 0.0, 0.0
    x, y = rng.direction(draw)
    return speed * x, speed * y
