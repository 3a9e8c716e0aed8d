"""The walls of a scene file: each item is one wall, or a box or a polygon of several."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from circle_bounce_ros.kernel import SceneError, Wall
from circle_bounce_ros.scene_file.wording import shown

# As short as the schema lets a radius be, and far from where an area would be zero by rounding.
SHORTEST_SIDE = 1e-60  # m


class PlacedWall(NamedTuple):
    """A wall and where in the file it comes from."""

    wall: Wall
    place: str


def build_walls(items: Iterable[dict[str, Any]]) -> list[PlacedWall]:
    """
    Return the walls that the items describe, in their order.

    Raises
    ------
    SceneError
        For walls of no length and boxes of no area.

    """
    placed: list[PlacedWall] = []
    for index, item in enumerate(items):
        place = f'walls[{index}]'
        if 'box' in item:
            corners = box_corners(item['box'], f'{place}.box')
            placed += _closed(corners, f'{place}.box', '')
        elif 'polygon' in item:
            placed += _closed(item['polygon'], f'{place}.polygon', '[{}]')
        else:
            placed.append(PlacedWall(_wall(item['start'], item['end'], place), place))
    return placed


def box_corners(box: dict[str, Any], place: str) -> list[list[float]]:
    """
    Return the corners of a box, counter-clockwise from its lower left.

    Raises
    ------
    SceneError
        For a box without area.

    """
    (left, bottom), (right, top) = box['min'], box['max']
    for axis in (0, 1):
        low, high = box['min'][axis], box['max'][axis]
        if not low < high:
            rule = f'must be > min[{axis}], which is {shown(low)} m'
            raise SceneError(f'{place}.max[{axis}]', f'{rule}, got {shown(high)}')
        if high - low < SHORTEST_SIDE:
            rule = f'must be at least {SHORTEST_SIDE:g} m above min[{axis}]'
            raise SceneError(f'{place}.max[{axis}]', f'{rule}, got {high - low:g} m')
    return [[left, bottom], [right, bottom], [right, top], [left, top]]


def _closed(corners: list[list[float]], place: str, side: str) -> Iterable[PlacedWall]:
    """Yield the walls from each corner to the next, and from the last to the first."""
    for index, corner in enumerate(corners):
        following = corners[(index + 1) % len(corners)]
        here = place + side.format(index)
        if corner == following:
            raise SceneError(
                here, f'must differ from the next point, got {shown(corner)} for both'
            )
        yield PlacedWall(_wall(corner, following, here), here)


def _wall(start: list[float], end: list[float], place: str) -> Wall:
    try:
        return Wall((start[0], start[1]), (end[0], end[1]))
    except SceneError as error:
        raise error.within(place) from None
