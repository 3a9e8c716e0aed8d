"""Scene time without ROS: what each tick shows, to the nanosecond."""

from __future__ import annotations

import math
import random
from itertools import pairwise

import pytest

from circle_bounce_ros.schedule.schedules import MOST_MADE_UP, ClockSchedule, WallSchedule
from circle_bounce_ros.schedule.times import LAST_INSTANT, SECOND

NOON = 1_700_000_000 * SECOND  # some reading of a wall clock


def started(rate=60.0, time_scale=1.0, paused=False, at=NOON):
    schedule = WallSchedule(rate, time_scale, paused)
    schedule.begin(at)
    return schedule


def show(schedule, reading):
    """Show the next tick as a simulation does that is fast enough."""
    tick = schedule.begin(reading)
    assert schedule.came_to(tick.scene_ns)
    return tick


def show_ticks(schedule, count, reading=NOON):
    """Show ticks when they are due, and return them."""
    ticks = []
    for k in range(count):
        ticks.append(show(schedule, reading + k * schedule.timer_period_ns))
    return ticks


# Wall mode


def test_the_first_tick_shows_the_first_instant_and_the_stamp_is_the_reading():
    tick = WallSchedule(60.0, 1.0).begin(NOON)
    assert (tick.stamp_ns, tick.scene_ns) == (NOON, 0)


def test_scene_time_is_what_has_passed_whatever_the_jitter():
    randoms = random.Random(1)
    schedule = started()
    reading = NOON
    for _ in range(1000):
        reading += randoms.randrange(1, MOST_MADE_UP)
        tick = show(schedule, reading)
        assert (tick.stamp_ns, tick.scene_ns) == (reading, reading - NOON)


@pytest.mark.parametrize(
    ('time_scale', 'tenths'), [(0.1, 1), (0.7, 7), (7.3, 73), (1000.0, 10000)]
)
def test_fractions_of_a_nanosecond_are_carried_and_not_lost(time_scale, tenths):
    schedule = started(time_scale=time_scale)
    for k in range(1, 30_002):
        tick = show(schedule, NOON + k * 1001)
    assert tick.scene_ns == 30_001 * 1001 * tenths // 10


def test_a_tick_makes_up_a_tenth_of_a_second_and_the_rest_is_dropped_and_counted():
    schedule = started(time_scale=2.0)
    tick = show(schedule, NOON + 3600 * SECOND)
    assert tick.scene_ns == 2 * MOST_MADE_UP
    progress = schedule.take_progress()
    assert progress.dropped_ns == 2 * (3600 * SECOND - MOST_MADE_UP)
    assert progress.real_time_factor == pytest.approx(0.2 / 3600)
    assert show(schedule, NOON + 3600 * SECOND + 1).scene_ns == 2 * MOST_MADE_UP + 2


def test_a_slow_rate_drops_nothing():
    schedule = started(rate=0.1)
    tick = show(schedule, NOON + 10 * SECOND + 5_000_000)
    assert tick.scene_ns == 10 * SECOND + 5_000_000
    assert schedule.take_progress().dropped_ns == 0


def test_what_a_slow_simulation_did_not_reach_is_dropped():
    schedule = started()
    schedule.begin(NOON + 50_000_000)
    assert schedule.came_to(20_000_000)
    assert schedule.scene_ns == 20_000_000
    progress = schedule.take_progress()
    assert progress.dropped_ns == 30_000_000
    assert progress.real_time_factor == pytest.approx(0.4)
    assert show(schedule, NOON + 51_000_000).scene_ns == 21_000_000


def test_a_step_is_waited_for_however_slow_the_simulation():
    schedule = started(rate=50.0, paused=True)
    schedule.step()
    schedule.begin(NOON + 1)
    assert not schedule.came_to(5_000_000)
    assert schedule.begin(NOON + 2).scene_ns == 20_000_000
    assert schedule.came_to(20_000_000)


def test_a_wall_clock_that_is_set_back_stops_the_scene_for_a_tick_only():
    schedule = started()
    show(schedule, NOON + 1000)
    tick = show(schedule, NOON - SECOND)
    assert (tick.stamp_ns, tick.scene_ns, tick.went_back) == (NOON - SECOND, 1000, False)
    assert show(schedule, NOON - SECOND + 7).scene_ns == 1007


# An outside clock


def outside(at=NOON):
    schedule = WallSchedule(60.0, 1.0)
    schedule.follow(outside=True)
    schedule.begin(at)
    return schedule


def test_a_clock_that_has_not_started_or_stands_shows_nothing():
    schedule = outside(at=0)
    assert schedule.begin(0) is None
    assert schedule.begin(5 * SECOND).scene_ns == 0
    assert schedule.begin(5 * SECOND) is None
    assert schedule.begin(5 * SECOND + 1).scene_ns == 1


def test_a_clock_that_jumps_back_restarts_the_scene():
    schedule = outside()
    show(schedule, NOON + 1000)
    tick = show(schedule, NOON + 999)
    assert (tick.stamp_ns, tick.scene_ns, tick.went_back) == (NOON + 999, 0, True)
    tick = show(schedule, NOON + 1004)
    assert (tick.scene_ns, tick.went_back) == (5, False)


def test_a_change_of_clock_moves_nothing():
    schedule = started()
    show(schedule, NOON + 1000)
    schedule.follow(outside=True)
    assert schedule.begin(0) is None
    assert show(schedule, 77).scene_ns == 1000
    schedule.follow(outside=False)
    tick = show(schedule, NOON + SECOND)
    assert (tick.scene_ns, tick.went_back) == (1000, False)


# Clock mode


@pytest.mark.parametrize('rate', [60.0, 50.0, 0.1, 0.3, 29.97, 1000.0])
def test_tick_k_is_k_seconds_by_rate_to_the_nanosecond(rate):
    hundredths = round(rate * 100)
    schedule = ClockSchedule(rate, 1.0)
    for k, tick in enumerate(show_ticks(schedule, 1000), start=1):
        assert tick.stamp_ns == tick.scene_ns == k * SECOND * 100 // hundredths


def test_nothing_is_said_at_zero_and_before_a_tick_is_due():
    schedule = ClockSchedule(50.0, 1.0)
    assert show(schedule, NOON).stamp_ns == 20_000_000
    assert schedule.begin(NOON) is None
    assert schedule.begin(NOON + 9_999_999) is None
    assert schedule.begin(NOON + 10_000_000).stamp_ns == 40_000_000


def test_a_reset_restarts_the_scene_and_not_the_stamps():
    schedule = ClockSchedule(60.0, 1.0)
    show_ticks(schedule, 10)
    schedule.restart()
    ticks = show_ticks(schedule, 4, NOON + SECOND)
    assert [tick.stamp_ns for tick in ticks] == [k * SECOND // 60 for k in range(11, 15)]
    assert [tick.scene_ns for tick in ticks] == [j * SECOND // 60 for j in range(4)]


def test_a_tick_that_is_not_finished_goes_on_and_its_stamp_stays():
    schedule = ClockSchedule(50.0, 1.0)
    tick = schedule.begin(NOON)
    assert not schedule.came_to(tick.scene_ns - 1)
    assert schedule.begin(NOON + 5 * SECOND) == tick
    assert schedule.came_to(tick.scene_ns)
    assert schedule.begin(NOON + 5 * SECOND).stamp_ns == 40_000_000


def test_a_reset_within_an_unfinished_tick_shows_the_first_instant_with_its_stamp():
    schedule = ClockSchedule(50.0, 1.0)
    show(schedule, NOON)
    schedule.begin(NOON + SECOND)
    schedule.came_to(0)
    schedule.restart()
    tick = show(schedule, NOON + SECOND)
    assert (tick.stamp_ns, tick.scene_ns) == (40_000_000, 0)
    tick = show(schedule, NOON + SECOND)
    assert (tick.stamp_ns, tick.scene_ns) == (60_000_000, 20_000_000)


def test_late_ticks_are_made_up_but_no_more_than_a_tenth_of_a_second_of_them():
    schedule = ClockSchedule(50.0, 1.0)
    show(schedule, NOON)
    late = NOON + 20_000_000 + 60_000_000
    assert [show(schedule, late).stamp_ns // 20_000_000 for _ in range(4)] == [2, 3, 4, 5]
    assert schedule.begin(late) is None
    assert schedule.take_progress().dropped_ns == 0
    late += 3600 * SECOND
    count = 0
    while schedule.begin(late) is not None:
        schedule.came_to(schedule.scene_ns)
        count += 1
    assert count == 6  # five periods are a tenth of a second, and the one that is due now
    progress = schedule.take_progress()
    assert progress.real_time_factor == pytest.approx(6 * 0.02 / 3600, rel=1e-3)
    assert progress.dropped_ns == 0  # simulated time was slow, and is whole


def test_time_scale_says_when_ticks_are_due_and_not_what_they_show():
    schedule = ClockSchedule(50.0, 4.0)
    assert schedule.timer_period_ns == 5_000_000
    assert [tick.scene_ns for tick in show_ticks(schedule, 3)] == [
        20_000_000,
        40_000_000,
        60_000_000,
    ]


def test_as_fast_as_possible_is_always_due():
    schedule = ClockSchedule(50.0, 0.0)
    assert schedule.timer_period_ns == 0
    assert [show(schedule, NOON).stamp_ns for _ in range(3)] == [
        20_000_000,
        40_000_000,
        60_000_000,
    ]


# Both modes


@pytest.fixture(params=[WallSchedule, ClockSchedule])
def kind(request):
    return request.param


def test_pause_keeps_the_scene_and_lets_ticks_and_stamps_go_on(kind):
    schedule = kind(50.0, 1.0)
    before = show_ticks(schedule, 5)[-1]
    schedule.paused = True
    ticks = show_ticks(schedule, 100, NOON + SECOND)
    assert {tick.scene_ns for tick in ticks} == {before.scene_ns}
    assert all(a.stamp_ns < b.stamp_ns for a, b in pairwise([before, *ticks]))
    schedule.paused = False
    after = show(schedule, NOON + 3 * SECOND)
    assert after.scene_ns == before.scene_ns + 20_000_000


def test_a_pause_is_neither_progress_nor_dropped(kind):
    schedule = kind(50.0, 1.0, paused=True)
    show(schedule, NOON)
    show(schedule, NOON + 3600 * SECOND)
    progress = schedule.take_progress()
    assert (progress.passed_ns, progress.advanced_ns, progress.dropped_ns) == (0, 0, 0)
    assert math.isnan(progress.real_time_factor)


def test_steps_are_exactly_one_period_each(kind):
    schedule = kind(60.0, 2.0, paused=True)
    show(schedule, NOON)
    for k in range(1, 61):
        schedule.step()
        assert show(schedule, NOON + k * SECOND).scene_ns == k * SECOND // 60


def test_a_step_right_after_a_reset_is_a_step(kind):
    schedule = kind(50.0, 1.0, paused=True)
    show(schedule, NOON)
    schedule.restart()
    schedule.step()
    assert show(schedule, NOON + SECOND).scene_ns == 20_000_000
    schedule.restart()
    assert show(schedule, NOON + 2 * SECOND).scene_ns == 0
    schedule.step()
    assert show(schedule, NOON + 3 * SECOND).scene_ns == 20_000_000


def test_a_reset_keeps_a_pause(kind):
    schedule = kind(50.0, 1.0)
    show_ticks(schedule, 5)
    schedule.paused = True
    schedule.restart()
    assert [tick.scene_ns for tick in show_ticks(schedule, 5, NOON + SECOND)] == [0] * 5


def test_no_change_of_rate_or_speed_moves_the_scene_or_the_stamps(kind):
    randoms = random.Random(2)
    schedule = kind(60.0, 1.0)
    reading, last = NOON, show(schedule, NOON)
    for _ in range(300):
        schedule.set_rate(randoms.uniform(20.0, 1000.0))
        schedule.set_time_scale(randoms.uniform(0.1, 100.0))
        assert schedule.scene_ns == last.scene_ns
        reading += 10_000_000
        tick = show(schedule, reading)
        # One period or what has passed at the new speed, with the fraction that both may round up.
        if kind is ClockSchedule:
            most = most_stamp = schedule._period + 1
        else:
            most, most_stamp = 10_000_000 * schedule._time_scale + 1, 10_000_000
        assert 0 < tick.scene_ns - last.scene_ns <= most
        assert 0 < tick.stamp_ns - last.stamp_ns <= most_stamp
        last = tick


def test_the_fractions_stay_small_however_often_the_speed_changes(kind):
    randoms = random.Random(3)
    schedule = kind(60.0, 1.0)
    for k in range(500):
        schedule.set_rate(randoms.uniform(1.0, 1000.0))
        schedule.set_time_scale(randoms.uniform(0.1, 100.0))
        show(schedule, NOON + k * SECOND)
    # A rate and a time_scale have at most 17 digits each, with a few zeros before them.
    assert schedule._position.denominator < 10**40


def test_a_scene_that_restarts_shows_its_last_instant_and_then_its_first(kind):
    schedule = kind(50.0, 1.0)
    schedule.set_restart_after(0.05)
    shown = [tick.scene_ns // 1_000_000 for tick in show_ticks(schedule, 9)]
    from_first = [0, 20, 40, 50, 0, 20, 40, 50, 0, 20]
    assert shown == (from_first[:9] if kind is WallSchedule else from_first[1:])
    assert schedule.take_progress().dropped_ns == 0


def test_scene_time_never_leaves_what_a_message_can_say(kind):
    schedule = kind(0.1, 1000.0)
    schedule.set_restart_after(math.inf)
    schedule._position += LAST_INSTANT - 1
    show(schedule, NOON)
    assert show(schedule, NOON + 10 * SECOND).scene_ns in (LAST_INSTANT, 0)
    assert LAST_INSTANT // SECOND < 2**31
