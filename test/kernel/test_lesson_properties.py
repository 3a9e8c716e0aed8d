"""The lesson's formulas over input that hypothesis makes up, searching for the worst."""

import math
from fractions import Fraction

import numpy as np
import pytest
from lesson_oracles import ULP, exact_time_to_touch

pytest.importorskip(
    'hypothesis', reason='hypothesis is not part of the environment of numpy and pytest only'
)

from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from circle_bounce_ros.kernel import (
    bounce_angles,
    boxes_overlap,
    contact_normal,
    contact_point,
    distance,
    exchange,
    in_contact,
    reflect,
    reflect_by_angles,
    time_to_touch,
)

# The same examples in every run: what is red here is red everywhere.
settings.register_profile('kernel', derandomize=True, deadline=None, max_examples=300)
KERNEL = settings.get_profile('kernel')

# Smaller numbers than 1e-60 are out of range.
coordinate = st.floats(-1e6, 1e6).map(lambda x: x if abs(x) >= 1e-60 else 0.0)
vector = st.tuples(coordinate, coordinate)
direction = vector.filter(lambda v: max(map(abs, v)) > 1e-100)  # squares of it can be taken below
length = st.floats(0, 1e6).map(lambda x: x if x >= 1e-60 else 0.0)
mass = st.floats(1e-3, 1e3)


def size(*vectors):
    return sum(math.hypot(*v) for v in vectors)


@given(vector, direction)
@example((0.0, 0.0), (1.0, 0.0))
@example((-1.0, -0.0), (-1.0, 0.0))
@example((1.0, 1.0), (-1.0, -1.0))
@settings(KERNEL)
def test_vector_form_and_angle_form_agree(velocity, normal):  # lesson eq. 2.1-2.4
    # A_pc is below 5 pi, where an ulp is 8 times that of 1, and gathers a few of them.
    # What is below 1e-300 m/s has fewer digits.
    close = 32 * ULP * size(velocity) + 1e-300
    assert reflect(velocity, normal) == pytest.approx(
        reflect_by_angles(velocity, normal), abs=close
    )


@given(vector, direction)
@settings(KERNEL)
def test_speed_is_unchanged_to_the_last_digits(velocity, normal):  # lesson, completely elastic
    # About ten roundings; what is below 1e-300 m/s has no more digits.
    close = {'rel': 4 * ULP, 'abs': 1e-300}
    assert size(reflect(velocity, normal)) == pytest.approx(size(velocity), **close)
    assert size(reflect_by_angles(velocity, normal)) == pytest.approx(size(velocity), **close)


@given(vector, direction)
@settings(KERNEL)
def test_across_changes_sign_and_along_stays(velocity, normal):  # lesson, tilted surface
    x, y = reflect(velocity, normal)
    nx, ny = normal
    close = 16 * ULP * size(velocity) * size(normal)  # products of a dozen roundings
    across = -(velocity[0] * nx + velocity[1] * ny)
    assert x * nx + y * ny == pytest.approx(across, abs=close)
    along = velocity[0] * ny - velocity[1] * nx
    assert x * ny - y * nx == pytest.approx(along, abs=close)


@given(vector, direction)
@settings(KERNEL)
def test_reflecting_twice_gives_the_velocity_back(velocity, normal):
    again = reflect(reflect(velocity, normal), normal)
    assert again == pytest.approx(velocity, abs=16 * ULP * size(velocity))  # twice ten roundings


@given(vector, direction)
@settings(KERNEL)
def test_the_angles_lie_in_their_ranges_and_follow_the_equations(velocity, normal):  # eq. 2.1-2.4
    a_v, a_n, a_d, a_pc = bounce_angles(velocity, normal)
    assert -math.pi <= a_v <= math.pi
    assert -math.pi <= a_n <= math.pi
    assert size(velocity) * math.cos(a_v) == pytest.approx(
        velocity[0], abs=4 * ULP * size(velocity)
    )
    assert size(normal) * math.sin(a_n) == pytest.approx(normal[1], abs=4 * ULP * size(normal))
    assert a_d == pytest.approx(a_v - a_n, abs=4 * ULP)
    assert a_pc == pytest.approx(2 * a_n - a_v + math.pi, abs=32 * ULP)  # below 16 rad


@given(vector, length, vector, length)
@settings(KERNEL)
def test_squares_and_exact_arithmetic_agree(a, radius_a, b, radius_b):  # lesson eq. 1.3-1.5
    exact_sq = (Fraction(b[0]) - Fraction(a[0])) ** 2 + (Fraction(b[1]) - Fraction(a[1])) ** 2
    exact = exact_sq - (Fraction(radius_a) + Fraction(radius_b)) ** 2
    # Half a dozen roundings of the squares decide nothing but what is that close. Squares below
    # 1e-300 have no digits.
    assume(abs(exact) > 8 * Fraction(ULP) * exact_sq + Fraction(1e-300))
    assert in_contact(a, radius_a, b, radius_b) == (exact <= 0)
    assert in_contact(b, radius_b, a, radius_a) == (exact <= 0)


@given(vector, length, vector, length)
@settings(KERNEL)
def test_bounding_squares_never_miss_a_contact(a, radius_a, b, radius_b):
    reach = radius_a + radius_b
    # Whose squares vanish touches anything.
    assume(max(abs(b[0] - a[0]), abs(b[1] - a[1]), reach) > 1e-150)
    # Of a contact within the rounding of a square, the boxes may just not know.
    if in_contact(a, radius_a, b, radius_b) and distance(a, b) < reach * (1 - 2 * ULP):
        assert boxes_overlap(a, radius_a, b, radius_b)


@given(vector, vector)
@settings(KERNEL)
def test_normal_has_length_one_and_turns_with_the_order(a, b):
    assume(a != b)
    normal = contact_normal(a, b)
    assert size(normal) == pytest.approx(1.0, abs=2 * ULP)  # two quotients by one root
    assert (contact_normal(b, a) == -normal).all()


@given(vector, vector, st.just(0.0) | st.floats(1e-6, 1))
@settings(KERNEL)
def test_contact_point_lies_between_the_centres(a, b, share):
    assume(a != b)
    reach = distance(a, b)
    assume(reach > 1e-50)  # a part of it is in range
    point = contact_point(a, share * reach, b)
    close = 8 * ULP * (size(a, b) + reach)  # an ulp or two of each coordinate
    assert distance(a, point) == pytest.approx(share * reach, abs=close)
    assert distance(point, b) == pytest.approx((1 - share) * reach, abs=close)


@given(vector, vector, mass, mass, direction)
@settings(KERNEL)
def test_two_free_circles_keep_momentum_and_energy(a, b, mass_a, mass_b, normal):
    after_a, after_b = exchange(a, b, mass_a, mass_b, normal)
    # A dozen roundings; the momentum that passes is at most the lighter mass times both speeds.
    passed = 2 * min(mass_a, mass_b) * size(a, b)
    close = 16 * ULP * (mass_a * size(a) + mass_b * size(b) + passed)
    total = mass_a * np.array(a) + mass_b * np.array(b)
    assert mass_a * after_a + mass_b * after_b == pytest.approx(total, abs=close)
    energy = 0.5 * (mass_a * size(a) ** 2 + mass_b * size(b) ** 2)
    after = 0.5 * (mass_a * size(after_a) ** 2 + mass_b * size(after_b) ** 2)
    assert after == pytest.approx(energy, rel=32 * ULP, abs=1e-300)


@given(vector, vector, mass, mass, direction)
@settings(KERNEL)
def test_two_free_circles_part_as_fast_as_they_came(a, b, mass_a, mass_b, normal):
    after_a, after_b = exchange(a, b, mass_a, mass_b, normal)
    came = np.dot(np.subtract(a, b), normal)
    part = np.dot(after_b - after_a, normal)
    assert part == pytest.approx(came, abs=32 * ULP * size(a, b) * size(normal))


@given(vector, vector, st.floats(1e-3, 1e6))
@settings(KERNEL)
def test_time_to_touch_against_exact_arithmetic(offset, velocity, reach):
    assume(size(velocity) > 1e-50)  # slower ones have squares without digits
    assume(size(offset) > reach * (1 + 1e-9))
    exact, slant = exact_time_to_touch(offset, velocity, reach)
    time = time_to_touch(offset, velocity, reach)
    # The nearest that a miss may come to the reach, or a contact to a graze, by rounding.
    unsure = 1e-6 * math.sqrt(1.0 + size(offset) / reach)
    if exact == math.inf:
        if time < math.inf:
            nearest = abs(offset[0] * velocity[1] - offset[1] * velocity[0]) / size(velocity)
            assert nearest == pytest.approx(reach, rel=unsure, abs=0)
    elif slant > unsure:
        close = 16 * ULP * (size(offset) + reach) / size(velocity) / slant
        assert time == pytest.approx(exact, abs=close)
