"""
The wire format: CDR, little-endian, as ROS 2 middlewares speak it.

Four bytes say so, then the fields follow in the order of the message definition. A number lies at a
multiple of its own size, counted from after those four bytes; a string is its length with the final NUL,
its UTF-8 bytes and the NUL; a sequence is its length and its elements, and an empty one aligns nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

LITTLE_ENDIAN_CDR = b'\x00\x01\x00\x00'

UINT8 = np.dtype('u1')
INT32 = np.dtype('<i4')
UINT32 = np.dtype('<u4')
FLOAT32 = np.dtype('<f4')
FLOAT64 = np.dtype('<f8')


@dataclass(frozen=True)
class Slot:
    """Where in a message a number or a block of numbers lies."""

    offset: int  # bytes from the start of the message
    dtype: np.dtype[Any]
    shape: tuple[int, ...]


class Message:
    """The bytes of a message, of which some are written anew each time it is said."""

    def __init__(self, content: bytes) -> None:
        self._bytes = np.frombuffer(bytearray(content), UINT8)

    def view(self, slot: Slot) -> NDArray[Any]:
        """Return the slot as an array; to write to it is to write to the message."""
        return np.ndarray(slot.shape, slot.dtype, self._bytes, slot.offset)

    def to_bytes(self) -> bytes:
        """Return a copy of the message as it stands."""
        return self._bytes.tobytes()


class Layout:
    """A message being laid out, field after field."""

    def __init__(self) -> None:
        self._content = bytearray(LITTLE_ENDIAN_CDR)

    def put(self, dtype: np.dtype[Any], values: ArrayLike) -> Slot:
        """
        Append a number, or numbers one after the other, and return where they lie.

        Parameters
        ----------
        dtype : numpy.dtype
            Of one number; little-endian.
        values : (...) numbers

        """
        array = np.asarray(values, dtype)
        if array.size:
            written = len(self._content) - len(LITTLE_ENDIAN_CDR)
            self._content += bytes(-written % dtype.itemsize)
        slot = Slot(len(self._content), dtype, array.shape)
        self._content += array.tobytes()
        return slot

    def put_sequence(self, dtype: np.dtype[Any], values: ArrayLike) -> Slot:
        """
        Append a sequence and return where its elements lie.

        Parameters
        ----------
        dtype : numpy.dtype
            Of one number; little-endian.
        values : (n, ...) numbers
            n elements, each of them numbers of the same size one after the other.

        """
        self.put(UINT32, np.shape(values)[0])
        return self.put(dtype, values)

    def put_string(self, text: str, place: str) -> None:
        """
        Append a string.

        Raises
        ------
        ValueError
            For a NUL in it, which would end it early. The message begins with `place`.

        """
        if '\0' in text:
            raise ValueError(f'{place}: must not contain a NUL, got {text!r}')
        self.put_sequence(UINT8, np.frombuffer(text.encode() + b'\0', UINT8))

    def finish(self) -> Message:
        """Return the message as laid out."""
        return Message(bytes(self._content))
