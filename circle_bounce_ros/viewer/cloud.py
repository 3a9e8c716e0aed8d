"""A serialized sensor_msgs/PointCloud2 read in place: 280 kB of circles need not become a Python object."""

from __future__ import annotations

import struct
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.encoding.clouds import DATATYPES

# What the numbers of sensor_msgs/PointField stand for.
DTYPES = {number: dtype for dtype, number in DATATYPES.items()}

HEADER = 4  # bytes before the message proper, which alignment does not count
LITTLE_ENDIAN = 1  # the second byte of that header


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
        For bytes that are no little-endian cloud of the numbers that `encoding` writes.

    """
    if len(message) < HEADER or message[1] != LITTLE_ENDIAN:
        raise ValueError('cloud: must be little-endian CDR')
    reader = _Reader(message)
    try:
        reader.position += 8  # the stamp
        reader.text()
        height, width, count = reader.uint32(), reader.uint32(), reader.uint32()
        formats: dict[str, tuple[Any, int]] = {}
        for _ in range(count):
            name, offset, datatype = reader.text(), reader.uint32(), reader.uint8()
            reader.uint32()  # one number a field
            formats[name] = (DTYPES[datatype], offset)
        reader.uint8()  # is_bigendian
        point_step = reader.uint32()
        reader.uint32()  # row_step
        reader.uint32()  # length of the data
        point = np.dtype(
            {
                'names': list(formats),
                'formats': [dtype for dtype, _ in formats.values()],
                'offsets': [offset for _, offset in formats.values()],
                'itemsize': point_step,
            }
        )
        points = np.frombuffer(message, point, height * width, HEADER + reader.position)
    except (struct.error, IndexError, KeyError, OverflowError, UnicodeDecodeError) as error:
        raise ValueError(f'cloud: not readable: {error}') from error
    return Cloud(stamp_of(message), points)


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
        return self._message[start : start + length - 1].decode()
