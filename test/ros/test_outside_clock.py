"""With use_sim_time the node follows a clock that somebody else publishes."""

from __future__ import annotations

import pytest
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from observing import SECOND, nanoseconds, stamps
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import TimeReference


class OutsideClock:
    """A /clock in the hands of the test."""

    def __init__(self, observer):
        self._observer = observer
        self._publisher = observer.node.create_publisher(Clock, '/clock', 10)
        self._times = observer.listen(TimeReference, 'time')

    def show(self, now_ns):
        """Set the clock and return the scene time that the node answers with, ns."""
        message = Clock(clock=Time(sec=now_ns // SECOND, nanosec=now_ns % SECOND))

        def answer():
            # /clock is best effort; to say the same time again does not move it.
            self._publisher.publish(message)
            return [m for m in self._times[-1:] if nanoseconds(m.header.stamp) == now_ns]

        answers = self._observer.spin_until(answer, f'a tick at {now_ns} ns')
        return nanoseconds(answers[0].time_ref)


@pytest.fixture
def outside(observer):
    return OutsideClock(observer)


def test_the_scene_follows_the_clock_and_stands_when_it_stands(start, observer, lesson, outside):
    poses = observer.listen(PoseStamped, 'green/pose')
    start(scene=lesson, use_sim_time='true', rate=200.0)
    observer.spin_for(0.3)
    assert not poses  # nobody has told the time yet
    assert outside.show(100 * SECOND) == 0
    assert outside.show(100 * SECOND + 1) == 1
    assert outside.show(100 * SECOND + 50_000_001) == 50_000_001
    observer.spin_until(lambda: len(poses) == 3, 'a pose for each')
    observer.spin_for(0.3)
    assert len(poses) == 3
    observer.set(time_scale=0.5)
    assert outside.show(100 * SECOND + 50_000_101) == 50_000_051
    observer.pause()
    assert outside.show(100 * SECOND + 60_000_000) == 50_000_051
    observer.spin_until(lambda: stamps(poses)[-1] == 100 * SECOND + 60_000_000, 'its pose')


def test_a_jump_ahead_by_an_hour_is_made_up_by_a_tenth_of_a_second(
    start, observer, lesson, outside
):
    diagnostics = observer.listen(DiagnosticArray, '/diagnostics')
    start(scene=lesson, use_sim_time='true', rate=200.0)
    now = 1000 * SECOND
    assert outside.show(now) == 0
    assert outside.show(now + 3600 * SECOND) == SECOND // 10
    assert outside.show(now + 3600 * SECOND + 5) == SECOND // 10 + 5
    warnings = observer.spin_until(
        lambda: [m for m in diagnostics if 'dropped' in m.status[0].message], 'a warning'
    )
    assert warnings[0].status[0].level == DiagnosticStatus.WARN
    values = {value.key: value.value for value in warnings[0].status[0].values}
    assert values['dropped scene time (s)'] == '3599.900'
    observer.spin_until(
        lambda: diagnostics[-1].status[0].level == DiagnosticStatus.OK, 'that the warning ends'
    )


def test_a_jump_back_restarts_the_scene_and_the_log_says_so(start, observer, lesson, outside):
    node = start(scene=lesson, use_sim_time='true', rate=200.0)
    outside.show(1000 * SECOND)
    assert outside.show(1000 * SECOND + 70_000_000) == 70_000_000
    assert outside.show(10 * SECOND) == 0
    assert outside.show(10 * SECOND + 30_000_000) == 30_000_000
    assert node.log.count('the clock jumped back: the scene starts again') == 1


def test_diagnostics_say_that_no_time_has_come_yet(start, observer, lesson):
    diagnostics = observer.listen(DiagnosticArray, '/diagnostics')
    start(scene=lesson, use_sim_time='true')
    observer.spin_until(lambda: diagnostics, 'diagnostics')
    assert diagnostics[0].status[0].level == DiagnosticStatus.WARN
    assert diagnostics[0].status[0].message.startswith('waiting for /clock')


def test_the_clock_may_be_changed_at_run_time_and_the_scene_does_not_jump(
    start, observer, lesson, outside
):
    times = observer.listen(TimeReference, 'time')
    node = start(scene=lesson)
    observer.collect(times, 10)
    assert observer.set(use_sim_time=True).successful
    observer.spin_for(0.2)
    last = nanoseconds(times[-1].time_ref)
    assert outside.show(5 * SECOND) == last
    assert outside.show(5 * SECOND + 1000) == last + 1000
    assert observer.set(use_sim_time=False).successful
    observer.collect(times, 3)
    assert last + 1000 <= nanoseconds(times[-1].time_ref) < last + SECOND
    assert 'jumped back' not in node.log
