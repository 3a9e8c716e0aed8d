"""Scene time without ROS: what each tick shows, to the nanosecond."""

from __future__ import annotations

import math
import random
from itertools import pairwise

import pytest

from circle_bounce_ros.ros.timeline import (
    LAST_INSTANT,
    MOST_MADE_UP,
    SECOND,
    ClockTimeline,
    WallTimeline,
)

NOON = 1_700_000_000 * SECOND  # some reading of a wall clock


def started(rate=60.0, time_scale=1.0, paused=False, at=NOON):
    timeline = WallTimeline(rate, time_scale, paused)
    timeline.begin(at)
    return timeline


def show(timeline, reading):
    """Show the next tick as a simulation does that is fast enough."""
    tick = timeline.begin(reading)
    assert timeline.came_to(tick.scene_ns)
    return tick


def show_ticks(timeline, count, reading=NOON):
    """Show ticks when they are due, and return them."""
    ticks = []
    for k in range(count):
        ticks.append(show(timeline, reading + k * timeline.timer_period_ns))
    return ticks


# Wall mode


def test_the_first_tick_shows_the_first_instant_and_the_stamp_is_the_reading():
    tick = WallTimeline(60.0, 1.0).begin(NOON)
    assert (tick.stamp_ns, tick.scene_ns) == (NOON, 0)


def test_scene_time_is_what_has_passed_whatever_the_jitter():
    randoms = random.Random(1)
    timeline = started()
    reading = NOON
    for _ in range(1000):
        reading += randoms.randrange(1, MOST_MADE_UP)
        tick = show(timeline, reading)
        assert (tick.stamp_ns, tick.scene_ns) == (reading, reading - NOON)


@pytest.mark.parametrize(
    ('time_scale', 'tenths'), [(0.1, 1), (0.7, 7), (7.3, 73), (1000.0, 10000)]
)
def test_fractions_of_a_nanosecond_are_carried_and_not_lost(time_scale, tenths):
    timeline = started(time_scale=time_scale)
    for k in range(1, 30_002):
        tick = show(timeline, NOON + k * 1001)
    assert tick.scene_ns == 30_001 * 1001 * tenths // 10


def test_a_tick_makes_up_a_tenth_of_a_second_and_the_rest_is_dropped_and_counted():
    timeline = started(time_scale=2.0)
    tick = show(timeline, NOON + 3600 * SECOND)
    assert tick.scene_ns == 2 * MOST_MADE_UP
    progress = timeline.take_progress()
    assert progress.dropped_ns == 2 * (3600 * SECOND - MOST_MADE_UP)
    assert progress.real_time_factor == pytest.approx(0.2 / 3600)
    assert show(timeline, NOON + 3600 * SECOND + 1).scene_ns == 2 * MOST_MADE_UP + 2


def test_a_slow_rate_drops_nothing():
    timeline = started(rate=0.1)
    tick = show(timeline, NOON + 10 * SECOND + 5_000_000)
    assert tick.scene_ns == 10 * SECOND + 5_000_000
    assert timeline.take_progress().dropped_ns == 0


def test_what_a_slow_simulation_did_not_reach_is_dropped():
    timeline = started()
    timeline.begin(NOON + 50_000_000)
    assert timeline.came_to(20_000_000)
    assert timeline.scene_ns == 20_000_000
    progress = timeline.take_progress()
    assert progress.dropped_ns == 30_000_000
    assert progress.real_time_factor == pytest.approx(0.4)
    assert show(timeline, NOON + 51_000_000).scene_ns == 21_000_000


def test_a_step_is_waited_for_however_slow_the_simulation():
    timeline = started(rate=50.0, paused=True)
    timeline.step()
    timeline.begin(NOON + 1)
    assert not timeline.came_to(5_000_000)
    assert timeline.begin(NOON + 2).scene_ns == 20_000_000
    assert timeline.came_to(20_000_000)


def test_a_wall_clock_that_is_set_back_stops_the_scene_for_a_tick_only():
    timeline = started()
    show(timeline, NOON + 1000)
    tick = show(timeline, NOON - SECOND)
    assert (tick.stamp_ns, tick.scene_ns, tick.went_back) == (NOON - SECOND, 1000, False)
    assert show(timeline, NOON - SECOND + 7).scene_ns == 1007


# An outside clock


def outside(at=NOON):
    timeline = WallTimeline(60.0, 1.0)
    timeline.follow(outside=True)
    timeline.begin(at)
    return timeline


def test_a_clock_that_has_not_started_or_stands_shows_nothing():
    timeline = outside(at=0)
    assert timeline.begin(0) is None
    assert timeline.begin(5 * SECOND).scene_ns == 0
    assert timeline.begin(5 * SECOND) is None
    assert timeline.begin(5 * SECOND + 1).scene_ns == 1


def test_a_clock_that_jumps_back_restarts_the_scene():
    timeline = outside()
    show(timeline, NOON + 1000)
    tick = show(timeline, NOON + 999)
    assert (tick.stamp_ns, tick.scene_ns, tick.went_back) == (NOON + 999, 0, True)
    tick = show(timeline, NOON + 1004)
    assert (tick.scene_ns, tick.went_back) == (5, False)


def test_a_change_of_clock_moves_nothing():
    timeline = started()
    show(timeline, NOON + 1000)
    timeline.follow(outside=True)
    assert timeline.begin(0) is None
    assert show(timeline, 77).scene_ns == 1000
    timeline.follow(outside=False)
    tick = show(timeline, NOON + SECOND)
    assert (tick.scene_ns, tick.went_back) == (1000, False)


# Clock mode


@pytest.mark.parametrize('rate', [60.0, 50.0, 0.1, 0.3, 29.97, 1000.0])
def test_tick_k_is_k_seconds_by_rate_to_the_nanosecond(rate):
    hundredths = round(rate * 100)
    timeline = ClockTimeline(rate, 1.0)
    for k, tick in enumerate(show_ticks(timeline, 1000), start=1):
        assert tick.stamp_ns == tick.scene_ns == k * SECOND * 100 // hundredths


def test_nothing_is_said_at_zero_and_before_a_tick_is_due():
    timeline = ClockTimeline(50.0, 1.0)
    assert show(timeline, NOON).stamp_ns == 20_000_000
    assert timeline.begin(NOON) is None
    assert timeline.begin(NOON + 9_999_999) is None
    assert timeline.begin(NOON + 10_000_000).stamp_ns == 40_000_000


def test_a_reset_restarts_the_scene_and_not_the_stamps():
    timeline = ClockTimeline(60.0, 1.0)
    show_ticks(timeline, 10)
    timeline.restart()
    ticks = show_ticks(timeline, 4, NOON + SECOND)
    assert [tick.stamp_ns for tick in ticks] == [k * SECOND // 60 for k in range(11, 15)]
    assert [tick.scene_ns for tick in ticks] == [j * SECOND // 60 for j in range(4)]


def test_a_tick_that_is_not_finished_goes_on_and_its_stamp_stays():
    timeline = ClockTimeline(50.0, 1.0)
    tick = timeline.begin(NOON)
    assert not timeline.came_to(tick.scene_ns - 1)
    assert timeline.begin(NOON + 5 * SECOND) == tick
    assert timeline.came_to(tick.scene_ns)
    assert timeline.begin(NOON + 5 * SECOND).stamp_ns == 40_000_000


def test_a_reset_within_an_unfinished_tick_shows_the_first_instant_with_its_stamp():
    timeline = ClockTimeline(50.0, 1.0)
    show(timeline, NOON)
    timeline.begin(NOON + SECOND)
    timeline.came_to(0)
    timeline.restart()
    tick = show(timeline, NOON + SECOND)
    assert (tick.stamp_ns, tick.scene_ns) == (40_000_000, 0)
    tick = show(timeline, NOON + SECOND)
    assert (tick.stamp_ns, tick.scene_ns) == (60_000_000, 20_000_000)


def test_late_ticks_are_made_up_but_no_more_than_a_tenth_of_a_second_of_them():
    timeline = ClockTimeline(50.0, 1.0)
    show(timeline, NOON)
    late = NOON + 20_000_000 + 60_000_000
    assert [show(timeline, late).stamp_ns // 20_000_000 for _ in range(4)] == [2, 3, 4, 5]
    assert timeline.begin(late) is None
    assert timeline.take_progress().dropped_ns == 0
    late += 3600 * SECOND
    count = 0
    while timeline.begin(late) is not None:
        timeline.came_to(timeline.scene_ns)
        count += 1
    assert count == 6  # five periods are a tenth of a second, and the one that is due now
    progress = timeline.take_progress()
    assert progress.real_time_factor == pytest.approx(6 * 0.02 / 3600, rel=1e-3)
    assert progress.dropped_ns == 0  # simulated time was slow, and is whole


def test_time_scale_says_when_ticks_are_due_and_not_what_they_show():
    timeline = ClockTimeline(50.0, 4.0)
    assert timeline.timer_period_ns == 5_000_000
    assert [tick.scene_ns for tick in show_ticks(timeline, 3)] == [
        20_000_000,
        40_000_000,
        60_000_000,
    ]


def test_as_fast_as_possible_is_always_due():
    timeline = ClockTimeline(50.0, 0.0)
    assert timeline.timer_period_ns == 0
    assert [show(timeline, NOON).stamp_ns for _ in range(3)] == [
        20_000_000,
        40_000_000,
        60_000_000,
    ]


# Both modes


@pytest.fixture(params=[WallTimeline, ClockTimeline])
def kind(request):
    return request.param


def test_pause_keeps_the_scene_and_lets_ticks_and_stamps_go_on(kind):
    timeline = kind(50.0, 1.0)
    before = show_ticks(timeline, 5)[-1]
    timeline.paused = True
    ticks = show_ticks(timeline, 100, NOON + SECOND)
    assert {tick.scene_ns for tick in ticks} == {before.scene_ns}
    assert all(a.stamp_ns < b.stamp_ns for a, b in pairwise([before, *ticks]))
    timeline.paused = False
    after = show(timeline, NOON + 3 * SECOND)
    assert after.scene_ns == before.scene_ns + 20_000_000


def test_a_pause_is_neither_progress_nor_dropped(kind):
    timeline = kind(50.0, 1.0, paused=True)
    show(timeline, NOON)
    show(timeline, NOON + 3600 * SECOND)
    progress = timeline.take_progress()
    assert (progress.passed_ns, progress.advanced_ns, progress.dropped_ns) == (0, 0, 0)
    assert math.isnan(progress.real_time_factor)


def test_steps_are_exactly_one_period_each(kind):
    timeline = kind(60.0, 2.0, paused=True)
    show(timeline, NOON)
    for k in range(1, 61):
        timeline.step()
        assert show(timeline, NOON + k * SECOND).scene_ns == k * SECOND // 60


def test_a_step_right_after_a_reset_is_a_step(kind):
    timeline = kind(50.0, 1.0, paused=True)
    show(timeline, NOON)
    timeline.restart()
    timeline.step()
    assert show(timeline, NOON + SECOND).scene_ns == 20_000_000
    timeline.restart()
    assert show(timeline, NOON + 2 * SECOND).scene_ns == 0
    timeline.step()
    assert show(timeline, NOON + 3 * SECOND).scene_ns == 20_000_000


def test_a_reset_keeps_a_pause(kind):
    timeline = kind(50.0, 1.0)
    show_ticks(timeline, 5)
    timeline.paused = True
    timeline.restart()
    assert [tick.scene_ns for tick in show_ticks(timeline, 5, NOON + SECOND)] == [0] * 5


def test_no_change_of_rate_or_speed_moves_the_scene_or_the_stamps(kind):
    randoms = random.Random(2)
    timeline = kind(60.0, 1.0)
    reading, last = NOON, show(timeline, NOON)
    for _ in range(300):
        timeline.set_rate(randoms.uniform(20.0, 1000.0))
        timeline.set_time_scale(randoms.uniform(0.1, 100.0))
        assert timeline.scene_ns == last.scene_ns
        reading += 10_000_000
        tick = show(timeline, reading)
        # One period or what has passed at the new speed, with the fraction that both may round up.
        if kind is ClockTimeline:
            most = most_stamp = timeline._period + 1
        else:
            most, most_stamp = 10_000_000 * timeline._time_scale + 1, 10_000_000
        assert 0 < tick.scene_ns - last.scene_ns <= most
        assert 0 < tick.stamp_ns - last.stamp_ns <= most_stamp
        last = tick


def test_the_fractions_stay_small_however_often_the_speed_changes(kind):
    randoms = random.Random(3)
    timeline = kind(60.0, 1.0)
    for k in range(500):
        timeline.set_rate(randoms.uniform(1.0, 1000.0))
        timeline.set_time_scale(randoms.uniform(0.1, 100.0))
        show(timeline, NOON + k * SECOND)
    # A rate and a time_scale have at most 17 digits each, with a few zeros before them.
    assert timeline._position.denominator < 10**40


def test_a_scene_that_restarts_shows_its_last_instant_and_then_its_first(kind):
    timeline = kind(50.0, 1.0)
    timeline.set_restart_after(0.05)
    shown = [tick.scene_ns // 1_000_000 for tick in show_ticks(timeline, 9)]
    from_first = [0, 20, 40, 50, 0, 20, 40, 50, 0, 20]
    assert shown == (from_first[:9] if kind is WallTimeline else from_first[1:])
    assert timeline.take_progress().dropped_ns == 0


def test_scene_time_never_leaves_what_a_message_can_say(kind):
    timeline = kind(0.1, 1000.0)
    timeline.set_restart_after(math.inf)
    timeline._position += LAST_INSTANT - 1
    show(timeline, NOON)
    assert show(timeline, NOON + 10 * SECOND).scene_ns in (LAST_INSTANT, 0)
    assert LAST_INSTANT // SECOND < 2**31
