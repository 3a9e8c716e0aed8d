"""
sensor_msgs/PointCloud2: the moving circles, and what they have touched.

A cloud describes its own points field by field. That description is the numpy dtype of the points here,
so the array of points is the data of the message as it stands.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from circle_bounce_ros.encoding.checks import floats, lengths
from circle_bounce_ros.encoding.layout import FLOAT32, FLOAT64, UINT8, UINT32, Layout
from circle_bounce_ros.encoding.stamps import put_header, split
from circle_bounce_ros.kernel import CONTACT, CONTACT_FIELDS

# The numbers that sensor_msgs/PointField has for them, from 1 on.
KINDS = ('i1', 'u1', '<i2', '<u2', '<i4', '<u4', '<f4', '<f8')
DATATYPES = {np.dtype(kind): number for number, kind in enumerate(KINDS, start=1)}

BODY = np.dtype(
    [(name, FLOAT32) for name in ('x', 'y', 'z', 'vx', 'vy', 'radius', 'mass')] + [('id', UINT32)]
)


def _contact_point() -> np.dtype[Any]:
    """Return `kernel.CONTACT` as points in space: place and normal first, then large numbers before small ones."""
    narrow: dict[type[np.generic], np.dtype[Any]] = {
        np.float64: FLOAT32,
        np.int64: UINT32,
        np.uint8: UINT8,
    }
    types = {field.name: narrow[field.type] for field in CONTACT_FIELDS} | {'time': FLOAT64}
    in_space: list[tuple[str, np.dtype[Any]]] = [
        (name, FLOAT32) for name in ('x', 'y', 'z', 'nx', 'ny', 'nz')
    ]
    others = [item for item in types.items() if item not in in_space]
    return np.dtype(in_space + sorted(others, key=lambda item: -item[1].itemsize))


# Without padding: point_step is the sum of the fields, as readers that make points of their own expect.
CONTACT_POINT = _contact_point()


class _Cloud:
    """All of a cloud but its points."""

    def __init__(self, frame_id: str, point: np.dtype[Any]) -> None:
        layout = Layout()
        stamp = put_header(layout, frame_id)
        layout.put(UINT32, 1)  # height
        width = layout.put(UINT32, 0)
        assert point.fields is not None
        layout.put(UINT32, len(point.fields))
        for name, (dtype, offset, *_) in point.fields.items():
            layout.put_string(name, 'name')
            layout.put(UINT32, offset)
            layout.put(UINT8, DATATYPES[dtype])
            layout.put(UINT32, 1)  # count
        layout.put(UINT8, False)  # is_bigendian
        layout.put(UINT32, point.itemsize)
        row_step = layout.put(UINT32, 0)
        size = layout.put(UINT32, 0)
        self._head = layout.finish()
        self._stamp = self._head.view(stamp)
        self._width = self._head.view(width)
        self._row_step = self._head.view(row_step)
        self._size = self._head.view(size)

    def encode(self, stamp_ns: int, points: NDArray[np.void], is_dense: bool) -> bytes:
        self._stamp[:] = split(stamp_ns)
        self._width[...] = points.size
        self._row_step[...] = self._size[...] = points.nbytes
        return b''.join((self._head.to_bytes(), points.data, b'\x01' if is_dense else b'\x00'))


def _write(points: NDArray[np.void], columns: dict[str, NDArray[Any]]) -> bool:
    """Write columns of points and return whether every number is finite, as float32 too."""
    with np.errstate(over='ignore'):  # what float32 cannot hold becomes infinite
        for name, values in columns.items():
            points[name] = values
    return all(bool(np.isfinite(points[name]).all()) for name in columns)


class BodiesEncoder:
    """
    The moving circles as a cloud, one point each: x, y, z, vx, vy, radius, mass (float32), id (uint32).

    Parameters
    ----------
    frame_id : str
    ids : (n,) int
        The circles' indices in the scene.
    radii : (n,) float, m
    masses : (n,) float, kg

    """

    def __init__(self, frame_id: str, ids: ArrayLike, radii: ArrayLike, masses: ArrayLike) -> None:
        numbers = np.asarray(ids)
        sizes = lengths(radii, 'radii')
        weights = floats(masses, sizes.shape, 'masses')
        if numbers.shape != sizes.shape:
            raise ValueError(f'ids: must have shape {sizes.shape}, got {numbers.shape}')
        wrong = np.flatnonzero((numbers < 0) | (numbers >= 2**32))
        if wrong.size:
            first = wrong[0]
            raise ValueError(f'ids[{first}]: must be from 0 to below 2**32, got {numbers[first]}')
        self._cloud = _Cloud(frame_id, BODY)
        self._points = np.zeros(sizes.size, BODY)
        self._constants_are_dense = _write(
            self._points, {'radius': sizes, 'mass': weights, 'id': numbers}
        )

    def encode(self, stamp_ns: int, positions: ArrayLike, velocities: ArrayLike) -> bytes:
        """
        Return the message; `is_dense` is false where a number is beyond float32.

        Parameters
        ----------
        stamp_ns : int, ns
        positions : (n, 2) float, m
        velocities : (n, 2) float, m/s

        """
        shape = (self._points.size, 2)
        x, y = floats(positions, shape, 'positions').T
        vx, vy = floats(velocities, shape, 'velocities').T
        is_dense = _write(self._points, {'x': x, 'y': y, 'vx': vx, 'vy': vy})
        return self._cloud.encode(stamp_ns, self._points, is_dense and self._constants_are_dense)


class ContactsEncoder:
    """
    Contacts as a cloud, one point each, in the order given.

    The fields of `kernel.CONTACT_FIELDS` with z and nz: time is float64 (scene seconds), a and b are uint32,
    kind is uint8, all others are float32.
    """

    def __init__(self, frame_id: str) -> None:
        self._cloud = _Cloud(frame_id, CONTACT_POINT)

    def encode(self, stamp_ns: int, contacts: NDArray[np.void]) -> bytes:
        """
        Return the message; `is_dense` is false where a number is beyond float32.

        Parameters
        ----------
        stamp_ns : int, ns
        contacts : (k,) structured array of dtype `kernel.CONTACT`

        """
        if contacts.dtype != CONTACT or contacts.ndim != 1:
            got = f'shape {contacts.shape} of {contacts.dtype}'
            raise ValueError(f'contacts: must have shape (k,) of kernel.CONTACT, got {got}')
        points = np.zeros(contacts.size, CONTACT_POINT)
        is_dense = _write(points, {name: contacts[name] for name in CONTACT.names or ()})
        return self._cloud.encode(stamp_ns, points, is_dense)
