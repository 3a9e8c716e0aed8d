"""Circles, walls and scenes: frozen, and refused with place, rule and value when they are wrong."""

import copy
import dataclasses
import math
import pickle

import numpy as np
import pytest
from lesson_oracles import exactly

from circle_bounce_ros.kernel import Circle, Scene, SceneError, Wall
from circle_bounce_ros.kernel.scene import ALLOWED_OVERLAP, is_legal_name

MOVING = Circle((0.0, 0.0), (1.0, 0.0), radius=1.0)


def locked(x, y, radius=1.0, **more):
    return Circle((x, y), radius=radius, locked=True, **more)


def refused(message):
    return pytest.raises(SceneError, match=exactly(message))


# circles


def test_a_circle_has_defaults():
    circle = Circle((1.0, 2.0), radius=0.5)
    assert circle.position == (1.0, 2.0)
    assert circle.velocity == (0.0, 0.0)
    assert (circle.radius, circle.mass, circle.locked, circle.name) == (0.5, 1.0, False, None)


def test_a_circle_takes_any_kind_of_numbers_and_keeps_floats():
    given = Circle(
        np.array((1, 2)), [3, np.float32(4)], radius=1, mass=np.int64(2), locked=np.False_
    )
    plain = Circle((1.0, 2.0), (3.0, 4.0), radius=1.0, mass=2.0, locked=False)
    assert given == plain
    assert hash(given) == hash(plain)
    kept = (*given.position, *given.velocity, given.radius, given.mass)
    assert [type(number) for number in kept] == [float] * 6
    assert type(given.locked) is bool


def test_everything_is_frozen():
    scene = Scene([MOVING], [Wall((0, 5), (1, 5))])
    for thing, field in [(MOVING, 'radius'), (scene.walls[0], 'start'), (scene, 'circles')]:
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(thing, field, 1.0)


def test_a_scene_keeps_its_own_lists():
    circles, walls = [MOVING], [Wall((0, 5), (1, 5))]
    scene = Scene(circles, walls)
    circles.clear()
    walls.clear()
    assert scene.circles == (MOVING,)
    assert scene.walls == (Wall((0, 5), (1, 5)),)


@pytest.mark.parametrize(
    ('arguments', 'message'),
    [
        ({'position': (1,)}, 'position: must be two numbers, got (1,)'),
        ({'position': (1, 2, 3)}, 'position: must be two numbers, got (1, 2, 3)'),
        ({'position': 5}, 'position: must be two numbers, got 5'),
        ({'position': None}, 'position: must be two numbers, got None'),
        ({'position': ('1', 2)}, "position[0]: must be a number, got '1'"),
        ({'position': (1, True)}, 'position[1]: must be a number, got True'),
        ({'position': (1, [])}, 'position[1]: must be a number, got []'),
        ({'position': (math.nan, 0)}, 'position[0]: must be finite, got nan'),
        ({'position': (0, -math.inf)}, 'position[1]: must be finite, got -inf'),
        ({'position': (0, 2e60)}, 'position[1]: must be at most 1e+60 m in size, got 2e+60'),
        ({'velocity': (1,)}, 'velocity: must be two numbers, got (1,)'),
        ({'velocity': (math.inf, 0)}, 'velocity[0]: must be finite, got inf'),
        ({'velocity': (-2e60, 0)}, 'velocity[0]: must be at most 1e+60 m/s in size, got -2e+60'),
        ({'velocity': (10**400, 0)}, f'velocity[0]: must be a number, got {10**400}'),
        ({'radius': 0}, 'radius: must be > 0 m, got 0'),
        ({'radius': -0.1}, 'radius: must be > 0 m, got -0.1'),
        ({'radius': math.nan}, 'radius: must be finite, got nan'),
        ({'radius': math.inf}, 'radius: must be finite, got inf'),
        ({'radius': 'big'}, "radius: must be a number, got 'big'"),
        ({'radius': b'1'}, "radius: must be a number, got b'1'"),
        ({'radius': None}, 'radius: must be a number, got None'),
        ({'radius': False}, 'radius: must be a number, got False'),
        ({'radius': 1j}, 'radius: must be a number, got 1j'),
        ({'radius': 1e-61}, 'radius: must be at least 1e-60 m, got 1e-61'),
        ({'radius': 1.5e60}, 'radius: must be at most 1e+60 m in size, got 1.5e+60'),
        ({'mass': 0.0}, 'mass: must be > 0 kg, got 0'),
        ({'mass': -2}, 'mass: must be > 0 kg, got -2'),
        ({'mass': math.nan}, 'mass: must be finite, got nan'),
        ({'mass': 1e-99}, 'mass: must be at least 1e-60 kg, got 1e-99'),
        ({'locked': 'yes'}, "locked: must be true or false, got 'yes'"),
        ({'locked': 1}, 'locked: must be true or false, got 1'),
        (
            {'locked': True, 'velocity': (0.0, 1.0)},
            'velocity: must be (0, 0) for a locked circle, got (0.0, 1.0)',
        ),
        (
            {'name': '2nd'},
            "name: must be a letter followed by letters, digits or single underscores, got '2nd'",
        ),
    ],
)
def test_a_wrong_circle_is_refused_with_place_rule_and_value(arguments, message):
    with refused(message) as caught:
        Circle(**{'position': (0, 0), 'radius': 1.0} | arguments)
    place, problem = message.split(': ', 1)
    assert (caught.value.place, caught.value.problem) == (place, problem)


def test_truth_of_numpy_is_no_number():
    with refused(f'mass: must be a number, got {np.True_!r}'):
        Circle((0, 0), radius=1.0, mass=np.True_)


def test_the_largest_and_the_smallest_are_accepted():
    circle = Circle((1e60, -1e60), (-1e60, 1e60), radius=1e-60, mass=1e-60)
    assert circle.position == (1e60, -1e60)
    assert Circle((0, 0), radius=1e60, mass=1e60).radius == 1e60
    assert Wall((0, 0), (0, 1e-60)).end == (0.0, 1e-60)


def test_a_locked_circle_may_have_a_velocity_of_minus_zero():
    assert Circle((0, 0), (-0.0, 0.0), radius=1.0, locked=True).locked


# names


@pytest.mark.parametrize('name', ['g', 'G', 'green', 'Green2', 'a_b', 'a_', 'a_1_b', 'x9', 'Z_z'])
def test_legal_names_are_accepted(name):
    assert is_legal_name(name)
    assert Circle((0, 0), radius=1.0, name=name).name == name


@pytest.mark.parametrize(
    'name',
    ['', '_', '_a', '9', '9a', 'a b', 'a-b', 'a/b', '/a', '~a', 'a__b', 'a__', 'a.b', 'a{b}', ' a', 'a ']
    + ['a\n', '\u00e4', 'a\u00e4', '\u03b1', 'a\u00b2', 'a\u0661', '\u540d', b'a', 5, True, ('a',), ['a']],
)  # fmt: skip
def test_illegal_names_are_refused(name):
    assert not is_legal_name(name)
    rule = 'name: must be a letter followed by letters, digits or single underscores'
    with refused(f'{rule}, got {name!r}'):
        Circle((0, 0), radius=1.0, name=name)


def test_names_are_unique():
    circles = [
        Circle((0, 0), radius=1.0, name='green'),
        Circle((5, 0), radius=1.0),
        Circle((10, 0), radius=1.0),
        locked(15, 0, name='green'),
    ]
    with refused("circles[3].name: must be unique, got 'green' as for circles[0]"):
        Scene(circles)
    # Names differ by case, and many may have none.
    assert len(Scene([*circles[:3], locked(15, 0, name='Green')]).circles) == 4


def test_a_label_is_the_index_and_the_name():
    scene = Scene([MOVING, locked(5, 0, name='red')])
    assert scene.label(0) == 'circles[0]'
    assert scene.label(1) == 'circles[1] (red)'


# walls


def test_a_wall_keeps_floats():
    wall = Wall([0, 1], np.array((2, 3)))
    assert (wall.start, wall.end) == ((0.0, 1.0), (2.0, 3.0))
    assert [type(number) for number in wall.start + wall.end] == [float] * 4
    assert wall == Wall((0.0, 1.0), (2.0, 3.0))


@pytest.mark.parametrize(
    ('start', 'end', 'message'),
    [
        ((1, 2), (1, 2), 'end: must differ from start, got (1.0, 2.0) for both'),
        ((0, 0), (0, 1e-61), 'end: must differ from start, got (0.0, 1e-61) for both'),
        ((1,), (1, 2), 'start: must be two numbers, got (1,)'),
        ((1, 'x'), (1, 2), "start[1]: must be a number, got 'x'"),
        ((1, 2), (math.nan, 2), 'end[0]: must be finite, got nan'),
        ((1, 2), (0, 3e60), 'end[1]: must be at most 1e+60 m in size, got 3e+60'),
    ],
)
def test_a_wrong_wall_is_refused_with_place_rule_and_value(start, end, message):
    with refused(message):
        Wall(start, end)


# scenes


def test_a_scene_has_defaults():
    scene = Scene([MOVING])
    assert (scene.walls, scene.moving_circles_collide) == ((), True)
    assert (scene.name, scene.seed, scene.restart_after) == ('', None, math.inf)


def test_a_scene_carries_what_others_want_to_know():
    scene = Scene(
        iter([MOVING]), name='gas', seed=7, restart_after=30, moving_circles_collide=np.False_
    )
    assert (scene.name, scene.seed, scene.restart_after) == ('gas', 7, 30.0)
    assert scene.moving_circles_collide is False
    assert type(scene.restart_after) is float


@pytest.mark.parametrize(
    ('arguments', 'message'),
    [
        ({'circles': []}, 'circles: at least one must move, got none'),
        (
            {'circles': [locked(0, 0), locked(5, 0)]},
            'circles: at least one must move, got 2, all locked',
        ),
        ({'circles': [MOVING, 'red']}, 'circles[1]: must be a Circle, got str'),
        ({'walls': [MOVING]}, 'walls[0]: must be a Wall, got Circle'),
        (
            {'moving_circles_collide': 'no'},
            "moving_circles_collide: must be true or false, got 'no'",
        ),
        ({'moving_circles_collide': 0}, 'moving_circles_collide: must be true or false, got 0'),
        ({'restart_after': 0}, 'restart_after: must be > 0 s, got 0'),
        ({'restart_after': -1.5}, 'restart_after: must be > 0 s, got -1.5'),
        ({'restart_after': math.nan}, 'restart_after: must be > 0 s, got nan'),
        ({'restart_after': 'never'}, "restart_after: must be a number, got 'never'"),
        ({'restart_after': None}, 'restart_after: must be a number, got None'),
    ],
)
def test_a_wrong_scene_is_refused_with_place_rule_and_value(arguments, message):
    with refused(message):
        Scene(**{'circles': [MOVING]} | arguments)


# overlaps


def test_an_overlap_is_reported_with_names_and_depth():
    green = Circle((0.0, 0.0), radius=1.0, name='green')
    # Centres 5 apart; reach 5.25.
    with refused('circles[0] (green) and circles[1] (red): must not overlap, got 0.25 m'):
        Scene([green, locked(3, 4, radius=4.25, name='red')])
    with refused('circles[0] and circles[1] (green): must not overlap, got 0.25 m'):
        Scene([Circle((3, 4), radius=4.25), green])
    with refused('circles[1] (green) and walls[1]: must not overlap, got 0.5 m'):
        Scene(
            [Circle((9, 9), radius=1.0), green], [Wall((5, 5), (6, 5)), Wall((-3, 0.5), (3, 0.5))]
        )


def test_an_overlap_with_the_end_of_a_wall_is_reported():
    # The end is 5 from the centre; across the line that the wall lies on, 3.
    with refused('circles[0] and walls[0]: must not overlap, got 0.125 m'):
        Scene([Circle((0, 0), radius=5.125)], [Wall((4, 3), (9, 3))])
    Scene([Circle((0, 0), radius=5.0)], [Wall((4, 3), (9, 3))])


def test_the_deepest_overlap_is_the_one_reported():
    circles = [Circle((2.0 * k, 0.0), radius=1.0 + 0.01 * k) for k in range(5)]
    with refused('circles[3] and circles[4]: must not overlap, got 0.07 m'):
        Scene(circles)
    with refused('circles[0] and walls[0]: must not overlap, got 0.2 m'):
        Scene(circles, [Wall((-5, -0.8), (0, -0.8))])


def test_one_inside_another_is_an_overlap():
    with refused('circles[0] and circles[1]: must not overlap, got 3 m'):
        Scene([MOVING, locked(0, 0, radius=2.0)])


def test_touching_is_no_overlap():
    circles = [MOVING, Circle((3, 4), radius=4.0), locked(-2, 0)]
    assert len(Scene(circles, [Wall((0, -1), (9, -1)), Wall((-9, 1), (0, 1))]).circles) == 3


@pytest.mark.parametrize('radius', [2.0**-10, 0.5, 1.0, 1024.0])
def test_an_overlap_of_a_trillionth_of_the_smaller_radius_is_rounding(radius):
    assert ALLOWED_OVERLAP == 1e-12
    # Depths of 0.9e-12 and 1.2e-12 of the smaller radius: of the reach, three radii, a third of that.
    inside, outside = (3.0 * radius * (1.0 - share * 1e-12) for share in (0.3, 0.4))
    small = Circle((0, 0), radius=radius)
    Scene([small, locked(inside, 0, radius=2.0 * radius)])
    with pytest.raises(SceneError, match=r'circles\[0\] and circles\[1\]: must not overlap'):
        Scene([small, locked(outside, 0, radius=2.0 * radius)])
    inside, outside = (radius * (1.0 - share * 1e-12) for share in (0.9, 1.1))
    Scene([small], [Wall((-radius, inside), (radius, inside))])
    with pytest.raises(SceneError, match=r'circles\[0\] and walls\[0\]: must not overlap'):
        Scene([small], [Wall((-radius, outside), (radius, outside))])


def test_what_is_locked_may_overlap():
    posts = [locked(5, 0), locked(5.5, 0), locked(5, 0)]
    walls = [Wall((5, -3), (5, 3)), Wall((4, 0), (6, 0))]
    assert len(Scene([MOVING, *posts], walls).circles) == 4


def test_circles_that_pass_through_each_other_may_overlap_each_other_only():
    circles = [MOVING, Circle((0.5, 0), radius=1.0)]
    with refused('circles[0] and circles[1]: must not overlap, got 1.5 m'):
        Scene(circles)
    assert len(Scene(circles, moving_circles_collide=False).circles) == 2
    with refused('circles[1] and circles[2]: must not overlap, got 0.25 m'):
        Scene([*circles, locked(2.25, 0)], moving_circles_collide=False)
    with refused('circles[1] and walls[0]: must not overlap, got 0.5 m'):
        Scene(circles, [Wall((1, 0), (1, 1))], moving_circles_collide=False)


# the error itself


def test_an_error_can_be_seen_from_what_holds_the_place():
    error = SceneError('radius', 'must be > 0 m, got -0.1').within('circles[2]')
    assert str(error) == 'circles[2].radius: must be > 0 m, got -0.1'
    assert (error.place, error.problem) == ('circles[2].radius', 'must be > 0 m, got -0.1')
    whole = SceneError('', 'must not be empty')
    assert str(whole) == 'must not be empty'
    assert str(whole.within('lesson.yaml')) == 'lesson.yaml: must not be empty'
    assert isinstance(error, ValueError)


def test_an_error_comes_whole_out_of_another_process():
    error = SceneError('radius', 'must be > 0 m, got -0.1')
    for again in (pickle.loads(pickle.dumps(error)), copy.copy(error)):
        assert type(again) is SceneError
        assert str(again) == str(error)
        assert (again.place, again.problem) == (error.place, error.problem)


def test_a_scene_comes_whole_out_of_another_process():
    scene = Scene([MOVING, locked(5, 0, name='red')], [Wall((0, 5), (1, 5))], name='s', seed=1)
    assert pickle.loads(pickle.dumps(scene)) == scene


@pytest.mark.parametrize(
    'value',
    [
        pytest.param(10**5000, id='digits'),
        bytearray(b'1'),
        np.timedelta64(1, 's'),
        np.ma.masked,
        1j,
    ],
)
def test_what_is_no_number_is_a_scene_error(value):
    with pytest.raises(SceneError, match='must be a number') as refused:
        Circle((0.0, 0.0), radius=value)
    assert refused.value.place == 'radius'
    with pytest.raises(SceneError, match='must be a number') as refused:
        Circle((0.0, value), radius=1.0)
    assert refused.value.place == 'position[1]'


def test_numbers_of_thousands_of_digits_are_told_in_an_error():
    with pytest.raises(SceneError, match='must be two numbers'):
        Wall((10**5000, 0, 0), (1, 1))
    with pytest.raises(SceneError, match='must be true or false'):
        Circle((0, 0), radius=1.0, locked=10**5000)
    with pytest.raises(SceneError, match='must be a letter'):
        Circle((0, 0), radius=1.0, name=10**5000)
