"""What the public functions accept as points, vectors and lengths, and how they refuse the rest."""

import math
from fractions import Fraction

import numpy as np
import pytest
from lesson_oracles import exactly, refusal

from circle_bounce_ros.kernel import exchange, in_contact, points, time_to_touch


def test_one_vector_gives_two_numbers():
    x, y = points.components([1, -2], 'velocity')
    assert (x.shape, y.shape) == ((), ())
    assert (float(x), float(y)) == (1.0, -2.0)


def test_many_vectors_give_two_columns():
    x, y = points.components(((1, 2), (3, 4), (5, 6)), 'velocity')
    assert (x.tolist(), y.tolist()) == ([1.0, 3.0, 5.0], [2.0, 4.0, 6.0])


def test_one_point_is_two_plain_numbers():
    assert points.point(np.array((1, -2)), 'start') == (1.0, -2.0)
    assert [type(number) for number in points.point((1, -2), 'start')] == [float] * 2


@pytest.mark.parametrize(
    ('value', 'problem'),
    [
        (((1.0, 2.0),), 'must have shape (2,)'),
        (((1, 2), (3, 4)), 'must have shape (2,)'),
        ((1, 2, 3), 'must have shape (2,) or (n, 2)'),
    ],
)
def test_many_points_are_refused_where_one_is_asked_for(value, problem):
    with pytest.raises(ValueError, match=refusal(f'start: {problem}')):
        points.point(value, 'start')


def test_components_go_together_again():
    one, many = np.array((1.0, 2.0)), np.array(((1.0, 2.0), (3.0, 4.0)))
    for value in (one, many):
        assert points.vectors(*points.components(value, 'v')).tolist() == value.tolist()
    assert points.vectors(1.0, np.array((2.0, 3.0))).tolist() == [[1.0, 2.0], [1.0, 3.0]]


@pytest.mark.parametrize(
    ('value', 'problem'),
    [
        (1.0, 'must have shape (2,) or (n, 2)'),
        ([], 'must have shape (2,) or (n, 2)'),
        ([1.0], 'must have shape (2,) or (n, 2)'),
        ([1.0, 2.0, 3.0], 'must have shape (2,) or (n, 2)'),
        ([[1.0, 2.0, 3.0]], 'must have shape (2,) or (n, 2)'),
        (np.zeros((2, 3, 2)), 'must have shape (2,) or (n, 2)'),
        ([1.0, math.nan], 'must be finite'),
        ([-math.inf, 0.0], 'must be finite'),
        ([[0.0, 1.0], [2.0, math.inf]], 'must be finite'),
    ],
)
def test_no_vector_is_refused_by_name(value, problem):
    with pytest.raises(ValueError, match=refusal(f'offset: {problem}')):
        points.components(value, 'offset')


@pytest.mark.parametrize(
    ('value', 'problem'),
    [
        ([[1.0]], 'must be one number or have shape (n,)'),
        (math.nan, 'must be finite'),
        ([1.0, -math.inf], 'must be finite'),
        (-1e-300, 'must be >= 0'),
        ([0.0, -1.0], 'must be >= 0'),
    ],
)
def test_no_length_is_refused_by_name(value, problem):
    with pytest.raises(ValueError, match=refusal(f'reach: {problem}')):
        points.quantity(value, 'reach')


@pytest.mark.parametrize(
    ('value', 'got'), [(0.0, '0.0'), (-1.0, '-1.0'), ([2.0, 0.0], '[2.0, 0.0]')]
)
def test_what_must_be_positive_is_not_zero(value, got):
    with pytest.raises(ValueError, match=exactly(f'mass_a: must be > 0, got {got}')):
        points.quantity(value, 'mass_a', positive=True)


def test_a_length_may_be_zero_and_come_in_numbers():
    assert float(points.quantity(0, 'reach')) == 0.0
    assert points.quantity([1, 2], 'reach').tolist() == [1.0, 2.0]
    assert float(points.quantity(1e-60, 'mass', positive=True)) == 1e-60


@pytest.mark.parametrize(
    ('value', 'problem'),
    [
        (1j, 'must be real numbers'),
        ('1', 'must be real numbers'),
        (True, 'must be real numbers'),
        (None, 'must be real numbers'),
        ([1, '2'], 'must be real numbers'),
        ([1.0, [2.0]], 'must be real numbers'),
        (np.timedelta64(1, 's'), 'must be real numbers'),
        (np.datetime64('2026-01-01'), 'must be real numbers'),
        (np.ma.masked_array([1.0, 2.0], [False, True]), 'must be real numbers'),
        (10**400, 'must be real numbers'),
        pytest.param(10**5000, 'must be real numbers', id='digits'),
        pytest.param([10**5000, 1], 'must be real numbers', id='digits in a list'),
        (1.01e60, 'must be 0 or between 1e-60 and 1e+60 in size'),
        (0.99e-60, 'must be 0 or between 1e-60 and 1e+60 in size'),
        (5e-324, 'must be 0 or between 1e-60 and 1e+60 in size'),
    ],
)
def test_what_is_no_real_number_in_range_is_refused_by_name(value, problem):
    with pytest.raises(ValueError, match=refusal(f'reach: {problem}')):
        points.quantity(value, 'reach')
    if not isinstance(value, (list, np.ndarray)):
        with pytest.raises(ValueError, match=refusal(f'center: {problem}')):
            points.components([value, value], 'center')


def test_fractions_and_whole_numbers_are_real():
    assert points.quantity([Fraction(1, 2), 10**30], 'reach').tolist() == [0.5, 1e30]
    assert points.quantity(np.array([3], dtype=np.uint8), 'reach').tolist() == [3.0]


def test_the_largest_and_smallest_sizes_give_finite_times_and_right_contacts():
    assert time_to_touch((1e60, 0), (-1e-60, 0), 1e-60) == pytest.approx(1e120)
    assert time_to_touch((1e60, 0), (-1e60, 0), 5e59) == 0.5
    assert time_to_touch((3e-60, 0), (-1e-60, 0), 1e-60) == pytest.approx(2.0)
    assert in_contact((3e-60, 0), 1e-60, (0, 0), 1e-60) is False
    assert in_contact((1e60, 0), 1e60, (-1e60, 0), 1e60) is True
    before = ((1.0, 0.0), (-1.0, 0.0), 1e-60, 1e-60, (1e-200, 0.0))
    assert np.array(exchange(*before)).tolist() == [[-1.0, 0.0], [1.0, 0.0]]
    # The second component is in no range, but the vector is; what lies between the two centres is not.
    with pytest.raises(ValueError, match=r'^center_b - center_a: must be 0 or'):
        in_contact((1.0, 1e-200), 0.0, (1.0, 3e-200), 0.0)


@pytest.mark.parametrize('value', [(0.0, 0.0), (0.0, -0.0), ((1.0, 0.0), (0.0, 0.0))])
def test_the_zero_vector_has_no_direction(value):
    with pytest.raises(ValueError, match=refusal('normal: must not be the zero vector')):
        points.direction(value, 'normal')


@pytest.mark.parametrize('size', [5e-324, 1e-310, 1e-200, 0.3, 1.0, 7e5, 1e200, 1.7e308])
def test_a_direction_is_scaled_so_that_its_square_can_be_taken(size):
    for value in ((size, 0.0), (0.0, -size), (-size, size)):
        x, y = points.direction(value, 'normal')
        assert 0.25 <= x * x + y * y <= 2.0
        assert math.atan2(y, x) == math.atan2(value[1], value[0])


def test_a_direction_keeps_every_digit():
    rng = np.random.default_rng(5)
    values = rng.normal(size=(200, 2)) * 10.0 ** rng.uniform(-8, 8, (200, 1))
    x, y = points.direction(values, 'normal')
    # Scaled by a power of two: the quotient of the components does not change.
    assert (y / x == values[:, 1] / values[:, 0]).all()
    assert (np.sign(x) == np.sign(values[:, 0])).all()


def test_one_result_is_a_plain_number_and_many_are_an_array():
    assert type(points.plain(np.float64(2.0))) is float
    assert type(points.plain(np.array(True))) is bool
    many = np.array((1.0, 2.0))
    assert points.plain(many) is many
