"""When bodies will touch: closed forms, exact arithmetic, and the distance of moving points."""

import math
import random

import numpy as np
import pytest
from lesson_oracles import ULP, distance_to_segment, exact_time_to_touch, refusal

from circle_bounce_ros.kernel import impact

INF = math.inf


# two circles


def test_head_on_the_gap_is_closed_at_the_relative_speed():
    assert impact.time_to_touch((10, 0), (-2, 0), 4) == 3.0
    assert impact.time_to_touch((-10, 0), (2, 0), 4) == 3.0
    assert impact.time_to_touch((0, 5), (0, -0.5), 1) == 8.0
    # A reach of zero: two points.
    assert impact.time_to_touch((3, 4), (-6, -8), 0) == INF  # nothing but a graze
    # Along (3, 4): distance 10, reach 5, speed 2.5.
    assert impact.time_to_touch((6, 8), (-1.5, -2), 5) == 2.0


def test_offset_contact_is_where_pythagoras_says():
    # Offset 3 across, reach 5: at touch they are 4 apart along.
    for sign in (-1, 1):
        assert impact.time_to_touch((10, 3 * sign), (-2, 0), 5) == 3.0
        assert impact.time_to_touch((3 * sign, -10), (0, 4), 5) == 1.5
    # Offset 5, reach 13: 12 apart along, of 20.
    assert impact.time_to_touch((20, 5), (-8, 0), 13) == 1.0
    # The same turned by (3, 4) / 5: along 20 (0.6, 0.8) + across 5 (-0.8, 0.6).
    time = impact.time_to_touch((8, 19), (-4.8, -6.4), 13)
    assert time == pytest.approx(1.0, rel=8 * ULP, abs=0)


def test_an_exact_graze_is_no_contact():  # lesson eq. 1.2: it changes nothing
    for sign in (-1, 1):
        assert impact.time_to_touch((10, 5 * sign), (-2, 0), 5) == INF
        assert impact.time_to_touch((5 * sign, 10), (0, -2), 5) == INF
    # Along (3, 4) / 5, offset 5 across: (6, 8) + (-4, 3).
    assert impact.time_to_touch((2, 11), (-3, -4), 5) == INF


def test_within_a_graze_by_two_to_the_minus_40_is_a_contact():
    offset = 5.0 * (1.0 - 2.0**-40)
    for d, u in [((10, offset), (-2, 0)), ((10, -offset), (-2, 0)), ((offset, -10), (0, 2))]:
        time = impact.time_to_touch(d, u, 5)
        exact, slant = exact_time_to_touch(d, u, 5)
        # They touch almost abreast: a rounding of the offset moves the touch by 1 / slant as much.
        assert slant < 2.0**-19
        assert time == pytest.approx(exact, abs=16 * ULP * 10.0 / 2.0 / slant)
        assert 4.9999 < time < 5.0
    assert impact.time_to_touch((10, 5.0 * (1.0 + 2.0**-40)), (-2, 0), 5) == INF


def test_those_that_miss_never_touch():
    assert impact.time_to_touch((10, 6), (-2, 0), 5) == INF
    assert impact.time_to_touch((10, -6), (-2, 0), 5) == INF
    assert impact.time_to_touch((10, 0), (-2, 2), 5) == INF


def test_those_that_move_apart_or_not_at_all_never_touch():
    assert impact.time_to_touch((10, 0), (2, 0), 5) == INF
    assert impact.time_to_touch((10, 0), (0, 0), 5) == INF
    assert impact.time_to_touch((10, 0), (0, 7), 5) == INF
    assert impact.time_to_touch((10, 3), (2, 1), 5) == INF


@pytest.mark.parametrize('reach', [5.0, math.nextafter(5.0, INF), 6.0])
def test_touching_and_closing_is_at_once(reach):  # lesson eq. 1.2
    for velocity in [(-1, 0), (-1, -1), (0, -1), (-3, 2), (1, -1)]:
        time = impact.time_to_touch((3, 4), velocity, reach)
        assert time == 0.0
        assert math.copysign(1.0, time) == 1.0


@pytest.mark.parametrize('reach', [5.0, math.nextafter(5.0, INF), 6.0])
def test_touching_and_parting_or_sliding_is_never(reach):  # the simulation lets them go
    for velocity in [(1, 0), (1, 1), (3, 4), (-4, 3), (4, -3), (0, 0)]:
        assert impact.time_to_touch((3, 4), velocity, reach) == INF


@pytest.mark.parametrize('bits', [10, 20, 30, 40, 50])
def test_a_tiny_gap_keeps_its_digits(bits):
    gap = 2.0**-bits
    # In c = d.d - reach^2 the square of the gap may round away: less than the gap itself, relatively.
    close = max(gap, 4 * ULP)
    for offset in ((1.0 + gap, 0.0), (0.0, -1.0 - gap)):
        velocity = (-2.0 * offset[0], -2.0 * offset[1])
        time = impact.time_to_touch(offset, velocity, 1)
        exact, _ = exact_time_to_touch(offset, velocity, 1)
        assert exact == pytest.approx(gap / 2.0, rel=2 * gap, abs=0)
        assert time == pytest.approx(exact, rel=close, abs=0)
    # Aslant: the textbook's difference of two large terms would leave nothing of it.
    time = impact.time_to_touch((0.6, 0.8 + gap), (-1.0, -1e3), 1)
    exact, _ = exact_time_to_touch((0.6, 0.8 + gap), (-1.0, -1e3), 1)
    # An ulp of the squares, a quarter of that of 1 or more, over twice the closing speed.
    assert time == pytest.approx(exact, abs=2 * ULP / (2 * 0.8e3))


def test_a_great_distance_keeps_the_digits_of_the_place():
    for distance in (1e3, 1e6, 1e9):
        for speed in (1e-3, 1.0, 1e6):
            time = impact.time_to_touch((distance, 0.6), (-speed, 0.0), 1.0)
            # Pythagoras: 0.8 m before abreast. Off by no more than a few ulp of the distance.
            assert time * speed == pytest.approx(distance - 0.8, abs=4 * ULP * distance)


def test_time_scales_with_size_and_speed():
    time = impact.time_to_touch((10, 3), (-2, 0.25), 5)
    for scale in (2.0**-190, 2.0**-40, 2.0**100, 2.0**190):
        d, u = (10 * scale, 3 * scale), (-2 * scale, 0.25 * scale)
        assert impact.time_to_touch(d, u, 5 * scale) == time
        assert impact.time_to_touch(d, (-2, 0.25), 5 * scale) == time * scale
        assert impact.time_to_touch((10, 3), u, 5) == time / scale


def random_approaches(count, seed):
    """Yield offsets, velocities and reaches, about half of them on course to touch."""
    rng = random.Random(seed)
    for _ in range(count):
        reach = 10.0 ** rng.uniform(-3, 1)
        distance = reach * (1.0 + 10.0 ** rng.uniform(-12, 3))
        angle = 2 * math.pi * rng.random()
        # Aim within twice the angle under which the other is seen.
        aside = 2.0 * math.asin(reach / distance) * (2 * rng.random() - 1)
        aim = angle + math.pi + aside
        speed = 10.0 ** rng.uniform(-3, 3)
        offset = (distance * math.cos(angle), distance * math.sin(angle))
        yield offset, (speed * math.cos(aim), speed * math.sin(aim)), reach


def test_time_to_touch_against_exact_arithmetic():
    hits = 0
    for offset, velocity, reach in random_approaches(1500, 1):
        time = impact.time_to_touch(offset, velocity, reach)
        exact, slant = exact_time_to_touch(offset, velocity, reach)
        if exact < INF:
            hits += 1
            # A dozen roundings of lengths as large as distance and reach; slant as above.
            close = 16 * ULP * (math.hypot(*offset) + reach) / math.hypot(*velocity) / slant
            assert time == pytest.approx(exact, abs=close)
        else:
            assert time == INF
    assert 500 < hits < 1000


def test_at_the_time_to_touch_the_distance_is_the_reach():  # lesson eq. 1.2
    hits = 0
    for offset, velocity, reach in random_approaches(500, 2):
        time = impact.time_to_touch(offset, velocity, reach)
        if time == INF:
            continue
        hits += 1
        x, y = (offset[k] + velocity[k] * time for k in (0, 1))
        # The path is as long as the offset, and each of some dozen roundings as large as its ulp.
        close = 16 * ULP * (math.hypot(*offset) + reach)
        assert math.hypot(x, y) == pytest.approx(reach, abs=close)
        # Never sooner: a circle is round, so the distance falls until then.
        before = [offset[k] + velocity[k] * 0.999 * time for k in (0, 1)]
        assert math.hypot(*before) >= reach - close
        assert x * velocity[0] + y * velocity[1] < 0.0
    assert hits > 100


def test_who_is_called_a_and_how_the_axes_lie_do_not_matter():
    for (dx, dy), (du, dv), reach in random_approaches(200, 3):
        time = impact.time_to_touch((dx, dy), (du, dv), reach)
        assert impact.time_to_touch((-dx, -dy), (-du, -dv), reach) == time
        assert impact.time_to_touch((-dx, dy), (-du, dv), reach) == time
        assert impact.time_to_touch((dy, dx), (dv, du), reach) == time


def test_a_limit_leaves_out_only_what_is_later():
    for (dx, dy), (du, dv), reach in random_approaches(500, 4):
        time = impact.time_to_touch_xy(dx, dy, du, dv, reach)
        if time < INF:
            assert impact.time_to_touch_xy(dx, dy, du, dv, reach, 1.001 * time + 1e-12) == time
            assert impact.time_to_touch_xy(dx, dy, du, dv, reach, 0.4 * time) in (time, INF)
    # Head on from far away it pays: sooner than half the time is surely never.
    assert impact.time_to_touch_xy(10.0, 0.0, -1.0, 0.0, 1.0, 4.9) == INF
    assert impact.time_to_touch_xy(10.0, 0.0, -1.0, 0.0, 1.0, 9.0) == 9.0


# a circle and a wall


def test_flat_is_reached_from_both_sides():
    start, end = (-5, 0), (5, 0)
    assert impact.time_to_wall((1, 7), (0, -2), 3, start, end) == 2.0
    assert impact.time_to_wall((1, -7), (0, 2), 3, start, end) == 2.0
    assert impact.time_to_wall((1, 7), (0, -2), 3, end, start) == 2.0
    assert impact.time_to_wall((1, -7), (0, 2), 3, end, start) == 2.0
    # What goes along does not count, as long as it is not past the ends.
    assert impact.time_to_wall((-4, 7), (4, -2), 3, start, end) == 2.0


def test_vertical_wall_is_reached_from_both_sides():
    for start, end in [((2, -5), (2, 5)), ((2, 5), (2, -5))]:
        assert impact.time_to_wall((9, 1), (-3, 0), 1, start, end) == 2.0
        assert impact.time_to_wall((-5, 1), (3, 0.5), 1, start, end) == 2.0


def test_tilted_wall_is_reached_across():
    # Along (4, 3) / 5 through (1, 2), normal (-3, 4) / 5; from (5, 5), its middle, 7 across.
    for side in (-1, 1):
        center = (5 - 4.2 * side, 5 + 5.6 * side)
        velocity = (1.2 * side, -1.6 * side)  # 2 across
        for start, end in [((1, 2), (9, 8)), ((9, 8), (1, 2))]:
            time = impact.time_to_wall(center, velocity, 1, start, end)
            assert time == pytest.approx(3.0, rel=8 * ULP, abs=0)
            # And 1 along: the time is the same.
            aslant = (velocity[0] + 0.8, velocity[1] + 0.6)
            time = impact.time_to_wall(center, aslant, 1, start, end)
            assert time == pytest.approx(3.0, rel=8 * ULP, abs=0)


def test_past_the_ends_there_is_no_wall():
    for x in (-6.5, 6.5):
        assert impact.time_to_wall((x, 7), (0, -2), 1, (-5, 0), (5, 0)) == INF
    # On course for the flat at first, but it gets there past the end.
    assert impact.time_to_wall((4, 7), (4, -2), 1, (-5, 0), (5, 0)) == INF


def test_ends_are_circles_of_radius_zero():
    # 3 beyond the end, radius 5: the end is touched when the centre is 4 above it.
    assert impact.time_to_wall((8, 10), (0, -2), 5, (-5, 0), (5, 0)) == 3.0
    assert impact.time_to_wall((-8, 10), (0, -2), 5, (-5, 0), (5, 0)) == 3.0
    assert impact.time_to_wall((-8, -10), (0, 2), 5, (-5, 0), (5, 0)) == 3.0
    # Straight at the end, along the wall.
    assert impact.time_to_wall((11, 0), (-2, 0), 2, (-5, 0), (5, 0)) == 2.0
    assert impact.time_to_wall((0, 13), (0, -1), 2, (0, 0), (0, 5)) == 6.0


def test_a_graze_of_an_end_is_no_contact():
    assert impact.time_to_wall((6, 7), (0, -2), 1, (-5, 0), (5, 0)) == INF
    assert impact.time_to_wall((-6, 7), (0, -2), 1, (-5, 0), (5, 0)) == INF


def test_the_flat_goes_as_far_as_its_ends_and_no_further():
    for x in (0.0, 10.0):
        assert impact.time_to_wall_xy(x, 3.0, 0.0, -1.0, 1.0, 0.0, 1.0, 10.0) == 2.0
    for x in (-(2.0**-40), 10.0 + 2.0**-40):
        assert impact.time_to_wall_xy(x, 3.0, 0.0, -1.0, 1.0, 0.0, 1.0, 10.0) == INF
        # The end is there, 2^-40 aside: no later than rounding can tell.
        time = impact.time_to_wall((x, 3), (0, -1), 1, (0, 0), (10, 0))
        assert time == pytest.approx(2.0, rel=4 * ULP, abs=0)


def test_along_the_wall_is_never():
    assert impact.time_to_wall((0, 2), (3, 0), 1, (-5, 0), (5, 0)) == INF
    assert impact.time_to_wall((0, 1), (3, 0), 1, (-5, 0), (5, 0)) == INF  # rolling on it
    assert impact.time_to_wall((0, -1), (-3, 0), 1, (-5, 0), (5, 0)) == INF


def test_away_from_the_wall_or_at_rest_is_never():
    for side in (-1, 1):
        assert impact.time_to_wall((0, 2 * side), (1, side), 1, (-5, 0), (5, 0)) == INF
        assert impact.time_to_wall((0, side), (1, side), 1, (-5, 0), (5, 0)) == INF
        assert impact.time_to_wall((0, 2 * side), (0, 0), 1, (-5, 0), (5, 0)) == INF
        assert impact.time_to_wall((0, side), (0, 0), 1, (-5, 0), (5, 0)) == INF


@pytest.mark.parametrize('height', [1.0, math.nextafter(1.0, 0.0), 0.5])
def test_touching_the_wall_and_closing_is_at_once(height):  # lesson eq. 1.2
    for side in (-1, 1):
        for along in (-2, 0, 2):
            time = impact.time_to_wall((0, height * side), (along, -3 * side), 1, (-5, 0), (5, 0))
            assert time == 0.0
            assert math.copysign(1.0, time) == 1.0


def test_touching_an_end_and_closing_is_at_once():  # lesson eq. 1.2
    assert impact.time_to_wall((8, 4), (-1, 0), 5, (-5, 0), (5, 0)) == 0.0
    assert impact.time_to_wall((8, 4), (1, 0), 5, (-5, 0), (5, 0)) == INF


def test_a_tiny_gap_to_a_wall_keeps_its_digits():
    for bits in (10, 30, 50):
        gap = 2.0**-bits
        assert impact.time_to_wall((0, 1 + gap), (7, -4), 1, (-5, 0), (5, 0)) == gap / 4


def test_frame_of_a_wall_is_its_direction_turned_left():
    assert impact.wall_frame(1.0, 1.0, 4.0, 5.0) == (-0.8, 0.6, 5.0)
    assert impact.wall_frame(4.0, 5.0, 1.0, 1.0) == (0.8, -0.6, 5.0)
    assert impact.wall_frame(0.0, 2.0, 3.0, 2.0) == (0.0, 1.0, 3.0)
    assert impact.wall_frame(3.0, 2.0, 3.0, -5.0) == (1.0, 0.0, 7.0)


def random_walls(count, seed):
    """Yield circles near walls and on all kinds of courses."""
    rng = random.Random(seed)
    while count:
        start, end = ((3 * rng.gauss(0, 1), 3 * rng.gauss(0, 1)) for _ in 'se')
        position = (6 * rng.gauss(0, 1), 6 * rng.gauss(0, 1))
        share = 2.0 * rng.random() - 0.5
        aim = [a + share * (b - a) + rng.gauss(0, 1) for a, b in zip(start, end, strict=True)]
        velocity = (aim[0] - position[0], aim[1] - position[1])
        radius = 2 * rng.random()
        if distance_to_segment(position, start, end) > radius and math.dist(start, end) > 0.1:
            count -= 1
            yield position, velocity, radius, start, end


def nearest_approach(position, velocity, start, end):
    """Return the smallest distance to come and when: it falls, then rises, as segments are convex."""

    def away(t):
        return distance_to_segment(
            (position[0] + velocity[0] * t, position[1] + velocity[1] * t), start, end
        )

    early, late = 0.0, 40.0 / math.hypot(*velocity)  # nothing is further than 40 m
    for _ in range(120):
        third = (late - early) / 3.0
        if away(early + third) <= away(late - third):
            late -= third
        else:
            early += third
    return away(early), early


def test_time_to_wall_is_when_the_distance_to_the_segment_is_the_radius():
    hits = {'flat': 0, 'end': 0, 'never': 0}
    for position, velocity, radius, start, end in random_walls(600, 5):
        time = impact.time_to_wall(position, velocity, radius, start, end)
        nearest, when = nearest_approach(position, velocity, start, end)
        if time == INF:
            hits['never'] += 1
            assert nearest > radius
            continue
        x, y = (position[k] + velocity[k] * time for k in (0, 1))
        # Places up to 40 m: an ulp there is 32 of 1, and some dozen roundings.
        assert distance_to_segment((x, y), start, end) == pytest.approx(radius, abs=500 * ULP)
        # The first touch: the distance falls all the way to it. A search by thirds finds a
        # smooth lowest point to the root of a rounding only.
        assert time <= when + 1e-6
        share = (x - start[0]) * (end[0] - start[0]) + (y - start[1]) * (end[1] - start[1])
        share /= math.dist(start, end) ** 2
        hits['flat' if 0.0 < share < 1.0 else 'end'] += 1
    assert min(hits.values()) > 50


# one or many

COUNT = 60
APPROACHES = list(random_approaches(COUNT, 6))
OFFSETS, VELOCITIES, REACHES = (np.array(column) for column in zip(*APPROACHES, strict=True))
WALL = ((-1.0, -2.0), (2.0, 1.5))
CENTERS = np.random.default_rng(7).uniform(-6, 6, (COUNT, 2))
COURSES = -CENTERS + np.random.default_rng(8).uniform(-2, 2, (COUNT, 2))


def test_many_approaches_give_what_one_by_one_gives():
    many = impact.time_to_touch(OFFSETS, VELOCITIES, REACHES)
    assert many.tolist() == [impact.time_to_touch(*one) for one in APPROACHES]
    assert 0 < np.isfinite(many).sum() < COUNT
    many = impact.time_to_wall(CENTERS, COURSES, REACHES, *WALL)
    rows = zip(CENTERS, COURSES, REACHES, strict=True)
    assert many.tolist() == [impact.time_to_wall(*row, *WALL) for row in rows]
    assert 0 < np.isfinite(many).sum() < COUNT


def test_one_against_many_is_repeated():
    one, rest = (10.0, 1.0), (-1.0, 0.0)
    many_one, many_rest = np.tile(one, (COUNT, 1)), np.tile(rest, (COUNT, 1))
    for given, repeated in [
        ((one, VELOCITIES, 2.0), (many_one, VELOCITIES, np.full(COUNT, 2.0))),
        ((OFFSETS, rest, REACHES), (OFFSETS, many_rest, REACHES)),
        ((one, rest, REACHES), (many_one, many_rest, REACHES)),
    ]:
        expected = impact.time_to_touch(*repeated).tolist()
        assert impact.time_to_touch(*given).tolist() == expected
        expected = impact.time_to_wall(*repeated, *WALL).tolist()
        assert impact.time_to_wall(*given, *WALL).tolist() == expected


def test_one_gives_a_plain_number_and_none_gives_none():
    assert type(impact.time_to_touch((10, 0), (-1, 0), 1)) is float
    assert type(impact.time_to_wall((10, 0), (-1, 0), 1, *WALL)) is float
    nobody = np.empty((0, 2))
    assert impact.time_to_touch(nobody, nobody, 1).shape == (0,)
    assert impact.time_to_wall(nobody, (1, 0), 1, *WALL).shape == (0,)


# bad input


@pytest.mark.parametrize(
    ('call', 'message'),
    [
        (
            lambda: impact.time_to_touch((1, 2, 3), (0, 1), 1),
            'offset: must have shape (2,) or (n, 2)',
        ),
        (
            lambda: impact.time_to_touch((1, 2), (0, INF), 1),
            'relative_velocity: must be finite',
        ),
        (lambda: impact.time_to_touch((1, 2), (0, 1), -1), 'reach: must be >= 0'),
        (
            lambda: impact.time_to_wall((1, math.nan), (0, 1), 1, *WALL),
            'position: must be finite',
        ),
        (
            lambda: impact.time_to_wall((1, 2), 3, 1, *WALL),
            'velocity: must have shape (2,) or (n, 2)',
        ),
        (lambda: impact.time_to_wall((1, 2), (0, 1), -2, *WALL), 'radius: must be >= 0'),
        (
            lambda: impact.time_to_wall((1, 2), (0, 1), 1, (0, math.nan), (1, 1)),
            'start: must be finite',
        ),
        (
            lambda: impact.time_to_wall((1, 2), (0, 1), 1, (0, 0), ((1, 1), (2, 2))),
            'end: must have shape (2,)',
        ),
        (
            lambda: impact.time_to_wall((1, 2), (0, 1), 1, ((1, 1),), (0, 0)),
            'start: must have shape (2,)',
        ),
        (
            lambda: impact.time_to_wall((1, 2), (0, 1), 1, (3, 4), (3, 4)),
            'end: must differ from start',
        ),
    ],
)
def test_bad_input_is_refused_with_place_rule_and_value(call, message):
    with pytest.raises(ValueError, match=refusal(message)):
        call()
