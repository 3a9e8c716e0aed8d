"""Have two circles touched, where, and along which normal: lesson eq. 1.1-1.5."""

import math
import random
from fractions import Fraction

import numpy as np
import pytest
from lesson_oracles import ULP, refusal

from circle_bounce_ros.kernel import contact

TRIPLES = [(3, 4, 5), (5, 12, 13), (8, 15, 17), (7, 24, 25), (20, 21, 29), (4, 0, 4), (0, 9, 9)]
SIGNS = [(1, 1), (-1, 1), (-1, -1), (1, -1)]


def random_pairs(count, seed):
    """Yield centres and radii of two circles, about half of them in contact."""
    rng = random.Random(seed)
    for _ in range(count):
        a, b = ((4 * rng.random(), 4 * rng.random()) for _ in 'ab')
        yield a, 2 * rng.random(), b, 2 * rng.random()


# distance


@pytest.mark.parametrize(('dh', 'dv', 'expected'), TRIPLES)
def test_distance_is_the_root_of_the_sum_of_squares(dh, dv, expected):  # lesson eq. 1.1
    for sign_h, sign_v in SIGNS:
        h1, v1 = 10.0, -20.0
        assert contact.distance((h1, v1), (h1 + sign_h * dh, v1 + sign_v * dv)) == expected


def test_distance_to_the_digit_against_exact_arithmetic():  # lesson eq. 1.1
    for a, _, b, _ in random_pairs(300, 1):
        exact_sq = (Fraction(b[0]) - Fraction(a[0])) ** 2 + (Fraction(b[1]) - Fraction(a[1])) ** 2
        # Two differences and a hypot, half an ulp or one each: below 4 ulp, so 8 for the square.
        assert abs(Fraction(contact.distance(a, b)) ** 2 / exact_sq - 1) < 8 * ULP


def test_distance_is_symmetric_and_zero_only_for_one_point():  # lesson eq. 1.1
    for a, _, b, _ in random_pairs(100, 2):
        assert contact.distance(a, b) == contact.distance(b, a) > 0.0
        assert contact.distance(a, a) == 0.0


# contact


@pytest.mark.parametrize(('dh', 'dv', 'reach'), TRIPLES)
def test_touching_exactly_counts_as_contact(dh, dv, reach):  # lesson eq. 1.2
    for radius in (0.0, 0.25, 0.5 * reach, reach):
        for sign_h, sign_v in SIGNS:
            b = (1.0 + sign_h * dh, 2.0 + sign_v * dv)
            assert contact.in_contact((1.0, 2.0), radius, b, reach - radius)


@pytest.mark.parametrize(('dh', 'dv', 'reach'), TRIPLES)
def test_one_ulp_apart_is_no_contact(dh, dv, reach):  # lesson eq. 1.2
    # Of the longer leg, where one ulp shows in the square.
    further = (math.nextafter(dh, math.inf), dv) if dh > dv else (dh, math.nextafter(dv, math.inf))
    for sign_h, sign_v in SIGNS:
        b = (sign_h * further[0], sign_v * further[1])
        assert not contact.in_contact((0.0, 0.0), 1.0, b, reach - 1.0)
    assert not contact.in_contact((0.0, 0.0), math.nextafter(reach, 0.0), (dh, dv), 0.0)


@pytest.mark.parametrize(('dh', 'dv', 'reach'), TRIPLES)
def test_one_ulp_into_each_other_is_contact(dh, dv, reach):  # lesson eq. 1.2
    nearer = (math.nextafter(dh, 0.0), dv) if dh > dv else (dh, math.nextafter(dv, 0.0))
    for sign_h, sign_v in SIGNS:
        b = (sign_h * nearer[0], sign_v * nearer[1])
        assert contact.in_contact((0.0, 0.0), 1.0, b, reach - 1.0)
    assert contact.in_contact((0.0, 0.0), math.nextafter(reach, math.inf), (dh, dv), 0.0)


def test_one_circle_inside_another_is_contact():  # lesson eq. 1.2
    assert contact.in_contact((0.0, 0.0), 5.0, (1.0, 1.0), 0.5)
    assert contact.in_contact((1.0, 1.0), 0.0, (1.0, 1.0), 0.0)


def test_squares_and_roots_agree_on_every_whole_number():  # lesson eq. 1.3-1.5
    for dh in range(-13, 14):
        for dv in range(-13, 14):
            for reach in range(20):
                by_squares = contact.in_contact((0, 0), 0, (dh, dv), reach)
                assert by_squares == (dh * dh + dv * dv <= reach * reach)
                assert by_squares == (contact.distance((0, 0), (dh, dv)) <= reach)


def test_squares_and_roots_agree_on_random_circles():  # lesson eq. 1.3-1.5
    found = set()
    for a, radius_a, b, radius_b in random_pairs(2000, 3):
        by_squares = contact.in_contact(a, radius_a, b, radius_b)
        assert by_squares == (contact.distance(a, b) <= radius_a + radius_b)
        assert by_squares == contact.in_contact(b, radius_b, a, radius_a)
        found.add(by_squares)
    assert found == {True, False}


def test_the_gap_of_squares_is_negative_only_in_contact():  # lesson eq. 1.5
    assert contact.gap_sq_xy(3.0, 4.0, 5.0) == 0.0
    assert contact.gap_sq_xy(3.0, 4.0, 4.0) == 9.0
    assert contact.gap_sq_xy(3.0, -4.0, 6.0) == -11.0


# bounding squares


def test_bounding_squares_are_wrong_at_the_corners():  # lesson, the cheap alternative
    a, b = (0.0, 0.0), (1.9, 1.9)
    assert contact.boxes_overlap(a, 1.0, b, 1.0)
    assert not contact.in_contact(a, 1.0, b, 1.0)
    assert contact.distance(a, b) > 2.68


def test_bounding_squares_err_in_the_share_of_the_corners():  # lesson, the cheap alternative
    # Offsets spread evenly over the square of overlap: 1 - pi/4 of its area lies outside the circle.
    count = 200
    steps = (np.arange(count) + 0.5) / count * 4.0 - 2.0
    offsets = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    assert contact.boxes_overlap((0, 0), 1.5, offsets, 0.5).all()
    wrong = ~contact.in_contact((0, 0), 1.5, offsets, 0.5)
    # The circle's rim meets fewer than 4 * 200 of the 40,000 cells, evenly on either side of it.
    assert wrong.mean() == pytest.approx(1.0 - math.pi / 4.0, abs=1e-3)


def test_bounding_squares_never_miss_a_contact():  # lesson, the cheap alternative
    contacts = 0
    for a, radius_a, b, radius_b in random_pairs(2000, 4):
        if contact.in_contact(a, radius_a, b, radius_b):
            contacts += 1
            assert contact.boxes_overlap(a, radius_a, b, radius_b)
    assert contacts > 500


def test_bounding_squares_apart_on_either_axis_do_not_overlap():  # lesson, the cheap alternative
    for sign in (-1.0, 1.0):
        assert contact.boxes_overlap((1, 2), 0.5, (1 + 2.0 * sign, 2), 1.5)
        assert contact.boxes_overlap((1, 2), 0.5, (1, 2 + 2.0 * sign), 1.5)
        assert not contact.boxes_overlap((1, 2), 0.5, (1 + 2.001 * sign, 2), 1.5)
        assert not contact.boxes_overlap((1, 2), 0.5, (1, 2 + 2.001 * sign), 1.5)


# normal and contact point


def test_normal_is_the_unit_vector_from_a_to_b():  # lesson, the line of centres
    assert contact.contact_normal((1, 1), (4, 5)).tolist() == [0.6, 0.8]
    assert contact.contact_normal((4, 5), (1, 1)).tolist() == [-0.6, -0.8]
    assert contact.contact_normal((7, 0), (7, -3)).tolist() == [0.0, -1.0]
    assert contact.contact_normal((7, 0), (9, 0)).tolist() == [1.0, 0.0]


def test_normal_has_length_one_along_the_line_of_centres():  # lesson, the line of centres
    for a, _, b, _ in random_pairs(300, 5):
        nx, ny = contact.contact_normal(a, b)
        dx, dy = b[0] - a[0], b[1] - a[1]
        assert nx * nx + ny * ny == pytest.approx(1.0, abs=4 * ULP)  # two quotients, two squares
        length = math.hypot(dx, dy)
        assert nx * dy - ny * dx == pytest.approx(0.0, abs=4 * ULP * length)
        assert nx * dx + ny * dy == pytest.approx(length, rel=4 * ULP, abs=0)
        assert (contact.contact_normal(b, a) == (-nx, -ny)).all()


def test_normal_does_not_depend_on_the_scale():
    expected = contact.contact_normal((0, 0), (1.0, 3.0))
    for scale in (2.0**-199, 2.0**-100, 2.0**100, 2.0**197):
        assert (contact.contact_normal((0, 0), (scale, 3.0 * scale)) == expected).all()


def test_normal_of_a_wall_points_to_the_foot():  # lesson, a flat surface
    # The wall through (0, 0) and (4, 3); the centre stands 5 above (4, 3) along (-3, 4) / 5.
    assert contact.contact_normal((1.0, 7.0), (4.0, 3.0)).tolist() == [0.6, -0.8]


def test_two_circles_touch_in_a_single_point():  # lesson, the line of centres
    point = contact.contact_point((1, 2), 2, (4, 6))
    assert point.tolist() == [1.0 + 2.0 * 0.6, 2.0 + 2.0 * 0.8]
    # Seen from either circle it is the same point, to the rounding of one sum.
    assert contact.contact_point((4, 6), 3, (1, 2)) == pytest.approx(point, rel=2 * ULP, abs=0)


def test_contact_point_lies_on_both_circles_and_the_line_of_centres():  # lesson, same
    for a, radius_a, b, _ in random_pairs(300, 6):
        reach = math.dist(a, b)
        # Negative when b lies inside a: then it is touched from inside.
        radius_b = reach - radius_a
        x, y = contact.contact_point(a, radius_a, b)
        # Coordinates up to 4 m, so every sum rounds by up to 2 ulp.
        assert math.dist((x, y), a) == pytest.approx(radius_a, abs=16 * ULP)
        assert math.dist((x, y), b) == pytest.approx(abs(radius_b), abs=16 * ULP)
        across = (x - a[0]) * (b[1] - a[1]) - (y - a[1]) * (b[0] - a[0])
        assert across == pytest.approx(0.0, abs=16 * ULP * reach)


def test_a_circle_touches_a_flat_surface_in_a_single_point():  # lesson, a flat surface
    assert contact.contact_point((2, 3), 3, (2, 0)).tolist() == [2.0, 0.0]
    assert contact.contact_point((1, 7), 5, (4, 3)).tolist() == [4.0, 3.0]


# one or many

A = np.random.default_rng(1).uniform(-2, 2, (40, 2))
B = np.random.default_rng(2).uniform(-2, 2, (40, 2))
RADII_A = np.random.default_rng(3).uniform(0, 2, 40)
RADII_B = np.random.default_rng(4).uniform(0, 2, 40)


def test_many_points_give_what_one_by_one_gives():
    rows = list(zip(A, RADII_A, B, RADII_B, strict=True))
    assert contact.distance(A, B).tolist() == [contact.distance(a, b) for a, _, b, _ in rows]
    for function in (contact.in_contact, contact.boxes_overlap):
        many = function(A, RADII_A, B, RADII_B)
        assert many.dtype == bool
        assert many.tolist() == [function(*row) for row in rows]
        assert len(set(many.tolist())) == 2
    many = contact.contact_normal(A, B)
    assert many.tolist() == [contact.contact_normal(a, b).tolist() for a, _, b, _ in rows]
    many = contact.contact_point(A, RADII_A, B)
    assert many.tolist() == [contact.contact_point(a, r, b).tolist() for a, r, b, _ in rows]


def test_one_against_many_is_repeated():
    a, repeated = A[0], np.repeat(A[:1], 40, axis=0)
    assert (contact.distance(a, B) == contact.distance(repeated, B)).all()
    assert (contact.distance(B, a) == contact.distance(B, repeated)).all()
    for function in (contact.in_contact, contact.boxes_overlap):
        expected = function(repeated, np.full(40, 0.5), B, np.full(40, 1.0))
        assert (function(a, 0.5, B, 1.0) == expected).all()
        assert (function(B, 1.0, a, 0.5) == expected).all()
    assert (contact.contact_normal(a, B) == contact.contact_normal(repeated, B)).all()
    expected = contact.contact_point(repeated, np.full(40, 0.5), B)
    assert (contact.contact_point(a, 0.5, B) == expected).all()
    # Many radii around one centre, too.
    expected = contact.in_contact(repeated, RADII_A, np.repeat(B[:1], 40, axis=0), 0.5)
    assert (contact.in_contact(a, RADII_A, B[0], 0.5) == expected).all()


def test_one_gives_plain_numbers():
    assert type(contact.distance((0, 0), (3, 4))) is float
    assert type(contact.in_contact((0, 0), 1, (3, 4), 1)) is bool
    assert type(contact.boxes_overlap((0, 0), 1, (3, 4), 1)) is bool
    assert contact.contact_normal((0, 0), (3, 4)).shape == (2,)
    assert contact.contact_point((0, 0), 1, (3, 4)).shape == (2,)


def test_none_gives_none():
    nobody = np.empty((0, 2))
    assert contact.distance(nobody, nobody).shape == (0,)
    assert contact.in_contact(nobody, 1, (0, 0), 1).shape == (0,)
    assert contact.boxes_overlap(nobody, 1, (0, 0), 1).shape == (0,)
    assert contact.contact_normal(nobody, (0, 0)).shape == (0, 2)
    assert contact.contact_point(nobody, 1, (0, 0)).shape == (0, 2)


# bad input


@pytest.mark.parametrize(
    ('call', 'message'),
    [
        (
            lambda: contact.distance((1, 2, 3), (0, 0)),
            'center_a: must have shape (2,) or (n, 2)',
        ),
        (
            lambda: contact.distance((0, 0), (0, math.nan)),
            'center_b: must be finite',
        ),
        (
            lambda: contact.in_contact(5, 1, (0, 0), 1),
            'center_a: must have shape (2,) or (n, 2)',
        ),
        (lambda: contact.in_contact((0, 0), -1, (3, 4), 1), 'radius_a: must be >= 0'),
        (
            lambda: contact.in_contact((0, 0), 1, (3, 4), math.inf),
            'radius_b: must be finite',
        ),
        (
            lambda: contact.boxes_overlap((0, 0), 1, (math.inf, 4), 1),
            'center_b: must be finite',
        ),
        (
            lambda: contact.boxes_overlap((0, 0), 1, (3, 4), (1, -2)),
            'radius_b: must be >= 0',
        ),
        (lambda: contact.boxes_overlap((0, 0), -1, (3, 4), 1), 'radius_a: must be >= 0'),
        (
            lambda: contact.contact_normal((1, 2), (1, 2)),
            'center_b - center_a: must not be the zero vector',
        ),
        (
            lambda: contact.contact_normal(np.zeros((2, 2)), ((1, 1), (0, 0))),
            'center_b - center_a: must not be the zero vector',
        ),
        (
            lambda: contact.contact_point((1, 2), 1, (1, 2)),
            'center_b - center_a: must not be the zero vector',
        ),
        (
            lambda: contact.contact_point((0, 0), math.nan, (1, 2)),
            'radius_a: must be finite',
        ),
    ],
)
def test_bad_input_is_refused_with_place_rule_and_value(call, message):
    with pytest.raises(ValueError, match=refusal(message)):
        call()
