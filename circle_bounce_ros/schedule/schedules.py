"""
Scene time, exact to the nanosecond: which instant of the scene each tick shows, and with which stamp.

Times are whole nanoseconds; what is left of one is carried as a fraction, so that nothing is ever lost or added.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from fractions import Fraction

from circle_bounce_ros.schedule.times import (
    LAST_INSTANT,
    SECOND,
    exact_decimal,
    instant_of,
    period_of,
)

# A tick never makes up more than this, so that a machine that was slow or asleep cannot start an avalanche.
MOST_MADE_UP = SECOND // 10  # ns


@dataclass(frozen=True)
class Tick:
    """
    What one tick shows.

    Attributes
    ----------
    stamp_ns : int, ns
        What all messages of the tick carry.
    scene_ns : int, ns
        The instant of the scene.
    went_back : bool
        The outside clock jumped back, so the scene starts again.

    """

    stamp_ns: int
    scene_ns: int
    went_back: bool = False


@dataclass
class Progress:
    """
    How far the scene came while it was not paused.

    Attributes
    ----------
    passed_ns : int, ns
        By the clock that drives the scene.
    advanced_ns : Fraction, ns
        By the scene.
    dropped_ns : Fraction, ns
        Scene time that was due and given up; in clock mode none ever is.

    """

    passed_ns: int = 0
    advanced_ns: Fraction = Fraction(0)
    dropped_ns: Fraction = Fraction(0)

    @property
    def real_time_factor(self) -> float:
        """Scene time by clock time; NaN while nothing has passed."""
        return float(self.advanced_ns / self.passed_ns) if self.passed_ns else math.nan

    def __add__(self, later: Progress) -> Progress:
        return Progress(
            self.passed_ns + later.passed_ns,
            self.advanced_ns + later.advanced_ns,
            self.dropped_ns + later.dropped_ns,
        )


class Schedule(ABC):
    """
    Where the scene is in its own time, and how it goes on.

    Nothing but a tick, a step and a restart moves it: to pause, go on or change a speed never does.

    Parameters
    ----------
    rate : float, Hz
        Ticks per second, greater than 0.
    time_scale : float
        How much faster than its clock the scene goes.
    paused : bool

    """

    def __init__(self, rate: float, time_scale: float, paused: bool = False) -> None:
        self.paused = paused
        self._period = period_of(rate)
        self._time_scale = exact_decimal(time_scale)
        self._position = Fraction(0)
        self._restart_at = LAST_INSTANT
        self._shows_first_instant = False
        self._progress = Progress()

    @property
    def scene_ns(self) -> int:
        """The instant of the scene, ns since its first."""
        return math.floor(self._position)

    @property
    def timer_period_ns(self) -> int:
        """How often, by a steady clock, to call `begin`, ns."""
        return math.floor(self._period)

    def set_rate(self, rate: float) -> None:
        """Change the rate; the scene stays where it is."""
        self._drop_fractions()
        self._period = period_of(rate)

    def set_time_scale(self, time_scale: float) -> None:
        """Change the speed from the next tick on; the scene stays where it is."""
        self._drop_fractions()
        self._time_scale = exact_decimal(time_scale)

    def set_restart_after(self, seconds: float) -> None:
        """Let the scene start again once it has shown this instant, `inf` for never (in 68 years)."""
        self._restart_at = instant_of(seconds)

    def restart(self) -> None:
        """Go back to the first instant of the scene, which the next tick shows."""
        self._position = Fraction(0)
        self._shows_first_instant = True

    def step(self) -> None:
        """Go on by exactly one period of scene time; at its end the scene starts again."""
        self._shows_first_instant = False
        self._move(self._period)

    def hold_at(self, scene_ns: int) -> None:
        """Pause at an instant before the one that is due, because the scene cannot go on."""
        self.paused = True
        self._progress.advanced_ns -= self._position - scene_ns
        self._position = Fraction(scene_ns)

    def take_progress(self) -> Progress:
        """Return the progress since the last call."""
        progress, self._progress = self._progress, Progress()
        return progress

    @abstractmethod
    def begin(self, reading_ns: int) -> Tick | None:
        """
        Return the tick to show when the clock reads this, None when there is none.

        To be called again until it returns None.
        """

    @abstractmethod
    def came_to(self, reached_ns: int) -> bool:
        """Say how far the simulation came in the time that it had; return whether to show that."""

    def _drop_fractions(self) -> None:
        # Fractions of different rates and speeds would otherwise grow for ever when added up.
        self._position = Fraction(self.scene_ns)

    def _goes_on(self) -> bool:
        """Return whether this tick moves the scene; the first instant after a restart is shown as it is."""
        first, self._shows_first_instant = self._shows_first_instant, False
        return not (first or self.paused)

    def _move(self, amount: Fraction) -> None:
        if self._position >= self._restart_at:
            self._position = Fraction(0)
        else:
            self._position = min(self._position + amount, Fraction(self._restart_at))


class WallSchedule(Schedule):
    """
    Wall mode: the scene goes on by what has passed on a clock, and stamps are that clock's readings.

    The clock may be an outside one (`outside = True`): it has not started while it reads 0, nothing
    is shown while it stands, and the scene starts again when it jumps back.
    """

    def __init__(self, rate: float, time_scale: float, paused: bool = False) -> None:
        super().__init__(rate, time_scale, paused)
        self._outside = False
        self._last_reading: int | None = None

    def follow(self, outside: bool) -> None:
        """Say which kind of clock the readings come from; a change of clock moves nothing."""
        if outside != self._outside:
            self._outside = outside
            self._last_reading = None

    def begin(self, reading_ns: int) -> Tick | None:
        """Return the tick for this reading; None when the clock has not moved, or not started."""
        if reading_ns == self._last_reading or (self._outside and reading_ns == 0):
            return None
        passed = 0 if self._last_reading is None else reading_ns - self._last_reading
        self._last_reading = reading_ns
        if passed < 0 and self._outside:
            self.restart()
        self._advance(max(passed, 0))
        return Tick(reading_ns, self.scene_ns, went_back=passed < 0 and self._outside)

    def _advance(self, passed: int) -> None:
        if not self._goes_on():
            return
        # At a slow rate the period itself is longer than what may be made up.
        made_up = min(passed, max(MOST_MADE_UP, math.ceil(2 * self._period)))
        self._move(made_up * self._time_scale)
        self._progress.passed_ns += passed
        self._progress.advanced_ns += made_up * self._time_scale
        self._progress.dropped_ns += (passed - made_up) * self._time_scale

    def came_to(self, reached_ns: int) -> bool:
        """Drop scene time that could not be reached, and show what was; only a step is worth the wait."""
        missing = self.scene_ns - reached_ns
        if self.paused:
            return missing <= 0
        if missing > 0:
            self._position = Fraction(reached_ns)
            self._progress.advanced_ns -= missing
            self._progress.dropped_ns += missing
        return True


class ClockSchedule(Schedule):
    """
    Clock mode: the node is the time source. Tick k has the stamp `k * 10**9 // rate`, from 1 on.

    The scene goes on by one period a tick; its time starts again with the scene, stamps never do. A steady
    clock says when ticks are due: `time_scale` times faster than that clock, 0 for as fast as
    possible.
    """

    def __init__(self, rate: float, time_scale: float, paused: bool = False) -> None:
        super().__init__(rate, time_scale, paused)
        self._stamp = Fraction(0)
        self._due: int | None = None
        self._last_opened: int | None = None
        self._open = False

    @property
    def stamp_ns(self) -> int:
        """The stamp of the last tick begun, ns; 0 before the first."""
        return math.floor(self._stamp)

    @property
    def timer_period_ns(self) -> int:
        """How often to call `begin`, ns; 0 for as often as possible."""
        return math.floor(self._period / self._time_scale) if self._time_scale else 0

    def set_rate(self, rate: float) -> None:
        """Change the rate; scene and stamps stay where they are."""
        super().set_rate(rate)
        self._due = None

    def set_time_scale(self, time_scale: float) -> None:
        """Change the speed from the next tick on; scene and stamps stay where they are."""
        super().set_time_scale(time_scale)
        self._due = None

    def restart(self) -> None:
        """Go back to the first instant of the scene, which the next tick shows, or the unfinished one."""
        super().restart()
        self._shows_first_instant = not self._open

    def begin(self, reading_ns: int) -> Tick | None:
        """Return the tick that is not finished, else the next one if it is due."""
        if not self._open:
            if not self._is_due(reading_ns):
                return None
            self._open_tick(reading_ns)
        return Tick(self.stamp_ns, self.scene_ns)

    def came_to(self, reached_ns: int) -> bool:
        """Show nothing before the tick is complete; it is begun again until it is."""
        self._open = reached_ns < self.scene_ns
        return not self._open

    def _is_due(self, reading_ns: int) -> bool:
        # Half a period early is in time: the timer that asks has the same period and any phase.
        return self._due is None or reading_ns >= self._due - self.timer_period_ns // 2

    def _open_tick(self, reading_ns: int) -> None:
        passed = 0 if self._last_opened is None else reading_ns - self._last_opened
        self._last_opened = reading_ns
        due = reading_ns if self._due is None else self._due
        # What is not made up is no loss: nobody but the wall notices that simulated time was slow.
        self._due = max(due, reading_ns - MOST_MADE_UP) + self.timer_period_ns
        self._stamp += self._period
        self._open = True
        if not self._goes_on():
            return
        self._move(self._period)
        self._progress.passed_ns += passed
        self._progress.advanced_ns += self._period

    def _drop_fractions(self) -> None:
        super()._drop_fractions()
        self._stamp = Fraction(self.stamp_ns)
