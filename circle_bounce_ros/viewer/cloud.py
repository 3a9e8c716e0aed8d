"""A serialized sensor_msgs/PointCloud2 read in place: 280 kB of circles need not become a Python object."""

from __future__ import annotations

import struct
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.encoding.clouds import DATATYPES

# What the numbers of sensor_msgs/PointField stand for.
DTYPES = {number: dtype for dtype, number in DATATYPES.items()}

HEADER = 4  # bytes before the message proper, which alignment does not count
LITTLE_ENDIAN = 1  # the second byte of that header
LARGEST_POINT = 2**16  # bytes; numpy has room for no more than 2**31


def stamp_of(message: bytes) -> int:
    """
    Return the stamp of any serialized message that begins with a std_msgs/Header, ns.

    Raises
    ------
    ValueError
        For bytes that end before it does.

    """
    try:
        seconds, nanoseconds = struct.unpack_from('<iI', message, HEADER)
    except struct.error as error:
        raise ValueError(f'stamp: not readable: {error}') from error
    return int(seconds) * 10**9 + int(nanoseconds)


class Cloud(NamedTuple):
    """
    A cloud's stamp and points.

    Attributes
    ----------
    stamp_ns : int, ns
    points : (n,) structured array
        A view of the message.

    """

    stamp_ns: int
    points: NDArray[np.void]


def read_cloud(message: bytes) -> Cloud:
    """
    Return the points of a serialized cloud, by its own description of its fields.

    Raises
    ------
    ValueError
        For bytes that are no little-endian cloud, and for a description that contradicts itself or the data.

    """
    if len(message) < HEADER or message[1] != LITTLE_ENDIAN:
        raise ValueError('cloud: must be little-endian CDR')
    reader = _Reader(message)
    try:
        reader.position += 8  # the stamp
        reader.text()
        height, width, count = reader.uint32(), reader.uint32(), reader.uint32()
        fields = [
            _Field(reader.text(), reader.uint32(), reader.uint8(), reader.uint32())
            for _ in range(count)
        ]
        is_bigendian, point_step, row_step = reader.uint8(), reader.uint32(), reader.uint32()
        length = reader.uint32()
    except (struct.error, IndexError, UnicodeDecodeError) as error:
        raise ValueError(f'cloud: not readable: {error}') from error
    if is_bigendian:
        raise ValueError('cloud.is_bigendian: must be false')
    point = _point(fields, point_step)
    if row_step != width * point_step:
        raise ValueError(
            f'cloud.row_step: must be width * point_step = {width * point_step}, got {row_step}'
        )
    if length != height * row_step:
        raise ValueError(
            f'cloud.data: must have height * row_step = {height * row_step} bytes, got {length}'
        )
    start = HEADER + reader.position
    if len(message) < start + length:
        raise ValueError(f'cloud.data: must have {length} bytes, got {len(message) - start}')
    return Cloud(stamp_of(message), np.frombuffer(message, point, height * width, start))


def check_points(points: NDArray[np.void], wanted: np.dtype[Any], names: Iterable[str]) -> None:
    """
    Check that points have these fields, of the types that they have in `wanted`, and finite numbers in them.

    Raises
    ------
    ValueError

    """
    names = list(names)
    there = points.dtype.names or ()
    missing = sorted(set(names).difference(there))
    if missing:
        raise ValueError(f'cloud: must have the fields {", ".join(missing)}')
    for name in names:
        if points.dtype[name] != wanted[name]:
            raise ValueError(
                f'cloud.fields.{name}: must be {wanted[name]}, got {points.dtype[name]}'
            )
        if not np.isfinite(points[name]).all():
            raise ValueError(f'cloud: {name} must be finite')


class _Field(NamedTuple):
    name: str
    offset: int
    datatype: int
    numbers: int


def _point(fields: list[_Field], point_step: int) -> np.dtype[Any]:
    """Return what a point is, checked: numpy would take a step of 0 or of 4 GB."""
    formats: dict[str, tuple[np.dtype[Any], int]] = {}
    for name, offset, datatype, numbers in fields:
        place = f'cloud.fields.{name}'
        if not name or name in formats:
            raise ValueError(f'cloud.fields: must have names that differ, got {name!r}')
        if datatype not in DTYPES:
            raise ValueError(f'{place}: must have a datatype from 1 to 8, got {datatype}')
        if numbers != 1:
            raise ValueError(f'{place}: must have count 1, got {numbers}')
        dtype = DTYPES[datatype]
        if offset + dtype.itemsize > point_step:
            raise ValueError(
                f'{place}: must end within point_step = {point_step} bytes, '
                f'got {offset + dtype.itemsize}'
            )
        formats[name] = dtype, offset
    if not formats or point_step > LARGEST_POINT:
        raise ValueError(
            f'cloud.point_step: must be from 1 to {LARGEST_POINT} bytes, got {point_step}'
        )
    return np.dtype(
        {
            'names': list(formats),
            'formats': [dtype for dtype, _ in formats.values()],
            'offsets': [offset for _, offset in formats.values()],
            'itemsize': point_step,
        }
    )


class _Reader:
    def __init__(self, message: bytes) -> None:
        self._message = message
        self.position = 0

    def uint8(self) -> int:
        value = self._message[HEADER + self.position]
        self.position += 1
        return value

    def uint32(self) -> int:
        self.position += -self.position % 4
        (value,) = struct.unpack_from('<I', self._message, HEADER + self.position)
        self.position += 4
        return int(value)

    def text(self) -> str:
        length = self.uint32()
        start = HEADER + self.position
        self.position += length
        return self._message[start : start + max(0, length - 1)].decode()
