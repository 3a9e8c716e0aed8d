"""The page in a real browser, served by the real viewer, fed by the real node over DDS."""

import base64
import functools
import http.server
import math
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from observing import nanoseconds, read_points, scene_times
from sensor_msgs.msg import PointCloud2, TimeReference
from viewing import PATIENCE, drive, launch, missing_browser

from circle_bounce_ros import kernel

pytestmark = pytest.mark.skipif(bool(missing_browser()), reason=missing_browser())

SIZE = {'width': 1280, 'height': 800}
OTHER_SIZE = {'width': 900, 'height': 1000}
PHONE = {'width': 390, 'height': 844}

# Seven circles, each in a lane of its own, so that a window around one never holds another.
LANES = range(7)
LANE = 0.5  # m
RADII = [0.08 + 0.015 * lane for lane in LANES]

# Read back right after drawing: later the picture is gone. Colours are bytes, rows from the top.
READ_BACK = """
() => new Promise((resolve) => {
  bounce.afterDraw = (app) => {
    bounce.afterDraw = null;
    const { canvas, picture: { gl }, camera, ratio, look, world } = app;
    const { width, height } = canvas;
    const pixels = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    let text = '';
    for (let i = 0; i < pixels.length; i += 32768) text += String.fromCharCode(...pixels.subarray(i, i + 32768));
    resolve({ width, height, ratio, scale: camera.scale, x: camera.x, y: camera.y,
              stamp: world.cloud.stamp, background: look.background, pixels: btoa(text) });
  };
})
"""


@pytest.fixture(scope='module')
def browser():
    with drive() as playwright:
        browser = launch(playwright)
        yield browser
        browser.close()


@pytest.fixture
def open_page(browser):
    """Return a function that opens an address and returns the page; an error in it fails the test."""
    contexts, errors = [], []

    def open_page(address, size=SIZE, **options):
        contexts.append(browser.new_context(viewport=size, **({'color_scheme': 'dark'} | options)))
        page = contexts[-1].new_page()
        page.on('pageerror', lambda error: errors.append(str(error)))
        page.goto(address)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert errors == []


@pytest.fixture
def show(stage, play, open_page):
    """Return a function that plays a scene and returns a page that shows it."""

    def show(scene='lesson', count=1, paused=False, **options):
        play(scene, paused)
        page = open_page(stage.address, **options)
        wait_for_circles(page, count)
        said = [f'bounce.values.scene === {Path(scene).stem!r}']
        said.append(f"bounce.values.paused === '{str(paused).lower()}'")
        said.append("bounce.values.time_scale === '1.0'")
        wait_until(page, ' && '.join(said))
        return page

    return show


@pytest.fixture
def lanes(tmp_path):
    path = tmp_path / 'lanes.yaml'
    circles = ''.join(
        f'  - {{position: [{-1 + 0.3 * lane}, {LANE * lane}], velocity: [{0.5 + 0.1 * lane}, 0], '
        f'radius: {RADII[lane]}}}\n'
        for lane in LANES
    )
    path.write_text(
        f'circles:\n{circles}walls:\n  - box: {{min: [-2.5, -0.5], max: [2.5, 3.5]}}\n'
    )
    return path


def wait_until(page, condition, what='', within=PATIENCE):
    """Wait for JavaScript to be true: the page's security policy does not let Playwright wait by itself."""
    deadline = time.monotonic() + within
    while not (result := page.evaluate(condition)):
        assert time.monotonic() < deadline, f'not within {within} s: {what or condition}'
        page.wait_for_timeout(30)
    return result


def wait_for_circles(page, count=None):
    equal = '> 0' if count is None else f'=== {count}'
    wait_until(page, f'bounce.drawTimes.length > 3 && bounce.world.count {equal}')


def text_of(page, name):
    return page.locator(f'#{name}').inner_text()


# The picture


def found_at(picture, expected):
    """
    Return the centre and radius, px, of what is drawn around an expected circle.

    From the pixels alone: where they differ from the background by more than half as much as the rim does, they
    belong to the circle.
    """
    x, y, radius = expected
    shape = picture['height'], picture['width'], 4
    pixels = np.frombuffer(base64.b64decode(picture['pixels']), np.uint8).reshape(shape)
    pixels = pixels[::-1, :, :3].astype(float)
    reach = radius + 8
    left, top = int(x - reach), int(y - reach)
    window = pixels[top : int(y + reach) + 1, left : int(x + reach) + 1]
    code = picture['background']
    background = np.array([int(code[i : i + 2], 16) for i in (1, 3, 5)], float)
    contrast = np.linalg.norm(window - background, axis=2)
    # The darker rim is what the edge is blended from.
    rim = 0.55 * window[contrast.shape[0] // 2, contrast.shape[1] // 2]
    inside = contrast > 0.5 * np.linalg.norm(rim - background)
    rows, columns = np.nonzero(inside)
    centre = left + columns.mean() + 0.5, top + rows.mean() + 0.5
    return *centre, math.sqrt(inside.sum() / math.pi)


def expected_of(picture, body):
    """Return where a body has to be on the picture, px, by the definition of the view alone."""
    pixels = picture['scale'] * picture['ratio']
    return (
        picture['width'] / 2 + (float(body['x']) - picture['x']) * pixels,
        picture['height'] / 2 - (float(body['y']) - picture['y']) * pixels,
        float(body['radius']) * pixels,
    )


def assert_drawn(picture, bodies, shift=0.0):
    """Compare; circles beside a wall are left out, as its pixels would count as theirs."""
    compared = 0
    for body in bodies:
        if abs(body['x']) + body['radius'] > 2.3:
            continue
        x, y, radius = expected_of(picture, body)
        found = found_at(picture, (x + shift, y, radius))
        compared += 1
        # Counting whole pixels of a disc of 10 px and more is good to 0.1 px; drawing was measured to 0.06 px.
        assert math.hypot(found[0] - x - shift, found[1] - y) < 0.5, (found, (x, y, radius))
        assert abs(found[2] - radius) < 0.5
    assert compared >= 4


@pytest.mark.parametrize('size', [SIZE, OTHER_SIZE], ids=['wide', 'high'])
@pytest.mark.parametrize('scheme', ['dark', 'light'])
def test_circles_are_drawn_where_the_topic_says(show, observer, lanes, size, scheme):
    heard = observer.listen(PointCloud2, 'bodies')
    page = show(lanes, len(LANES), size=size, color_scheme=scheme)
    page.evaluate("bounce.setTrail(0); bounce.chooseColours('identity')")
    picture = page.evaluate(READ_BACK)

    def stamp(message):
        return f'{message.header.stamp.sec}.{message.header.stamp.nanosec:09d}'

    (message,) = observer.spin_until(
        lambda: [message for message in heard if stamp(message) == picture['stamp']],
        'the message that was drawn',
    )
    bodies = read_points(message)
    # All of the box has to be in the picture.
    half = picture['width'] / 2 / picture['ratio'] / picture['scale']
    assert abs(picture['x']) + 2.5 <= half
    assert_drawn(picture, bodies)
    # The measure itself: a picture that is 3 px away is seen to fail.
    moved = picture | {'x': picture['x'] + 3 / (picture['scale'] * picture['ratio'])}
    with pytest.raises(AssertionError):
        assert_drawn(moved, bodies)


def test_a_wall_and_a_locked_circle_are_where_the_scene_says(show):
    page = show()
    wait_until(page, 'bounce.world.locked.length === 1 && bounce.world.walls.length === 4')
    page.evaluate('bounce.setTrail(0)')
    picture = page.evaluate(READ_BACK)
    shape = picture['height'], picture['width'], 4
    pixels = np.frombuffer(base64.b64decode(picture['pixels']), np.uint8).reshape(shape)[::-1]

    def colour(x, y):
        body = {'x': x, 'y': y, 'radius': 0}
        px, py, _ = expected_of(picture, body)
        return pixels[int(py), int(px), :3].astype(int)

    # From config/scenes/lesson.yaml: the red circle, and the box.
    for angle in np.linspace(0, 2 * math.pi, 16, endpoint=False):
        inner = colour(0.3 + 0.6 * math.cos(angle), 0.15 + 0.6 * math.sin(angle))
        assert inner[0] > 1.5 * inner[2], 'red'
    for x, y in ((-2, 1.4), (2, 1.4), (-1.9, 1.5), (-1.9, -1.5)):
        assert colour(x, y).min() > 100, 'a wall'
    assert colour(-1.97, 1.47).max() < 60, 'nothing'


def test_10_000_circles_keep_coming(show, many):
    page = show(many, 10000)
    first = page.evaluate('bounce.received')
    wait_until(page, f'bounce.received > {first} + 20', 'twenty more frames')


def test_zooming_in_keeps_what_is_partly_outside(show, lanes):
    page = show(lanes, len(LANES), paused=True)
    page.evaluate("bounce.setTrail(0); bounce.chooseColours('identity')")
    # The centre of a circle 3 px to the left of the picture: most of its right half is to be seen.
    for zoom in (1.0, 8.0):
        page.evaluate(
            f"""(() => {{ const {{ camera, world }} = bounce; camera.scale = {zoom} * 100;
            camera.x = world.get(6, 'x') + (camera.width / 2 + 3) / camera.scale; camera.y = world.get(6, 'y');
            bounce.isDirty = true; }})()"""
        )
        picture = page.evaluate(READ_BACK)
        shape = picture['height'], picture['width'], 4
        pixels = np.frombuffer(base64.b64decode(picture['pixels']), np.uint8).reshape(shape)
        row = pixels[picture['height'] // 2, :, :3].astype(int)
        radius = RADII[6] * picture['scale']
        assert row[2].max() > 80
        assert row[int(radius) - 8].max() > 80
        assert row[int(radius) + 4].max() < 60


# The buttons


@pytest.fixture
def lesson_page(show):
    return show()


def seconds_of(message):
    return nanoseconds(message.time_ref)


@pytest.mark.parametrize('by', ['mouse', 'keyboard'])
def test_pause_step_and_reset_do_what_they_say(lesson_page, observer, by):
    page = lesson_page
    times = observer.listen(TimeReference, 'time')

    def press(name, key):
        if by == 'mouse':
            page.locator(f'#{name}').click()
        else:
            page.locator('#bodies').focus()
            page.keyboard.press(key)

    def standing():
        last = {seconds_of(message) for message in times[-5:]}
        return last if len(times) >= 5 and len(last) == 1 else None

    press('pause', ' ')
    wait_until(page, "bounce.values.paused === 'true'")
    (stands,) = observer.spin_until(standing, 'it stands still')
    press('step', '.')
    (further,) = observer.spin_until(lambda: (standing() or {stands}) - {stands}, 'a step')
    # One period of 60 Hz, to the nanosecond below.
    assert further - stands in (16666666, 16666667)
    press('reset', 'r')
    observer.spin_until(lambda: standing() == {0}, 'the first instant')
    press('pause', ' ')
    observer.spin_until(lambda: seconds_of(times[-1]) > 0, 'it goes on')
    wait_until(page, "document.getElementById('state').textContent === 'running'")


def test_the_speed_is_the_nodes_parameter(lesson_page, observer):
    page = lesson_page
    page.locator('#bodies').focus()
    page.keyboard.press('[')
    wait_until(page, "bounce.values.time_scale === '0.5'")
    assert text_of(page, 'speed-value') == '0.5 ×'
    page.locator('#speed').fill('7')
    wait_until(page, "bounce.values.time_scale === '2.0'")
    # The scene really runs at that speed, by the stamps of its messages.
    times = observer.listen(TimeReference, 'time')
    ticks = scene_times(observer.collect(times, 60))
    (first, then), (last, now) = min(ticks.items()), max(ticks.items())
    assert (now - then) / (last - first) == pytest.approx(2.0, rel=0.02)  # ticks may be dropped


def test_the_chooser_loads_scenes_and_shows_refusals_in_words(lesson_page, observer):
    page = lesson_page
    times = observer.listen(TimeReference, 'time')
    page.locator('#scene').select_option('mixed')
    observer.spin_until(lambda: times and times[-1].source == 'mixed', 'the other scene')
    wait_for_circles(page, 160)
    page.locator('#seed').fill('7')
    page.get_by_role('button', name='Load').click()
    wait_until(page, "bounce.values.seed === '7'")
    page.locator('#scene').select_option('…')
    page.locator('#own').fill('no/such.yaml')
    page.get_by_role('button', name='Load').click()
    wait_until(page, "document.getElementById('answer').textContent.startsWith('Refused')")
    assert 'no/such.yaml' in text_of(page, 'answer')
    assert page.locator('#answer').is_visible()
    assert page.evaluate('bounce.values.scene') == 'mixed'
    page.get_by_role('button', name='Step').click()
    wait_until(page, "document.getElementById('answer').textContent.includes('pause')")


def test_every_button_and_choice_has_a_name_and_can_be_reached_with_the_keyboard(lesson_page):
    page = lesson_page
    page.evaluate('bounce.selectNext(1)')
    controls = page.evaluate(
        """
        () => [...document.querySelectorAll('button, input, select')].filter((e) => e.checkVisibility())
          .map((e) => [e.id || e.outerHTML, e.type !== 'radio' || e.checked,
            e.getAttribute('aria-label') || [...(e.labels || [])].map((l) => l.innerText).join() || e.innerText])
        """
    )
    assert [control for control, _, name in controls if not name.strip()] == []
    wanted = {control for control, takes_focus, _ in controls if takes_focus}
    assert len(wanted) > 15
    page.locator('.skip').focus()
    reached = set()
    for _ in range(len(wanted) + 20):
        page.keyboard.press('Tab')
        reached.add(page.evaluate('document.activeElement.id || document.activeElement.outerHTML'))
    assert wanted - reached == set()
    assert 'bodies' in reached


@pytest.mark.parametrize('scheme', ['dark', 'light'])
def test_words_stand_out_from_their_background(show, scheme):
    page = show(color_scheme=scheme)
    page.evaluate('bounce.selectNext(1)')
    wait_until(page, "!document.getElementById('lesson').hidden")
    pairs = page.evaluate(
        """
        () => [...document.querySelectorAll('h1, h2, h3, dt, dd, p, label, button, output, .badge, small, kbd')]
          .filter((e) => e.checkVisibility() && e.innerText.trim() && !e.matches('.only-read'))
          .map((e) => {
            let ground = e;
            const see = (x) => getComputedStyle(x).backgroundColor;
            while (ground && /, 0\\)|transparent/.test(see(ground))) ground = ground.parentElement;
            return [e.innerText, getComputedStyle(e).color, see(ground)];
          })
        """
    )
    assert len(pairs) > 30
    for words, colour, ground in pairs:
        # WCAG 2.1, level AA.
        assert contrast(colour, ground) >= 4.5, (words, colour, ground)


def contrast(*colours):
    """Return the contrast of two CSS colours, by WCAG 2.1."""
    light = []
    for colour in colours:
        numbers = colour[colour.index('(') + 1 : -1].replace('srgb', '').split('/')[0]
        values = [float(part) for part in numbers.replace(',', ' ').split()[:3]]
        values = [value / 255 if colour.startswith('rgb') else value for value in values]
        linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in values]
        light.append(0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2])
    return (max(light) + 0.05) / (min(light) + 0.05)


def test_who_wants_less_motion_gets_no_trails_and_no_transitions(show):
    page = show(reduced_motion='reduce')
    assert page.evaluate('bounce.trail') == 0
    assert (
        page.evaluate("getComputedStyle(document.getElementById('answer')).transitionDuration")
        == '0s'
    )


def test_a_phone_shows_it_all_without_scrolling_sideways(show):
    page = show(size=PHONE)
    assert page.evaluate('document.documentElement.scrollWidth') <= PHONE['width']
    box = page.locator('#stage').bounding_box()
    assert box['height'] > 200
    assert box['y'] + box['height'] < PHONE['height']


# The lesson


def test_the_pages_steps_of_the_lesson_are_those_of_the_kernel(stage, open_page):
    page = open_page(stage.address)
    random = np.random.default_rng(20)
    velocities, normals, offsets = random.normal(size=(3, 200, 2))
    reaches = random.uniform(0.1, 1.5, 200)
    page_says = page.evaluate(
        """
        async ([velocities, normals, offsets, reaches]) => {
          const lesson = await import('/lesson.js');
          return velocities.map((v, i) => {
            const a = lesson.bounceAngles(v, normals[i]);
            const time = lesson.timeToTouch(offsets[i], v, reaches[i]);
            return [a.v, a.n, a.d, a.pc, ...lesson.reflectByAngles(v, normals[i]), Math.min(time, 1e9),
                    lesson.inContact([0, 0], reaches[i] / 2, offsets[i], reaches[i] / 2),
                    lesson.squaresOverlap([0, 0], reaches[i] / 2, offsets[i], reaches[i] / 2)];
          });
        }
        """,
        [velocities.tolist(), normals.tolist(), offsets.tolist(), reaches.tolist()],
    )
    columns = np.array(page_says, float).T
    # Another atan2, sine and cosine may differ in the last digit; angles go up to 5 pi.
    np.testing.assert_allclose(columns[:4], kernel.bounce_angles(velocities, normals), atol=1e-14)
    np.testing.assert_allclose(columns[4:6].T, kernel.reflect(velocities, normals), atol=1e-14)
    outside = np.hypot(*offsets.T) > reaches
    times = np.minimum(kernel.time_to_touch(offsets, velocities, reaches), 1e9)
    np.testing.assert_allclose(columns[6][outside], times[outside], rtol=1e-9)
    assert (columns[6][outside] < 1e9).sum() > 5
    origin = np.zeros_like(offsets)
    halves = reaches / 2
    assert (columns[7] == kernel.in_contact(origin, halves, offsets, halves)).all()
    assert (columns[8] == kernel.boxes_overlap(origin, halves, offsets, halves)).all()


def test_the_overlays_angles_are_those_of_the_kernel(lesson_page, observer):
    page = lesson_page
    contacts = observer.listen(PointCloud2, 'contacts')
    bodies = observer.listen(PointCloud2, 'bodies')
    times = observer.listen(TimeReference, 'time')
    observer.collect(bodies, 5)
    observer.collect(contacts, 5)
    page.locator('#pause').click()
    wait_until(page, "bounce.values.paused === 'true'")
    # A click where the circle is selects it.
    x, y = page.evaluate(
        'bounce.camera.toScreen(bounce.world.get(0, "x"), bounce.world.get(0, "y"))'
    )
    page.locator('#bodies').click(position={'x': x, 'y': y})
    wait_until(page, 'bounce.story.circle === 0')
    page.locator('#pause').click()
    page.evaluate('bounce.setSpeed(8)')
    seen = []
    while not {1, 2} <= {story['kind'] for story in seen}:
        count = page.evaluate('bounce.story.count')
        # Frozen together: what the overlay draws from, and what the table says.
        seen.append(
            wait_until(
                page,
                f"""bounce.story.count > {count} && {{ ...bounce.story.last,
                texts: ['a-v', 'a-n', 'a-pc'].map((id) => document.getElementById(id).textContent) }}""",
            )
        )
        observer.spin_for(0.05)
    for story in seen:
        angles = kernel.bounce_angles(story['before'], story['normal'])
        shown = story['angles']
        assert [shown[key] for key in ('v', 'n', 'd', 'pc')] == pytest.approx(
            list(angles), abs=1e-14
        )
        expected = (angles.velocity, angles.normal, angles.after)
        for text, angle in zip(story['texts'], expected, strict=True):
            value = float(text.replace('−', '-').rstrip('°'))
            turns = (value - math.degrees(angle)) / 360
            assert abs(turns - round(turns)) * 360 <= 0.051  # shown to a tenth of a degree
        # What came out, by the topic, is what the kernel makes of what went in; float32 is good to 1e-7.
        after = kernel.reflect(story['before'], story['normal'])
        assert story['after'] == pytest.approx(list(after), abs=3e-6)
    # What went in is what the topics say, by an own subscriber.
    for story in seen:
        message, row = observer.spin_until(
            lambda story=story: next(
                (
                    (message, row)
                    for message in contacts
                    for row in read_points(message)
                    if row['time'] == story['time']
                ),
                None,
            ),
            'the contact, on the topic',
        )
        stamp = nanoseconds(message.header.stamp)
        observer.spin_until(
            lambda stamp=stamp: nanoseconds(bodies[-1].header.stamp) >= stamp, 'its state'
        )
        before = max(
            (m for m in bodies if nanoseconds(m.header.stamp) < stamp),
            key=lambda m: nanoseconds(m.header.stamp),
        )
        state = read_points(before)[0]
        assert story['before'] == [state['vx'], state['vy']]
        assert story['point'] == [row['x'], row['y']]
        assert story['normal'] == pytest.approx([row['nx'], row['ny']], abs=1e-6)
        assert scene_times(times)


def test_while_it_approaches_the_distance_is_shown_against_the_radii(lesson_page):
    page = lesson_page
    page.locator('#pause').click()
    wait_until(page, "bounce.values.paused === 'true'")
    page.locator('#reset').click()
    wait_until(page, 'bounce.world.seconds === 0')
    page.keyboard.press('k')
    wait_until(page, "document.getElementById('gap-partner').textContent === 'locked circle 1'")
    # From config/scenes/lesson.yaml: centres, radii and velocity.
    own, red = [-1.4, -0.6], [0.3, 0.15]
    assert text_of(page, 'gap-d') == f'{kernel.distance(own, red):.3f} m'
    assert text_of(page, 'gap-sum') == '0.900 m'
    time_left = kernel.time_to_touch(np.subtract(own, red), [1.3, 0.45], 0.9)
    assert text_of(page, 'gap-time') == f'{time_left:.2f} s'


def test_slow_motion_begins_before_a_contact_and_ends_after_it(lesson_page):
    page = lesson_page
    page.locator('#bodies').focus()
    page.keyboard.press('m')
    wait_until(page, "bounce.values.time_scale === '0.12'")
    count = page.evaluate('bounce.story.count')
    wait_until(page, f'bounce.story.count > {count}', 'a contact in slow motion')
    assert page.evaluate('bounce.values.time_scale') == '0.12'
    page.keyboard.press('m')
    wait_until(page, "bounce.values.time_scale === '1.0'")
    assert text_of(page, 'speed-value') == '1 ×'


def test_squares_light_up_when_they_overlap_and_circles_do_not(show, tmp_path):
    path = tmp_path / 'corner.yaml'
    path.write_text(
        'circles:\n'
        '  - {position: [0, 0], radius: 0.5, locked: true}\n'
        '  - {position: [0.8, 0.8], radius: 0.5}\n'
        '  - {position: [2.0, 0], radius: 0.5}\n'
    )
    page = show(path, 2)
    page.evaluate('bounce.selectNext(1)')
    page.locator('#squares').check()
    wait_until(page, "document.getElementById('squares-say').classList.contains('lit')")
    said = text_of(page, 'squares-say')
    assert f'D = {math.hypot(0.8, 0.8):.3f} m > 1.000 m' in said
    page.evaluate('bounce.selectNext(1)')
    wait_until(page, "!document.getElementById('squares-say').classList.contains('lit')")


def test_the_histogram_is_that_of_the_speeds_on_the_topic(show, observer):
    page = show('gas', 1000, paused=True)
    points = read_points(observer.collect(observer.listen(PointCloud2, 'bodies'), 1)[0])
    sigma = math.sqrt(np.mean(points['vx'] ** 2 + points['vy'] ** 2) / 2)
    wait_until(
        page, "document.getElementById('histogram-note').textContent.includes('1,000 circles')"
    )
    said = text_of(page, 'histogram-note').rpartition(' = ')[2].partition(' ')[0]
    assert float(said) == pytest.approx(sigma, rel=0.005)  # shown with three digits
    drawn = page.evaluate(
        """() => { const c = document.getElementById('histogram');
        const { data } = c.getContext('2d').getImageData(0, 0, c.width, c.height);
        return data.filter((v, i) => i % 4 === 3 && v).length; }"""
    )
    assert drawn > 1000


# What is missing, and who may look


def test_the_page_comes_back_when_the_viewer_does(show, stage):
    page = show()
    page.evaluate('bounce.selectNext(1)')
    assert stage.viewer.end() == 0
    page.locator('#notice').wait_for(state='visible', timeout=PATIENCE * 1000)
    assert 'No connection to the viewer' in text_of(page, 'notice')
    stage.start_viewer()
    page.locator('#notice').wait_for(state='hidden', timeout=PATIENCE * 1000)
    first = page.evaluate('bounce.received')
    wait_until(page, f'bounce.received > {first}')
    # What was selected still is, for the new viewer too.
    count = page.evaluate('bounce.story.count')
    wait_until(page, f'bounce.story.count > {count}', 'a contact of the selected circle')


OPEN_SOCKET = """
(url) => new Promise((resolve) => {
  const socket = new WebSocket(url);
  socket.onopen = () => resolve('open');
  socket.onerror = () => resolve('refused');
})
"""


def test_a_page_of_another_origin_gets_nothing(stage, browser, tmp_path):
    viewer = stage.address
    (tmp_path / 'index.html').write_text('<title>elsewhere</title>')
    handler = functools.partial(QuietHandler, directory=str(tmp_path))
    server = http.server.ThreadingHTTPServer(('127.0.0.1', 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    context = browser.new_context()
    try:
        page = context.new_page()
        page.goto(f'http://127.0.0.1:{server.server_address[1]}/')
        socket = viewer.replace('http', 'ws') + '/socket'
        assert page.evaluate(OPEN_SOCKET, socket) == 'refused'
        assert page.evaluate(f"fetch('{viewer}/').then(() => 'got', () => 'refused')") == 'refused'
        # The same from the viewer's own page, so that it is the origin that made the difference.
        page.goto(viewer)
        assert page.evaluate(OPEN_SOCKET, socket) == 'open'
        # A foreign name that points to this machine.
        port = viewer.rpartition(':')[2]
        response = page.goto(f'http://rebound.example.com:{port}/')
        assert response.status == 403
    finally:
        context.close()
        server.shutdown()
        server.server_close()


class QuietHandler(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


# The last one: clients that knew the old node may take seconds to know the new one.
def test_a_node_that_ended_is_missed_and_one_that_starts_is_seen(show, stage):
    page = show()
    assert page.locator('#notice').is_hidden()
    assert stage.node.end() == 0
    page.locator('#notice').wait_for(state='visible', timeout=PATIENCE * 1000)
    wait_until(
        page, "document.getElementById('notice').innerText.includes('Nobody publishes /bodies')"
    )
    assert 'Nothing is published' in text_of(page, 'notice')
    stage.start_node('-p', 'scene:=mixed')
    page.locator('#notice').wait_for(state='hidden', timeout=PATIENCE * 1000)
    wait_for_circles(page, 160)
    wait_until(page, 'bounce.world.locked.length === 5', 'the locked circles of the other scene')
    wait_until(page, "bounce.values.scene === 'mixed'")
