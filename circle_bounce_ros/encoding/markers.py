"""
visualization_msgs/MarkerArray: the scene for RViz.

Everything lies in the plane z = 0, where the poses are, and is drawn so that its cut with that plane is
true: moving circles are spheres, locked ones thin discs, so that they differ in shape as well as in
colour. Markers that one list can hold go into one list: RViz chokes on 20,000 separate ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from circle_bounce_ros.encoding.checks import floats, lengths
from circle_bounce_ros.encoding.layout import (
    FLOAT32,
    FLOAT64,
    INT32,
    UINT8,
    UINT32,
    Layout,
    Slot,
)
from circle_bounce_ros.encoding.poses import IDENTITY
from circle_bounce_ros.encoding.stamps import put_header, split
from circle_bounce_ros.kernel import Scene, Wall

# More lists than this cost RViz more than the picture is worth.
MOST_RADII = 64

# More locked circles than this are drawn as spheres, in one list a radius.
MOST_DISCS = 1000

# Red, green, blue, opacity. Bluish green and vermilion of Okabe and Ito: every kind of eye tells them apart.
MOVING = (0.0, 158 / 255, 115 / 255, 1.0)
LOCKED = (213 / 255, 94 / 255, 0.0, 1.0)
WALLS = (0.6, 0.6, 0.6, 1.0)

DISC_HEIGHT = 0.1  # of its diameter
WALL_WIDTH = 0.005  # of the longer side of the box around all walls

# What visualization_msgs/Marker calls them.
CYLINDER, LINE_LIST, SPHERE_LIST = 3, 5, 7
ADD, DELETEALL = 0, 3

NO_POINTS = np.zeros((0, 2))


class _Marker(NamedTuple):
    """What distinguishes one marker from another."""

    ns: str = ''
    id: int = 0
    type: int = 0
    action: int = ADD
    position: tuple[float, float] = (0.0, 0.0)  # m
    scale: tuple[float, float, float] = (0.0, 0.0, 0.0)  # m
    colour: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    points: NDArray[np.float64] = NO_POINTS  # (n, 2), m


class _Slots(NamedTuple):
    stamp: Slot
    points: Slot


DELETE_ALL = _Marker(action=DELETEALL)


def _put_marker(layout: Layout, frame_id: str, marker: _Marker) -> _Slots:
    points_3d = np.zeros((len(marker.points), 3))
    points_3d[:, :2] = marker.points
    stamp = put_header(layout, frame_id)
    layout.put_string(marker.ns, 'ns')
    layout.put(INT32, (marker.id, marker.type, marker.action))
    layout.put(FLOAT64, (*marker.position, 0.0))
    layout.put(FLOAT64, IDENTITY)
    layout.put(FLOAT64, marker.scale)
    layout.put(FLOAT32, marker.colour)
    layout.put(INT32, (0, 0))  # lifetime: for ever
    layout.put(UINT8, False)  # frame_locked
    points = layout.put_sequence(FLOAT64, points_3d)
    layout.put_sequence(FLOAT32, ())  # colors
    layout.put_string('', 'texture_resource')
    put_header(layout, '')  # texture, a CompressedImage without a stamp
    layout.put_string('', 'texture.format')
    layout.put_sequence(UINT8, ())  # texture.data
    layout.put_sequence(FLOAT32, ())  # uv_coordinates
    layout.put_string('', 'text')
    layout.put_string('', 'mesh_resource')
    layout.put_string('', 'mesh_file.filename')
    layout.put_sequence(UINT8, ())  # mesh_file.data
    layout.put(UINT8, False)  # mesh_use_embedded_materials
    return _Slots(stamp, points)


class _MarkerArray:
    """A MarkerArray laid out, whose stamps and points can be written anew."""

    def __init__(self, frame_id: str, markers: Sequence[_Marker]) -> None:
        layout = Layout()
        layout.put(UINT32, len(markers))
        slots = [_put_marker(layout, frame_id, marker) for marker in markers]
        self._message = layout.finish()
        self._stamps = [self._message.view(slot.stamp) for slot in slots]
        self.points = [self._message.view(slot.points) for slot in slots]

    def encode(self, stamp_ns: int) -> bytes:
        time = split(stamp_ns)
        for stamp in self._stamps:
            stamp[:] = time
        return self._message.to_bytes()


class _Alike(NamedTuple):
    """Circles of one radius, and where they are among all."""

    radius: float  # m
    rows: NDArray[np.intp]  # (k,)


def _group(radii: NDArray[np.float64]) -> list[_Alike]:
    distinct, counts = np.unique(radii, return_counts=True)
    rows = np.split(np.argsort(radii, kind='stable'), np.cumsum(counts))[:-1]
    return [_Alike(*alike) for alike in zip(distinct.tolist(), rows, strict=True)]


def _sphere_lists(
    ns: str,
    colour: tuple[float, float, float, float],
    groups: Sequence[_Alike],
    positions: NDArray[np.float64],
) -> list[_Marker]:
    return [
        _Marker(
            ns,
            number,
            SPHERE_LIST,
            scale=(2.0 * radius,) * 3,
            colour=colour,
            points=positions[rows],
        )
        for number, (radius, rows) in enumerate(groups)
    ]


class MovingMarkersEncoder:
    """
    The moving circles as visualization_msgs/MarkerArray.

    One SPHERE_LIST a radius, from the smallest to the largest.

    Parameters
    ----------
    frame_id : str
    radii : (n,) float, m
        At most `MOST_RADII` different ones, or ValueError.

    """

    def __init__(self, frame_id: str, radii: ArrayLike) -> None:
        sizes = lengths(radii, 'radii')
        self._groups = _group(sizes)
        if len(self._groups) > MOST_RADII:
            got = len(self._groups)
            raise ValueError(f'radii: must have at most {MOST_RADII} different values, got {got}')
        self._frame_id = frame_id
        self._shape = (sizes.size, 2)
        self._array = _MarkerArray(frame_id, self._markers(np.zeros(self._shape)))

    def _markers(self, positions: NDArray[np.float64]) -> list[_Marker]:
        return _sphere_lists('moving', MOVING, self._groups, positions)

    def encode(self, stamp_ns: int, positions: ArrayLike, clear: bool = False) -> bytes:
        """
        Return the message.

        Parameters
        ----------
        stamp_ns : int, ns
        positions : (n, 2) float, m
        clear : bool
            Begin with a marker that deletes what was shown before.

        """
        now = floats(positions, self._shape, 'positions')
        if clear:
            return _MarkerArray(self._frame_id, [DELETE_ALL, *self._markers(now)]).encode(stamp_ns)
        for points, alike in zip(self._array.points, self._groups, strict=True):
            points[:, 0], points[:, 1] = now.take(alike.rows, axis=0).T
        return self._array.encode(stamp_ns)


def encode_static_markers(frame_id: str, stamp_ns: int, scene: Scene) -> bytes:
    """
    Return walls and locked circles as visualization_msgs/MarkerArray.

    It begins with a marker that deletes what was shown before. The walls are one LINE_LIST, each
    locked circle is a flat CYLINDER whose id is the circle's index in the scene. If there are more than
    `MOST_DISCS`, those of one radius are one SPHERE_LIST instead.

    Parameters
    ----------
    frame_id : str
    stamp_ns : int, ns
    scene : Scene

    """
    markers = [DELETE_ALL]
    if scene.walls:
        markers.append(_lines(scene.walls))
    locked = [index for index, circle in enumerate(scene.circles) if circle.locked]
    if len(locked) > MOST_DISCS:
        radii = np.array([scene.circles[index].radius for index in locked])
        positions = np.array([scene.circles[index].position for index in locked])
        markers += _sphere_lists('locked', LOCKED, _group(radii), positions)
    else:
        markers += [_disc(scene, index) for index in locked]
    return _MarkerArray(frame_id, markers).encode(stamp_ns)


def _lines(walls: Sequence[Wall]) -> _Marker:
    ends = np.array([end for wall in walls for end in (wall.start, wall.end)])
    width = WALL_WIDTH * float(np.ptp(ends, axis=0).max())
    return _Marker('walls', 0, LINE_LIST, scale=(width, 0.0, 0.0), colour=WALLS, points=ends)


def _disc(scene: Scene, index: int) -> _Marker:
    circle = scene.circles[index]
    diameter = 2.0 * circle.radius
    return _Marker(
        'locked',
        index,
        CYLINDER,
        position=circle.position,
        scale=(diameter, diameter, DISC_HEIGHT * diameter),
        colour=LOCKED,
    )
