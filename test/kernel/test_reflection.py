"""What happens at a contact: lesson eq. 2.1-2.4, the vector form, and two free circles."""

import math
import random
from fractions import Fraction

import numpy as np
import pytest
from lesson_oracles import ULP, refusal

from circle_bounce_ros.kernel import reflection

PI = math.pi


def random_vectors(count, seed):
    rng = random.Random(seed)
    return [(rng.gauss(0, 1), rng.gauss(0, 1)) for _ in range(count)]


def at_angle(degrees, length=1.0):
    return (length * math.cos(math.radians(degrees)), length * math.sin(math.radians(degrees)))


def both_forms():
    return (reflection.reflect, reflection.reflect_by_angles)


# flat surfaces


def test_horizontal_surface_changes_the_sign_of_the_vertical_component():  # lesson, horizontal
    for velocity in [(3.0, -4.0), (-3.0, -4.0), (3.0, 4.0), (0.0, -2.0), (5.0, 0.0)]:
        for normal in [(0.0, -1.0), (0.0, 1.0), (0.0, -7.0)]:
            after = reflection.reflect(velocity, normal)
            assert after.tolist() == [velocity[0], -velocity[1]]
            # Sine and cosine of angles near 2 pi: a few ulp of a speed below 8 m/s.
            after = reflection.reflect_by_angles(velocity, normal)
            assert after == pytest.approx([velocity[0], -velocity[1]], abs=32 * ULP)


def test_vertical_surface_changes_the_sign_of_the_horizontal_component():  # lesson, tilted
    for velocity in [(3.0, -4.0), (-3.0, -4.0), (3.0, 4.0), (0.0, -2.0), (5.0, 0.0)]:
        for normal in [(1.0, 0.0), (-1.0, 0.0), (0.125, 0.0)]:
            after = reflection.reflect(velocity, normal)
            assert after.tolist() == [-velocity[0], velocity[1]]
            after = reflection.reflect_by_angles(velocity, normal)
            assert after == pytest.approx([-velocity[0], velocity[1]], abs=32 * ULP)


def test_surface_at_45_degrees_swaps_the_components():  # lesson, tilted
    assert reflection.reflect((3.0, -4.0), (1.0, -1.0)).tolist() == [-4.0, 3.0]
    assert reflection.reflect((3.0, -4.0), (1.0, 1.0)).tolist() == [4.0, -3.0]


def test_tilted_surface_changes_the_sign_across_and_keeps_along():  # lesson, tilted
    # Of the surface along (3, 4) / 5 the normal is (-4, 3) / 5. Velocity: 2 along, 5 across.
    along, across = (0.6, 0.8), (-0.8, 0.6)
    before = [2.0 * along[k] - 5.0 * across[k] for k in (0, 1)]
    after = [2.0 * along[k] + 5.0 * across[k] for k in (0, 1)]
    for form in both_forms():
        assert form(before, (-4.0, 3.0)) == pytest.approx(after, abs=32 * ULP)  # speed 5.4 m/s
        assert form(before, (4.0, -3.0)) == pytest.approx(after, abs=32 * ULP)


def test_any_tilt_changes_the_sign_across_and_keeps_along():  # lesson, tilted
    for vx, vy in random_vectors(20, 1):
        for degrees in range(0, 360, 7):
            along, across = at_angle(degrees), at_angle(degrees + 90)
            for form in both_forms():
                x, y = form((vx, vy), across)
                speed = math.hypot(vx, vy)
                # Projections of three rounded vectors.
                kept = vx * along[0] + vy * along[1]
                assert x * along[0] + y * along[1] == pytest.approx(kept, abs=16 * ULP * speed)
                turned = -(vx * across[0] + vy * across[1])
                assert x * across[0] + y * across[1] == pytest.approx(turned, abs=16 * ULP * speed)


# the angle form, step by step


# A velocity and a normal; A_v, A_n, A_d, A_pc in degrees by hand; the direction of A_pc by hand.
BY_HAND = [
    # first quadrant: flying up right into a circle that lies to the right
    ((1, 1), (1, 0), 45, 0, 45, 45 - 90 + 180, (-1, 1)),
    # second quadrant: up left into a circle above
    ((-1, 1), (0, 1), 135, 90, 45, 135 - 90 + 180, (-1, -1)),
    # third quadrant: down left into a circle below
    ((-1, -1), (0, -1), -135, -90, -45, -135 + 90 + 180, (-1, 1)),
    # third quadrant against a normal of the second: the difference goes past a half turn
    ((-1, -1), (-1, 1), -135, 135, -270, -135 + 540 + 180, (-1, -1)),
    # fourth quadrant: down right into a circle to the lower right, head on
    ((1, -1), (1, -1), -45, -45, 0, -45 + 180, (-1, 1)),
    # along each axis, into a circle at a diagonal
    ((1, 0), (1, 1), 0, 45, -45, 90 + 180, (0, -1)),
    ((0, 1), (1, 1), 90, 45, 45, 90 - 90 + 180, (-1, 0)),
    ((-1, 0), (-1, 1), 180, 135, 45, 180 - 90 + 180, (0, -1)),
    ((0, -1), (1, -1), -90, -45, -45, -90 + 90 + 180, (-1, 0)),
    # along each axis, head on
    ((1, 0), (1, 0), 0, 0, 0, 180, (-1, 0)),
    ((0, 1), (0, 1), 90, 90, 0, 270, (0, -1)),
    ((-1, 0), (-1, 0), 180, 180, 0, 360, (1, 0)),
    ((0, -1), (0, -1), -90, -90, 0, 90, (0, 1)),
    # a graze: the normal lies across the velocity
    ((1, 0), (0, 1), 0, 90, -90, 180 + 180, (1, 0)),
]  # fmt: skip


@pytest.mark.parametrize(('velocity', 'normal', 'a_v', 'a_n', 'a_d', 'a_pc', 'after'), BY_HAND)
def test_angle_form_step_by_step(velocity, normal, a_v, a_n, a_d, a_pc, after):  # eq. 2.1-2.4
    angles = reflection.bounce_angles(velocity, normal)
    # Each angle is below 11 rad and gathers at most five roundings.
    close = 32 * ULP
    assert angles.velocity == pytest.approx(math.radians(a_v), abs=close)  # lesson eq. 2.1
    assert angles.normal == pytest.approx(math.radians(a_n), abs=close)  # lesson eq. 2.2
    assert angles.difference == pytest.approx(math.radians(a_d), abs=close)  # lesson eq. 2.3
    assert angles.after == pytest.approx(math.radians(a_pc), abs=close)  # lesson eq. 2.4
    for form in both_forms():
        assert form(velocity, normal) == pytest.approx(after, abs=close)


def test_angles_of_30_and_60_degrees():  # lesson eq. 2.1-2.4
    velocity, normal = (math.sqrt(3.0), 1.0), (0.5, math.sqrt(3.0) / 2.0)
    angles = reflection.bounce_angles(velocity, normal)
    # 30, 60, 30 - 60 = -30, and 30 + 60 + 180 = 270 degrees: straight down at speed 2.
    assert angles == pytest.approx((PI / 6, PI / 3, -PI / 6, 3 * PI / 2), abs=16 * ULP)
    for form in both_forms():
        assert form(velocity, normal) == pytest.approx((0.0, -2.0), abs=16 * ULP)


@pytest.mark.parametrize('quadrant', range(4))
def test_angles_are_safe_in_all_four_quadrants(quadrant):  # lesson eq. 2.1, 2.2
    for step in range(1, 18):
        degrees = 90 * quadrant + 5 * step
        expected = math.radians(degrees if degrees <= 180 else degrees - 360)
        vector = at_angle(degrees, 3.0)
        assert reflection.bounce_angles(vector, (1, 0)).velocity == pytest.approx(
            expected, abs=4 * ULP
        )
        assert reflection.bounce_angles((1, 0), vector).normal == pytest.approx(
            expected, abs=4 * ULP
        )


def test_new_components_are_old_speed_times_cosine_and_sine():  # lesson, after eq. 2.4
    for velocity, normal in zip(random_vectors(200, 2), random_vectors(200, 3), strict=True):
        after = reflection.bounce_angles(velocity, normal).after
        speed = math.hypot(*velocity)
        expected = (speed * math.cos(after), speed * math.sin(after))
        # numpy and math may round a cosine apart by an ulp.
        assert reflection.reflect_by_angles(velocity, normal) == pytest.approx(
            expected, abs=4 * ULP * speed
        )


def test_the_angle_out_is_the_angle_in():  # lesson eq. 2.3, 2.4
    # Measured from the normal turned round, on the other side of it.
    for degrees in range(-85, 86, 5):
        normal = at_angle(20.0)
        velocity = at_angle(20.0 + degrees, 2.0)
        for form in both_forms():
            expected = at_angle(20.0 + 180.0 - degrees, 2.0)
            assert form(velocity, normal) == pytest.approx(expected, abs=32 * ULP)


# the vector form


def test_vector_form_against_exact_arithmetic():  # lesson, v - 2 (v.n) n
    for velocity, normal in zip(random_vectors(200, 4), random_vectors(200, 5), strict=True):
        vx, vy, nx, ny = map(Fraction, (*velocity, *normal))
        push = 2 * (vx * nx + vy * ny) / (nx * nx + ny * ny)
        expected = (float(vx - push * nx), float(vy - push * ny))
        speed = math.hypot(*velocity)
        # About ten roundings, each of at most the speed.
        assert reflection.reflect(velocity, normal) == pytest.approx(expected, abs=8 * ULP * speed)


def test_vector_form_and_angle_form_agree():  # lesson, each is the other's oracle
    for velocity, normal in zip(random_vectors(500, 6), random_vectors(500, 7), strict=True):
        speed = math.hypot(*velocity)
        # A_pc is below 5 pi, where an ulp is 8 times that of 1, and gathers a few of them.
        assert reflection.reflect(velocity, normal) == pytest.approx(
            reflection.reflect_by_angles(velocity, normal), abs=32 * ULP * speed
        )


def test_speed_is_unchanged_to_the_last_digits():  # lesson, completely elastic
    for velocity, normal in zip(random_vectors(500, 8), random_vectors(500, 9), strict=True):
        speed = math.hypot(*velocity)
        # About ten roundings in the one, a cosine and a sine in the other.
        assert math.hypot(*reflection.reflect(velocity, normal)) == pytest.approx(
            speed, rel=4 * ULP, abs=0
        )
        assert math.hypot(*reflection.reflect_by_angles(velocity, normal)) == pytest.approx(
            speed, rel=4 * ULP, abs=0
        )


def test_reflecting_twice_gives_the_velocity_back():  # lesson, same line
    for velocity, normal in zip(random_vectors(300, 10), random_vectors(300, 11), strict=True):
        for form in both_forms():
            again = form(form(velocity, normal), normal)
            assert again == pytest.approx(velocity, abs=64 * ULP * math.hypot(*velocity))


def test_length_and_sense_of_the_normal_do_not_matter():  # lesson, only the positions matter
    for velocity, (nx, ny) in zip(random_vectors(100, 12), random_vectors(100, 13), strict=True):
        expected = reflection.reflect(velocity, (nx, ny)).tolist()
        for scale in (-1.0, 2.0**-1000, -(2.0**-540), 2.0**30, 2.0**1000):
            assert reflection.reflect(velocity, (scale * nx, scale * ny)).tolist() == expected
        for scale in (-1.0, 2.0**-1000, 2.0**1000):
            again = reflection.reflect_by_angles(velocity, (scale * nx, scale * ny))
            assert again == pytest.approx(expected, abs=32 * ULP * math.hypot(*velocity))


def test_the_face_gives_the_digits_of_the_helper_that_the_engine_calls():
    for velocity, normal in zip(random_vectors(100, 14), random_vectors(100, 15), strict=True):
        helper = reflection.reflect_xy(*velocity, *normal)
        assert reflection.reflect(velocity, normal).tolist() == list(helper)
        before = (*velocity, *normal)
        helper = reflection.exchange_xy(*before, 2.0, 3.0, *normal)
        after = reflection.exchange(velocity, normal, 2.0, 3.0, normal)
        assert np.concatenate(after).tolist() == list(helper)


def test_a_body_at_rest_stays_at_rest():
    for form in both_forms():
        assert form((0.0, 0.0), (3.0, 4.0)).tolist() == [0.0, 0.0]


def test_it_always_reflects_whether_bodies_approach_or_not():  # lesson, both are pure
    for form in both_forms():
        assert form((-1.0, 0.0), (1.0, 0.0)) == pytest.approx((1.0, 0.0), abs=4 * ULP)
        assert form((1.0, 0.0), (1.0, 0.0)) == pytest.approx((-1.0, 0.0), abs=4 * ULP)


# two free circles


def random_collisions(count, seed):
    rng = random.Random(seed)
    for _ in range(count):
        a, b, normal = ((rng.gauss(0, 1), rng.gauss(0, 1)) for _ in 'abn')
        yield a, b, 10.0 ** rng.uniform(-3, 3), 10.0 ** rng.uniform(-3, 3), normal


def energy(mass_a, a, mass_b, b):
    return 0.5 * (mass_a * (a[0] ** 2 + a[1] ** 2) + mass_b * (b[0] ** 2 + b[1] ** 2))


def test_equal_masses_swap_the_components_along_the_normal():
    a, b = reflection.exchange((3.0, 1.0), (-2.0, 5.0), 2.0, 2.0, (1.0, 0.0))
    assert (a.tolist(), b.tolist()) == ([-2.0, 1.0], [3.0, 5.0])
    a, b = reflection.exchange((3.0, 1.0), (-2.0, 5.0), 7.0, 7.0, (0.0, -3.0))
    assert (a.tolist(), b.tolist()) == ([3.0, 5.0], [-2.0, 1.0])
    # Along (1, 1): a has 2 along and 1 across (times the root of 2), b has 1.5 and -3.5.
    a, b = reflection.exchange((3.0, 1.0), (-2.0, 5.0), 1.0, 1.0, (1.0, 1.0))
    assert (a.tolist(), b.tolist()) == ([2.5, 0.5], [-1.5, 5.5])


def test_one_of_two_equal_masses_at_rest_takes_all_head_on():
    a, b = reflection.exchange((5.0, 0.0), (0.0, 0.0), 3.0, 3.0, (1.0, 0.0))
    assert (a.tolist(), b.tolist()) == ([0.0, 0.0], [5.0, 0.0])


@pytest.mark.parametrize(
    ('mass_a', 'mass_b', 'a', 'b', 'expected_a', 'expected_b'),
    [
        # ((m_a - m_b) a + 2 m_b b) / (m_a + m_b), and the same with a and b exchanged.
        (1.0, 3.0, 4.0, 0.0, -2.0, 2.0),
        (3.0, 1.0, 4.0, 0.0, 2.0, 6.0),
        (1.0, 3.0, 4.0, -4.0, -8.0, 0.0),
        (1.0, 7.0, 0.0, -2.0, -3.5, -1.5),
        (5.0, 3.0, 1.0, -1.0, -0.5, 1.5),
    ],
)
def test_unequal_masses_follow_the_formula_of_one_dimension(
    mass_a, mass_b, a, b, expected_a, expected_b
):
    # What goes across the normal, 0.5 and -0.25, stays.
    for normal in [(1, 0), (-2, 0)]:
        after = reflection.exchange((a, 0.5), (b, -0.25), mass_a, mass_b, normal)
        assert [v.tolist() for v in after] == [[expected_a, 0.5], [expected_b, -0.25]]
    for normal in [(0, 3), (0, -1)]:
        after = reflection.exchange((0.5, a), (-0.25, b), mass_a, mass_b, normal)
        assert [v.tolist() for v in after] == [[0.5, expected_a], [-0.25, expected_b]]


def test_exchange_against_exact_arithmetic():
    for a, b, mass_a, mass_b, normal in random_collisions(200, 16):
        ax, ay, bx, by, ma, mb, nx, ny = map(Fraction, (*a, *b, mass_a, mass_b, *normal))
        # Through the frame in which the centre of mass rests: there both velocities reflect.
        cx, cy = (ma * ax + mb * bx) / (ma + mb), (ma * ay + mb * by) / (ma + mb)
        expected = []
        for vx, vy in ((ax - cx, ay - cy), (bx - cx, by - cy)):
            along = (vx * nx + vy * ny) / (nx * nx + ny * ny)
            expected.append((float(cx + vx - 2 * along * nx), float(cy + vy - 2 * along * ny)))
        after = reflection.exchange(a, b, mass_a, mass_b, normal)
        close = 16 * ULP * (math.hypot(*a) + math.hypot(*b))  # a dozen roundings of the speeds
        assert after[0] == pytest.approx(expected[0], abs=close)
        assert after[1] == pytest.approx(expected[1], abs=close)


def test_momentum_is_conserved():
    for a, b, mass_a, mass_b, normal in random_collisions(300, 17):
        after_a, after_b = reflection.exchange(a, b, mass_a, mass_b, normal)
        # A dozen roundings, each of at most the sum of the sizes.
        close = 16 * ULP * (mass_a * math.hypot(*a) + mass_b * math.hypot(*b))
        # What rounds in the heavy one's velocity counts with its mass and the other's speed.
        close += 16 * ULP * min(mass_a, mass_b) * (math.hypot(*a) + math.hypot(*b))
        for k in (0, 1):
            before = mass_a * a[k] + mass_b * b[k]
            assert mass_a * after_a[k] + mass_b * after_b[k] == pytest.approx(before, abs=close)


def test_kinetic_energy_is_conserved():
    for a, b, mass_a, mass_b, normal in random_collisions(300, 18):
        after_a, after_b = reflection.exchange(a, b, mass_a, mass_b, normal)
        before = energy(mass_a, a, mass_b, b)
        # Squares double the relative error of about a dozen roundings.
        assert energy(mass_a, after_a, mass_b, after_b) == pytest.approx(
            before, rel=32 * ULP, abs=0
        )


def test_what_goes_along_the_surface_stays():
    for a, b, mass_a, mass_b, (nx, ny) in random_collisions(300, 19):
        after = reflection.exchange(a, b, mass_a, mass_b, (nx, ny))
        for before, now in zip((a, b), after, strict=True):
            # Both components gather a dozen roundings of the speeds.
            close = 16 * ULP * math.hypot(nx, ny) * (math.hypot(*a) + math.hypot(*b))
            kept = before[0] * ny - before[1] * nx
            assert now[0] * ny - now[1] * nx == pytest.approx(kept, abs=close)


def test_they_part_as_fast_as_they_came():
    for a, b, mass_a, mass_b, (nx, ny) in random_collisions(300, 20):
        after_a, after_b = reflection.exchange(a, b, mass_a, mass_b, (nx, ny))
        came = (a[0] - b[0]) * nx + (a[1] - b[1]) * ny
        part = (after_b[0] - after_a[0]) * nx + (after_b[1] - after_a[1]) * ny
        close = 32 * ULP * math.hypot(nx, ny) * (math.hypot(*a) + math.hypot(*b))
        assert part == pytest.approx(came, abs=close)


def test_against_a_very_heavy_body_at_rest_it_is_a_reflection():
    for velocity, normal in zip(random_vectors(100, 21), random_vectors(100, 22), strict=True):
        expected = reflection.reflect(velocity, normal)
        speed = math.hypot(*velocity)
        for heavy in (1e6, 1e9, 1e18):
            light_after, heavy_after = reflection.exchange(velocity, (0, 0), 1.0, heavy, normal)
            # 2 / (1 + 1/M) differs from 2 by less than 2 / M.
            close = (2.0 / heavy + 8 * ULP) * speed
            assert light_after == pytest.approx(expected, abs=close)
            assert math.hypot(*heavy_after) <= 2.0 * speed / heavy * (1.0 + 8 * ULP)
            heavy_after, light_after = reflection.exchange((0, 0), velocity, heavy, 1.0, normal)
            assert light_after == pytest.approx(expected, abs=close)


def test_exchange_is_the_same_for_an_observer_in_motion():  # Galilean invariance
    drift = np.array((100.0, -40.0))
    for a, b, mass_a, mass_b, normal in random_collisions(200, 23):
        after = reflection.exchange(a, b, mass_a, mass_b, normal)
        moved = reflection.exchange(a + drift, b + drift, mass_a, mass_b, normal)
        for k in (0, 1):
            # Adding the drift rounds to its ulp, 64 times that of 1, and that grows a few times.
            assert moved[k] - drift == pytest.approx(after[k], abs=1000 * ULP)


def test_exchange_does_not_depend_on_who_is_called_a():
    for a, b, mass_a, mass_b, (nx, ny) in random_collisions(200, 24):
        after_a, after_b = reflection.exchange(a, b, mass_a, mass_b, (nx, ny))
        again_b, again_a = reflection.exchange(b, a, mass_b, mass_a, (-nx, -ny))
        assert (again_a.tolist(), again_b.tolist()) == (after_a.tolist(), after_b.tolist())


def test_exchanging_twice_gives_the_velocities_back():
    for a, b, mass_a, mass_b, normal in random_collisions(200, 25):
        after = reflection.exchange(a, b, mass_a, mass_b, normal)
        again = reflection.exchange(*after, mass_a, mass_b, normal)
        # Twice a dozen roundings of speeds of which the light one's may have tripled.
        close = 64 * ULP * (math.hypot(*a) + math.hypot(*b))
        assert again[0] == pytest.approx(a, abs=close)
        assert again[1] == pytest.approx(b, abs=close)


def test_the_impulse_is_twice_the_reduced_mass_times_the_approach():
    # 2 m_a m_b / (m_a + m_b) = 3 kg, approach 5 m/s along (3, 4) / 5: 15 N s, so (9, 12).
    mass_a, mass_b = 2.0, 6.0
    a, b = reflection.exchange((3.0, 4.0), (0.0, 0.0), mass_a, mass_b, (0.3, 0.4))
    assert [mass_b * v for v in b] == pytest.approx([9.0, 12.0], rel=8 * ULP, abs=0)
    assert [mass_a * v for v in a] == pytest.approx([6.0 - 9.0, 8.0 - 12.0], rel=8 * ULP, abs=0)


# one or many

COUNT = 30
V = np.array(random_vectors(COUNT, 31))
W = np.array(random_vectors(COUNT, 32))
N = np.array(random_vectors(COUNT, 33))
MASSES_A = np.random.default_rng(34).uniform(1, 5, COUNT)
MASSES_B = np.random.default_rng(35).uniform(1, 5, COUNT)


def test_many_vectors_give_what_one_by_one_gives():
    one_by_one = [reflection.reflect(v, n).tolist() for v, n in zip(V, N, strict=True)]
    assert reflection.reflect(V, N).tolist() == one_by_one
    # numpy's cosine of an array may differ from that of a number in the last digits.
    close = {'rel': 8 * ULP, 'abs': 8 * ULP}
    many = reflection.reflect_by_angles(V, N)
    for row, v, n in zip(many, V, N, strict=True):
        assert row == pytest.approx(reflection.reflect_by_angles(v, n), **close)
    many = reflection.bounce_angles(V, N)
    for k, (v, n) in enumerate(zip(V, N, strict=True)):
        one = reflection.bounce_angles(v, n)
        assert [angle[k] for angle in many] == pytest.approx(list(one), **close)


def test_many_collisions_give_what_one_by_one_gives():
    many_a, many_b = reflection.exchange(V, W, MASSES_A, MASSES_B, N)
    for k in range(COUNT):
        a, b = reflection.exchange(V[k], W[k], MASSES_A[k], MASSES_B[k], N[k])
        assert (many_a[k].tolist(), many_b[k].tolist()) == (a.tolist(), b.tolist())


def test_one_against_many_is_repeated():
    many_v, many_n = np.repeat(V[:1], COUNT, axis=0), np.repeat(N[:1], COUNT, axis=0)
    assert (reflection.reflect(V[0], N) == reflection.reflect(many_v, N)).all()
    assert (reflection.reflect(V, N[0]) == reflection.reflect(V, many_n)).all()
    close = {'rel': 8 * ULP, 'abs': 8 * ULP}  # as above
    assert reflection.reflect_by_angles(V[0], N) == pytest.approx(
        reflection.reflect_by_angles(many_v, N), **close
    )
    assert reflection.bounce_angles(V, N[0]).after == pytest.approx(
        reflection.bounce_angles(V, many_n).after, **close
    )
    a, b = reflection.exchange(V[0], W, 2.0, MASSES_B, N[0])
    expected_a, expected_b = reflection.exchange(many_v, W, np.full(COUNT, 2.0), MASSES_B, many_n)
    assert (a == expected_a).all()
    assert (b == expected_b).all()


def test_each_gives_both_as_arrays_even_if_one_only_is_many():
    a, b = reflection.exchange((1, 0), (0, 0), 1.0, (1.0, 3.0), (1, 0))
    assert (a.tolist(), b.tolist()) == ([[0.0, 0.0], [-0.5, 0.0]], [[1.0, 0.0], [0.5, 0.0]])


def test_one_gives_plain_shapes():
    assert reflection.reflect((1, 2), (0, 1)).shape == (2,)
    assert reflection.reflect_by_angles((1, 2), (0, 1)).shape == (2,)
    assert [type(angle) for angle in reflection.bounce_angles((1, 2), (0, 1))] == [float] * 4
    assert [v.shape for v in reflection.exchange((1, 2), (0, 0), 1, 2, (0, 1))] == [(2,), (2,)]


# bad input


@pytest.mark.parametrize(
    ('call', 'message'),
    [
        (
            lambda: reflection.reflect((1, 2, 3), (0, 1)),
            'velocity: must have shape (2,) or (n, 2)',
        ),
        (lambda: reflection.reflect((1, 2), (0, 0)), 'normal: must not be the zero vector'),
        (
            lambda: reflection.reflect((1, 2), (0, math.inf)),
            'normal: must be finite',
        ),
        (
            lambda: reflection.reflect_by_angles((math.nan, 2), (0, 1)),
            'velocity: must be finite',
        ),
        (
            lambda: reflection.reflect_by_angles((1, 2), (0, 0)),
            'normal: must not be the zero vector',
        ),
        (
            lambda: reflection.bounce_angles(1, (0, 1)),
            'velocity: must have shape (2,) or (n, 2)',
        ),
        (
            lambda: reflection.bounce_angles((1, 2), ((0, 1), (0, 0))),
            'normal: must not be the zero vector',
        ),
        (
            lambda: reflection.exchange((1, math.inf), (0, 0), 1, 1, (0, 1)),
            'velocity_a: must be finite',
        ),
        (
            lambda: reflection.exchange((1, 2), (0,), 1, 1, (0, 1)),
            'velocity_b: must have shape (2,) or (n, 2)',
        ),
        (
            lambda: reflection.exchange((1, 2), (0, 0), 0, 1, (0, 1)),
            'mass_a: must be > 0',
        ),
        (
            lambda: reflection.exchange((1, 2), (0, 0), 1, (1, -1), (0, 1)),
            'mass_b: must be > 0',
        ),
        (
            lambda: reflection.exchange((1, 2), (0, 0), 1, 1, (0, 0)),
            'normal: must not be the zero vector',
        ),
    ],
)
def test_bad_input_is_refused_with_place_rule_and_value(call, message):
    with pytest.raises(ValueError, match=refusal(message)):
        call()
