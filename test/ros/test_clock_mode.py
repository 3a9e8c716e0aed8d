"""With publish_clock the node is the time source."""

from __future__ import annotations

import time
from itertools import pairwise

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseArray
from observing import SECOND, nanoseconds, stamps
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import PointCloud2, TimeReference


def clock_times(messages):
    return [nanoseconds(message.clock) for message in messages]


def scene_ns(times):
    return [nanoseconds(message.time_ref) for message in times]


def test_tick_k_is_at_k_periods_on_the_clock_in_the_stamps_and_in_the_scene(
    start, observer, lesson
):
    clock = observer.listen(Clock, '/clock')
    times = observer.listen(TimeReference, 'time')
    start(scene=lesson, publish_clock='true', rate=60.0)
    observer.collect(times, 60)
    ticks = {k * SECOND // 60: k for k in range(1, 10_000)}
    assert set(clock_times(clock)) <= ticks.keys()
    assert stamps(times) == scene_ns(times)
    numbers = [ticks[stamp] for stamp in stamps(times)]
    assert numbers == list(range(numbers[0], numbers[-1] + 1))
    # A clock has to tell the time before anybody is told what happens at it.
    assert set(stamps(times)[5:-5]) <= set(clock_times(clock))


def test_nothing_is_said_at_time_zero(start, observer, lesson):
    everything = [
        observer.listen(Clock, '/clock'),
        observer.listen(TimeReference, 'time'),
        observer.listen(PoseArray, 'poses'),
        observer.listen(DiagnosticArray, '/diagnostics'),
    ]
    # So slow that a scene, a change and a report come before the first tick.
    start(scene=lesson, publish_clock='true', rate=0.5)
    observer.pause(False)
    assert observer.set(time_scale=1.5).successful
    observer.spin_until(lambda: all(everything), 'every topic')
    clock, times, poses, diagnostics = everything
    said = clock_times(clock) + stamps(times + poses + diagnostics)
    # Discovery may have missed the first tick, but nothing comes from before it.
    assert min(said) > 0
    assert {stamp % (2 * SECOND) for stamp in said} == {0}


def test_a_hundred_resets_under_load_succeed_and_every_stamp_is_one_period_later(
    start, observer, write_scene
):
    region = {'min': [0, 0], 'max': [10, 10]}
    crowd = {'count': 300, 'radius': 0.15, 'speed': 1.0, 'region': region}
    path = write_scene('crowd', groups=[crowd], walls=[{'box': region}])
    times = observer.listen(TimeReference, 'time')
    clock = observer.listen(Clock, '/clock')
    load = [
        observer.listen(PointCloud2, 'bodies'),
        observer.listen(PointCloud2, 'contacts'),
        observer.listen(PoseArray, 'poses'),
    ]
    start(scene=path, publish_clock='true', rate=50.0)
    observer.spin_until(lambda: times and clock and all(load), 'all topics')
    responses = []
    for _ in range(10):  # on a fast machine all hundred would come between two ticks
        responses += [observer.reset() for _ in range(10)]
        observer.collect(times, 5)
    assert [response.success for response in responses] == [True] * 100
    period = SECOND // 50
    assert {b - a for a, b in pairwise(stamps(times))} == {period}
    assert {b - a for a, b in pairwise(clock_times(clock))} == {period}
    assert scene_ns(times).count(0) >= 10
    for before, after in pairwise(scene_ns(times)):
        assert after in (0, before + period)


def test_time_scale_is_how_much_faster_than_the_wall_it_goes(start, observer, lesson):
    times = observer.listen(TimeReference, 'time')
    start(scene=lesson, publish_clock='true', rate=50.0, time_scale=4.0)
    observer.collect(times, 5)
    began, first = time.monotonic(), stamps(times)[-1]
    observer.collect(times, 200)
    speed = (stamps(times)[-1] - first) / SECOND / (time.monotonic() - began)
    assert speed == pytest.approx(4.0, rel=0.1)  # a late tick or two of 200
    assert {b - a for a, b in pairwise(stamps(times))} == {SECOND // 50}


def test_as_fast_as_possible_is_faster_and_answers(start, observer, lesson):
    diagnostics = observer.listen(DiagnosticArray, '/diagnostics')
    clock = observer.listen(Clock, '/clock', depth=1)
    start(scene=lesson, publish_clock='true', time_scale=0.0, rate=100.0)
    observer.spin_until(lambda: len(diagnostics) > 2, 'diagnostics')
    # Wall time passes, too; an ordinary machine makes thousands of ticks a second of it.
    speed = (stamps(diagnostics)[-1] - stamps(diagnostics)[-2]) / SECOND
    assert speed > 3.0
    assert clock_times(clock) == sorted(clock_times(clock))
    began = time.monotonic()
    assert observer.reset().success
    assert observer.pause().success
    assert time.monotonic() - began < 1.0
    # Paused, simulated time goes on, and so does the clock.
    observer.collect(clock, 10)
    # With time to breathe again nothing jumps.
    times = observer.listen(TimeReference, 'time')
    assert observer.set(time_scale=1.0).successful
    observer.collect(times, 20)
    assert {b - a for a, b in pairwise(stamps(times)[-15:])} == {SECOND // 100}


def test_a_change_of_rate_keeps_the_stamps_going(start, observer, lesson):
    times = observer.listen(TimeReference, 'time')
    start(scene=lesson, publish_clock='true', rate=50.0)
    for rate in (200.0, 30.0, 100.0):
        observer.collect(times, 10)
        assert observer.set(rate=rate).successful
    observer.collect(times, 20)
    steps = [b - a for a, b in pairwise(stamps(times))]
    assert steps == [b - a for a, b in pairwise(scene_ns(times))]
    assert set(steps) == {
        SECOND // 50,
        SECOND // 200,
        SECOND // 30,
        SECOND // 30 + 1,
        SECOND // 100,
    }


def test_use_sim_time_is_refused_later_too(start, observer, lesson):
    times = observer.listen(TimeReference, 'time')
    start(scene=lesson, publish_clock='true')
    result = observer.set(use_sim_time=True)
    assert not result.successful
    assert result.reason.startswith('publish_clock and use_sim_time: must not both be true')
    before = observer.collect(times, 3)[-1]
    assert stamps(observer.collect(times, 3))[0] > stamps([before])[0]
