"""How the node is doing, on /diagnostics: once a second, and at once when something changes."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import NamedTuple

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

from circle_bounce_ros.encoding.topics import Topic
from circle_bounce_ros.ros.publishers import create_publisher
from circle_bounce_ros.ros.runner import Runner
from circle_bounce_ros.schedule.schedules import Progress
from circle_bounce_ros.schedule.times import SECOND

DIAGNOSTICS = Topic('/diagnostics', 'diagnostic_msgs/msg/DiagnosticArray')

# The real-time factor may be as low as this part of what was asked.
ENOUGH = 0.9

# Measured over less, a real-time factor says more about one tick than about the machine.
LEAST_TIME = SECOND // 2  # ns
LEAST_TICKS = 10

# A tick is late when it comes after so many periods.
LATE = 1.5


class Facts(NamedTuple):
    """
    What the node has been told; a change is reported at once.

    Attributes
    ----------
    paused : bool
    scene : str
    seed : int or None
    time_scale : float
    waits_for_clock : bool
        It follows an outside clock that has not been heard yet.
    failure : str
        Why the simulation cannot go on; empty when it can.

    """

    paused: bool
    scene: str
    seed: int | None
    time_scale: float
    waits_for_clock: bool
    failure: str


class Diagnostics:
    """
    The status of the node.

    Parameters
    ----------
    node : Node
    steady_ns : int, ns
        What a steady clock reads now.

    """

    def __init__(self, node: Node, steady_ns: int) -> None:
        self._publisher = create_publisher(node, DIAGNOSTICS)
        self._name = f'{node.get_fully_qualified_name()}: simulation'
        self._reported: tuple[Facts, str] | None = None
        self._real_time_factor = math.nan
        self._progress = Progress()
        self._dropped_before = Fraction(0)  # in the last second that has been measured, ns
        self._dropped = Fraction(0)  # since then, ns
        self._late_ticks = 0
        self._last_tick: int | None = None
        self._period_ns = 0
        self._contacts_per_second = 0.0
        self._contacts_then = (steady_ns, 0)

    def add_tick(self, steady_ns: int, period_ns: int, progress: Progress) -> None:
        """
        Take note of a tick.

        Parameters
        ----------
        steady_ns : int, ns
            When it began, by a steady clock.
        period_ns : int, ns
            How long after the one before it was due; 0 for as soon as possible.
        progress : Progress
            What the scene has done since then.

        """
        if self._last_tick is not None and 0 < LATE * period_ns < steady_ns - self._last_tick:
            self._late_ticks += 1
        self._last_tick = steady_ns
        self._period_ns = period_ns
        self._progress += progress
        self._dropped += progress.dropped_ns

    def end_second(self, steady_ns: int, contact_count: int) -> None:
        """Measure what has happened since the last call, about a second ago."""
        then, count = self._contacts_then
        self._contacts_then = (steady_ns, contact_count)
        self._contacts_per_second = (contact_count - count) * SECOND / (steady_ns - then)
        self._dropped_before, self._dropped = self._dropped, Fraction(0)
        if self._progress.passed_ns >= max(LEAST_TIME, LEAST_TICKS * self._period_ns):
            self._real_time_factor = self._progress.real_time_factor
            self._progress = Progress()
        elif self._progress.passed_ns == 0 and self._period_ns < SECOND:
            # A clock that stands says nothing about the machine.
            self._real_time_factor = math.nan

    def report_change(self, stamp_ns: int, facts: Facts, runner: Runner) -> None:
        """Report if the facts, or how well it goes, are others than reported last."""
        if self._reported is not None and facts != self._reported[0]:
            # What was measured belongs to other circumstances.
            self._real_time_factor = math.nan
            self._progress = Progress()
        if (facts, self._problem(facts)) != self._reported:
            self.report(stamp_ns, facts, runner)

    def report(self, stamp_ns: int, facts: Facts, runner: Runner) -> None:
        """Publish the status."""
        problem = self._problem(facts)
        self._reported = (facts, problem)
        if not self._publisher.get_subscription_count():
            return
        message = DiagnosticArray()
        seconds, nanoseconds = divmod(stamp_ns, SECOND)
        message.header.stamp = Time(sec=seconds, nanosec=nanoseconds)
        status = DiagnosticStatus(name=self._name, hardware_id='')
        status.level = DiagnosticStatus.WARN if problem else DiagnosticStatus.OK
        if facts.failure:
            status.level = DiagnosticStatus.ERROR
        status.message = problem or ('paused' if facts.paused else 'running')
        status.values = [
            KeyValue(key=key, value=value) for key, value in self._values(facts, runner).items()
        ]
        message.status = [status]
        self._publisher.publish(message)

    def _problem(self, facts: Facts) -> str:
        """Return what is wrong, in words that stay the same while it is; empty when all is well."""
        if facts.failure:
            return facts.failure
        if facts.waits_for_clock:
            return 'waiting for /clock: use_sim_time is true and no time has come yet'
        if self._dropped + self._dropped_before > 0:
            return 'scene time was dropped: the machine is too slow, or the clock jumped'
        if not facts.paused and self._real_time_factor < ENOUGH * facts.time_scale:
            return f'the real-time factor is below {ENOUGH} of time_scale: the machine is too slow'
        return ''

    def _values(self, facts: Facts, runner: Runner) -> dict[str, str]:
        factor = 0.0 if facts.paused else self._real_time_factor
        dropped = (self._dropped + self._dropped_before) / SECOND
        return {
            'real-time factor': f'{factor:.3f}',
            'late ticks': str(self._late_ticks),
            'dropped scene time (s)': f'{float(dropped):.3f}',
            'contacts/s': f'{self._contacts_per_second:.1f}',
            'energy error': f'{runner.energy_error:.3g}',
            'paused': str(facts.paused).lower(),
            'scene': facts.scene,
            'seed': 'none' if facts.seed is None else str(facts.seed),
            'time_scale': str(facts.time_scale),
        }
