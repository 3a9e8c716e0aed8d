"""What a good file says is what the scene has."""

import math
from pathlib import Path

import pytest

from circle_bounce_ros.kernel import Circle, Wall
from circle_bounce_ros.scene_file import load_scene, reading, scene_names

CIRCLE = 'circles: [{position: [0, 0], radius: 1}]\n'


def test_a_scene_has_what_the_file_says(write):
    path = write(
        'description: all there is\n'
        'circles:\n'
        '- {name: a_1, position: [1, -2.5], velocity: [1e-3, -.5], radius: 0.25, mass: 2}\n'
        '- {position: [-1, 0], radius: 5e-1, locked: true}\n'
        'walls:\n'
        '- {start: [10, 0], end: [10, 5]}\n'
        'moving_circles_collide: false\n'
        'restart_after: 12.5\n'
        'seed: 7\n',
        'my_scene.yaml',
    )
    scene = load_scene(path)
    assert scene.circles == (
        Circle((1.0, -2.5), (0.001, -0.5), radius=0.25, mass=2.0, name='a_1'),
        Circle((-1.0, 0.0), radius=0.5, locked=True),
    )
    assert scene.walls == (Wall((10.0, 0.0), (10.0, 5.0)),)
    assert scene.moving_circles_collide is False
    assert scene.restart_after == 12.5
    assert scene.name == 'my_scene'
    assert scene.seed is None  # no group has drawn from it


def test_what_the_file_does_not_say_has_its_default(write):
    scene = load_scene(write(CIRCLE))
    assert scene.circles == (Circle((0.0, 0.0), (0.0, 0.0), radius=1.0, mass=1.0),)
    assert scene.walls == ()
    assert scene.moving_circles_collide is True
    assert scene.restart_after == math.inf


def test_a_box_is_four_walls_counter_clockwise_from_the_bottom(write):
    scene = load_scene(write(CIRCLE + 'walls: [{box: {min: [-3, -2], max: [3, 2]}}]\n'))
    assert scene.walls == (
        Wall((-3.0, -2.0), (3.0, -2.0)),
        Wall((3.0, -2.0), (3.0, 2.0)),
        Wall((3.0, 2.0), (-3.0, 2.0)),
        Wall((-3.0, 2.0), (-3.0, -2.0)),
    )


def test_a_polygon_is_closed(write):
    scene = load_scene(write(CIRCLE + 'walls: [{polygon: [[-9, -9], [9, -9], [0, 9]]}]\n'))
    assert scene.walls == (
        Wall((-9.0, -9.0), (9.0, -9.0)),
        Wall((9.0, -9.0), (0.0, 9.0)),
        Wall((0.0, 9.0), (-9.0, -9.0)),
    )


def test_a_path_is_taken_from_the_working_directory(write, monkeypatch):
    monkeypatch.chdir(write(CIRCLE).parent)
    for path in ('scene.yaml', './scene.yaml', Path('scene.yaml')):
        assert load_scene(path).name == 'scene'


def test_a_file_of_a_packaged_name_does_not_hide_the_packaged_scene(write, monkeypatch):
    monkeypatch.chdir(write(CIRCLE, 'lesson').parent)
    assert load_scene('lesson').circles[0].name == 'green'
    assert load_scene('./lesson').circles[0].name is None


def test_the_packaged_scenes_are_named():
    assert set(scene_names()) >= {
        'lesson',
        'pegboard',
        'gas',
        'mixed',
        'break',
        'digits_of_pi',
        'billiard',
    }


@pytest.mark.parametrize(
    ('text', 'value'),
    [
        ('1e-3', 0.001),  # text by YAML 1.1
        ('1E3', 1000.0),
        ('+.5', 0.5),
        ('-1.', -1.0),
        ('010', 10),  # eight by YAML 1.1
        ('-0', 0),
        ('12345678901234567890123', 1.2345678901234567e22),
        ('1:30', '1:30'),  # ninety by YAML 1.1
        ('1_000', '1_000'),  # a thousand by YAML 1.1
        ('yes', 'yes'),  # true by YAML 1.1
        ('off', 'off'),
        ('2001-01-01', '2001-01-01'),  # a date by YAML 1.1
        ('0x10', '0x10'),
        ('nan', 'nan'),
        ('True', True),
        ('~', None),
        ("'1'", '1'),
        ('"true"', 'true'),
        ('|\n  1\n', '1\n'),
    ],
)
def test_plain_words_mean_what_yaml_1_2_says(text, value):
    read = reading.parse(f'key: {text}')['key']
    assert read == value
    assert type(read) is type(value)


def test_a_byte_order_mark_and_windows_line_ends_do_no_harm(tmp_path):
    path = tmp_path / 'windows.yaml'
    path.write_bytes(b'\xef\xbb\xbf' + CIRCLE.replace('\n', '\r\n').encode())
    assert load_scene(path).circles == (Circle((0.0, 0.0), radius=1.0),)


def test_ten_thousand_circles_are_read_in_a_few_seconds(write):
    # No clock is read: with work in proportion to the square this would take minutes.
    text = ''.join(
        f'- {{position: [{i % 100}, {i // 100}], radius: 0.4}}\n' for i in range(10_000)
    )
    assert len(load_scene(write('circles:\n' + text)).circles) == 10_000
