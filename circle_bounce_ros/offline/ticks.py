"""
The instants that a recording shows: those of the node in clock mode, from its start on, undisturbed.

Tick k has the stamp `k * 10**9 // rate`, from 1 on. Scene time goes along with it; where a scene says
`restart_after`, it stops there for one tick and then starts again, while stamps go on.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple

from circle_bounce_ros.encoding.stamps import END_OF_TIME, SECOND

LARGEST_RATE = 1e6  # Hz


class Tick(NamedTuple):
    """
    What one tick shows.

    Attributes
    ----------
    stamp_ns : int, ns
        By a clock that never runs backwards.
    scene_ns : int, ns
        The instant of the scene.

    """

    stamp_ns: int
    scene_ns: int


class Ticks:
    """
    All ticks of a recording, in order.

    Parameters
    ----------
    rate : float, Hz
        Greater than 0, taken as the decimal number that it is written as.
    duration : float, s
        Long enough for one tick, less than 2**31 s.
    restart_after : float, s
        As in a scene; `inf` for never.

    Raises
    ------
    ValueError
        For a rate or a duration out of range.

    """

    def __init__(self, rate: float, duration: float, restart_after: float = math.inf) -> None:
        if not 0.0 < rate <= LARGEST_RATE:
            raise ValueError(f'rate: must be > 0 and at most {LARGEST_RATE:g} Hz, got {rate:g}')
        if not 0.0 < duration < END_OF_TIME // SECOND:
            most = END_OF_TIME // SECOND
            raise ValueError(f'duration: must be > 0 and < {most} s, got {duration:g}')
        self._period = SECOND / as_written(rate)
        self._count = math.floor(as_written(duration) * as_written(rate))
        if not self._count:
            raise ValueError(
                f'duration: must be at least one period, {1.0 / rate:g} s, got {duration:g}'
            )
        self._restart_at = END_OF_TIME - 1
        if restart_after < self._restart_at / SECOND:
            self._restart_at = max(1, round(as_written(restart_after) * SECOND))

    def __len__(self) -> int:
        return self._count

    @property
    def duration(self) -> float:
        """The last stamp, s."""
        return float(self._count * self._period / SECOND)

    def __iter__(self) -> Iterator[Tick]:
        position = Fraction(0)
        for k in range(1, self._count + 1):
            if position >= self._restart_at:
                position = Fraction(0)
            else:
                position = min(position + self._period, Fraction(self._restart_at))
            yield Tick(math.floor(k * self._period), math.floor(position))


def as_written(value: float) -> Fraction:
    """Return the decimal number that somebody wrote, exactly: a rate of 0.1 Hz has a period of 10 s."""
    return Fraction(repr(float(value)))
