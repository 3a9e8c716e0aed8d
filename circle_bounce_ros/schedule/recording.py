"""The ticks of a recording: those of the node in clock mode, from its start on, undisturbed."""

from __future__ import annotations

import math
from collections.abc import Iterator

from circle_bounce_ros.schedule.schedules import ClockSchedule, Tick
from circle_bounce_ros.schedule.times import LAST_INSTANT, SECOND, exact_decimal

LARGEST_RATE = 1e6  # Hz
MOST_TICKS = 10**9  # half a day of the fastest scene


class RecordingTicks:
    """
    All ticks of a recording, in order.

    Parameters
    ----------
    rate : float, Hz
        Greater than 0, taken as the decimal number that it is written as.
    duration : float, s
        Long enough for one tick, less than 2**31 s and 10^9 ticks.
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
        most = (LAST_INSTANT + 1) // SECOND
        if not 0.0 < duration < most:
            raise ValueError(f'duration: must be > 0 and < {most} s, got {duration:g}')
        self._rate = rate
        self._restart_after = restart_after
        self._count = math.floor(exact_decimal(duration) * exact_decimal(rate))
        if not self._count:
            raise ValueError(
                f'duration: must be at least one period, {1.0 / rate:g} s, got {duration:g}'
            )
        if self._count > MOST_TICKS:
            raise ValueError(
                f'duration: must be at most {MOST_TICKS} ticks, got {duration:g} s at {rate:g} Hz'
            )

    def __len__(self) -> int:
        return self._count

    @property
    def duration(self) -> float:
        """The last stamp, s."""
        return float(self._count / exact_decimal(self._rate))

    def __iter__(self) -> Iterator[Tick]:
        # As fast as possible: a tick is due whenever somebody asks, whatever the steady clock reads.
        schedule = ClockSchedule(self._rate, time_scale=0.0)
        schedule.set_restart_after(self._restart_after)
        for _ in range(self._count):
            tick = schedule.begin(0)
            assert tick is not None
            yield tick
            schedule.came_to(tick.scene_ns)
