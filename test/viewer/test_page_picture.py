"""The picture shows what the topics say, where they say it."""

import math
import time

import numpy as np
import pytest
from browsing import HIGH, PATIENCE, WIDE, text_of, wait_until
from observing import read_points
from picture import Picture, rgb
from sensor_msgs.msg import PointCloud2

# Seven circles, each in a lane of its own, so that a window around one never holds another.
LANES = range(7)
LANE = 0.5  # m
RADII = [0.08 + 0.015 * lane for lane in LANES]
SPEEDS = [0.5 + 0.1 * lane for lane in LANES]


@pytest.fixture
def lanes(tmp_path):
    path = tmp_path / 'lanes.yaml'
    circles = ''.join(
        f'  - {{position: [{-1 + 0.3 * lane}, {LANE * lane}], velocity: [{SPEEDS[lane]}, 0], '
        f'radius: {RADII[lane]}}}\n'
        for lane in LANES
    )
    path.write_text(
        f'circles:\n{circles}walls:\n  - box: {{min: [-2.5, -0.5], max: [2.5, 3.5]}}\n'
    )
    return path


def stamp(message):
    """Return the stamp of a message as the page has it."""
    return f'{message.header.stamp.sec}.{message.header.stamp.nanosec:09d}'


def draw_heard(page, observer, heard):
    """Return a picture of the page, and the points that it was drawn from by an own subscriber."""
    observer.spin_until(lambda: heard, 'a message')
    deadline = time.monotonic() + PATIENCE
    # What the page shows may have been published before this subscriber was known.
    while (picture := Picture(page)).stamp < stamp(heard[0]):
        assert time.monotonic() < deadline, 'the page stands still'
    (message,) = observer.spin_until(
        lambda: [message for message in heard if stamp(message) == picture.stamp],
        'the message that was drawn',
    )
    return picture, read_points(message)


def assert_drawn(picture, bodies, shift=0.0):
    """Compare; circles beside a wall are left out, as its pixels would count as theirs."""
    compared = 0
    for body in bodies:
        if abs(body['x']) + body['radius'] > 2.3:
            continue
        x, y = picture.place(float(body['x']) + shift / picture.scale, float(body['y']))
        radius = float(body['radius']) * picture.scale
        found = picture.find(x, y, radius)
        compared += 1
        # Counting whole pixels of a disc of 10 px and more is good to 0.1 px; drawing was measured to 0.06 px.
        assert math.hypot(found[0] - x, found[1] - y) < 0.5, (found, (x, y, radius))
        assert abs(found[2] - radius) < 0.5
    assert compared >= 4


@pytest.mark.parametrize('size', [WIDE, HIGH], ids=['wide', 'high'])
@pytest.mark.parametrize('scheme', ['dark', 'light'])
def test_circles_are_drawn_where_the_topic_says(show, observer, lanes, size, scheme):
    heard = observer.listen(PointCloud2, 'bodies')
    page = show(lanes, len(LANES), size=size, color_scheme=scheme)
    page.evaluate("bounce.looks.setTrail(0); bounce.looks.chooseColours('identity')")
    picture, bodies = draw_heard(page, observer, heard)
    # All of the box has to be in the picture.
    half = picture.pixels.shape[1] / 2 / picture.scale
    assert abs(picture.x) + 2.5 <= half
    assert_drawn(picture, bodies)
    # The measure itself: a picture that is 3 px away is seen to fail.
    with pytest.raises(AssertionError):
        assert_drawn(picture, bodies, shift=3.0)


def test_a_wall_and_a_locked_circle_are_where_the_scene_says(lesson_page):
    page = lesson_page
    wait_until(page, 'bounce.world.locked.length === 1 && bounce.world.walls.length === 4')
    page.evaluate('bounce.looks.setTrail(0)')
    picture = Picture(page)
    # From config/scenes/lesson.yaml: the red circle, and the box.
    for angle in np.linspace(0, 2 * math.pi, 16, endpoint=False):
        inner = picture.colour(0.3 + 0.6 * math.cos(angle), 0.15 + 0.6 * math.sin(angle))
        assert inner[0] > 1.5 * inner[2], 'red'
    for x, y in ((-2, 1.4), (2, 1.4), (-1.9, 1.5), (-1.9, -1.5)):
        px, py = (int(value) for value in picture.place(x, y))
        # A wall is 2 px wide, and its middle may lie between two pixels.
        assert picture.contrast[py - 1 : py + 2, px - 1 : px + 2].max() > 150, 'a wall'
    assert picture.colour(-1.97, 1.47).max() < 60, 'nothing'


def test_10_000_circles_keep_coming(show, many):
    page = show(many, 10000)
    first = page.evaluate('bounce.received')
    wait_until(page, f'bounce.received > {first} + 20', 'twenty more frames')


def test_100_000_circles_are_all_there_and_nowhere_else(show, observer, tmp_path):
    path = tmp_path / 'islands.yaml'
    islands = [(x, y) for x in (-2.5, -0.5, 1.5) for y in (-1.5, 0.5)]
    path.write_text(
        'moving_circles_collide: false\ngroups:\n'
        + ''.join(
            f'  - {{count: {count}, radius: 0.001, region: {{min: [{x}, {y}], max: [{x + 1}, {y + 1}]}}}}\n'
            for count, (x, y) in zip([20000] * 4 + [10000] * 2, islands, strict=True)
        )
        + 'walls:\n  - box: {min: [-3, -2], max: [3, 2]}\n'
    )
    heard = observer.listen(PointCloud2, 'bodies', depth=5)
    page = show(path, 100000)
    page.evaluate('bounce.looks.setTrail(0)')
    picture = Picture(page)
    # Nothing moves here, so any message of this scene is the one that was drawn.
    (message, *_) = observer.spin_until(
        lambda: [message for message in heard if message.width == 100000], 'all circles'
    )
    points = read_points(message)
    px, py = picture.place(points['x'].astype(float), points['y'].astype(float))
    near = np.zeros(picture.contrast.shape, bool)
    for right in range(-2, 3):
        for down in range(-2, 3):
            near[py.astype(int) + down, px.astype(int) + right] = True
    left, right = (int(picture.place(x, 0)[0]) for x in (-2.9, 2.9))
    top, bottom = (int(picture.place(0, y)[1]) for y in (1.9, -1.9))
    inside = np.s_[top:bottom, left:right]
    assert (picture.contrast[py.astype(int), px.astype(int)] > 10).all()
    empty = ~near[inside]
    assert empty.sum() > 50000
    assert picture.contrast[inside][empty].max() < 1


def test_zooming_in_keeps_what_is_partly_outside(show, lanes):
    page = show(lanes, len(LANES), paused=True)
    page.evaluate("bounce.looks.setTrail(0); bounce.looks.chooseColours('identity')")
    # The centre of a circle 3 px to the left of the picture: most of its right half is to be seen.
    for zoom in (1.0, 8.0):
        page.evaluate(
            f"""(() => {{ const {{ view: {{ camera }}, world }} = bounce; camera.scale = {zoom} * 100;
            camera.x = world.get(6, 'x') + (camera.width / 2 + 3) / camera.scale; camera.y = world.get(6, 'y');
            }})()"""
        )
        picture = Picture(page)
        row = picture.pixels[picture.pixels.shape[0] // 2]
        radius = RADII[6] * picture.scale
        assert row[2].max() > 80
        assert row[int(radius) - 8].max() > 80
        assert row[int(radius) + 4].max() < 60


# Colours


def test_colours_by_circle_are_those_of_the_palette(show, observer, lanes):
    heard = observer.listen(PointCloud2, 'bodies')
    page = show(lanes, len(LANES), paused=True)
    assert text_of(page, 'legend-title') == 'by circle'
    palette = page.evaluate("import('/colours.js').then(({ IDENTITY }) => IDENTITY)")
    picture, bodies = draw_heard(page, observer, heard)
    for body in bodies:
        shown = picture.colour(float(body['x']), float(body['y']))
        assert shown == pytest.approx(rgb(palette[body['id'] % len(palette)]), abs=2)


def test_colours_by_speed_are_lighter_the_faster_and_the_legend_says_how_fast(show, lanes):
    page = show(lanes, len(LANES), paused=True)
    page.get_by_label('by speed').check()
    assert text_of(page, 'legend-title') == 'speed'
    # The ramp ends near the fastest; it keeps an eye on the speeds for that.
    assert text_of(page, 'legend-low') == '0'
    assert float(text_of(page, 'legend-high').split()[0]) == pytest.approx(SPEEDS[-1], rel=0.2)
    picture = Picture(page)
    places = page.evaluate(
        "[...Array(7).keys()].map((row) => [bounce.world.get(row, 'x'), bounce.world.get(row, 'y')])"
    )
    light = [lightness(picture.colour(x, y)) for x, y in places]
    assert light == sorted(light)
    assert light[-1] - light[0] > 15


def lightness(colour):
    """Return L* of CIE 1976 of an sRGB colour, bytes."""
    values = np.asarray(colour, float) / 255
    linear = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    luminance = float(linear @ [0.2126, 0.7152, 0.0722])
    return 116 * np.cbrt(luminance) - 16 if luminance > 0.008856 else 903.3 * luminance


# How the colour-blind see linear RGB: Machado, Oliveira and Fernandes 2009, severity 1.
SEEN_BY = {
    'everybody else': np.eye(3),
    'protanopes': [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    'deuteranopes': [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
}  # fmt: skip


def lab(code, eye):
    """Return CIE L*a*b* (D65) of a colour as an eye sees it."""
    values = rgb(code) / 255
    linear = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    xyz = np.array(
        [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    ) @ np.clip(np.asarray(SEEN_BY[eye]) @ linear, 0, 1)
    f = np.cbrt(xyz / [0.9505, 1.0, 1.089])
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize('eye', SEEN_BY)
def test_every_kind_of_eye_tells_the_colours_apart(scripts, eye):
    colours = scripts.evaluate("async (load) => ({ ...await load('colours.js') })")
    ramp = [lab(code, eye)[0] for code in colours['SPEED_RAMP']]
    steps = np.diff(ramp)
    # Even: no step is twice as large as the mean, or less than half of it.
    assert steps.min() > 0.5 * steps.mean()
    assert steps.max() < 2.0 * steps.mean()
    locked = colours['LOOKS']['dark']['locked']
    palette = [lab(code, eye) for code in [*colours['IDENTITY'], locked]]
    apart = [np.linalg.norm(a - b) for i, a in enumerate(palette) for b in palette[:i]]
    # A difference of 2.3 is just noticeable when side by side.
    assert min(apart) > 15
