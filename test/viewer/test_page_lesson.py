"""The lesson, drawn live: what the page says and draws of a bounce is what the kernel says."""

import math
import time
from typing import NamedTuple

import numpy as np
import pytest
from browsing import (
    PATIENCE,
    pause,
    press,
    restart_paused,
    step,
    text_of,
    wait_for_values,
    wait_until,
)
from observing import read_points
from picture import Picture, is_near, pixels_of
from sensor_msgs.msg import PointCloud2

from circle_bounce_ros import kernel
from circle_bounce_ros.scene_file import load_scene


def number(text):
    """Return the first number of a text with a minus sign as people write it."""
    return float(text.replace('−', '-').split()[0].rstrip('°'))


class Bounce(NamedTuple):
    """A contact of the lesson's green circle, by a run of the kernel: SI units."""

    time: float
    kind: int
    point: np.ndarray
    normal: np.ndarray
    before: np.ndarray
    after: np.ndarray


def bounces_of_the_lesson(seconds):
    """Return every contact by its instant; velocities are read half-way to the contacts beside it."""
    scene = load_scene('lesson')
    first = kernel.Simulation(scene, record_contacts=True)
    first.advance_to(seconds)
    log = first.drain_contacts()
    instants = [0.0, *log['time'].tolist()]
    second = kernel.Simulation(scene)
    velocities = []
    for start, end in zip(instants, [*instants[1:], seconds], strict=True):
        second.advance_to((start + end) / 2)
        velocities.append(second.velocities[0].copy())
    return {
        float(row['time']): Bounce(
            row['time'],
            row['kind'],
            np.array([row['x'], row['y']]),
            np.array([row['nx'], row['ny']]),
            before,
            after,
        )
        for row, before, after in zip(log, velocities[:-1], velocities[1:], strict=True)
    }


def test_the_pages_steps_of_the_lesson_are_those_of_the_kernel(scripts):
    random = np.random.default_rng(20)
    velocities, normals, offsets = random.normal(size=(3, 200, 2))
    reaches = random.uniform(0.1, 1.5, 200)
    page_says = scripts.evaluate(
        """
        async (load, [velocities, normals, offsets, reaches]) => {
          const lesson = await load('lesson.js');
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


def test_angles_are_written_between_minus_180_and_180_degrees_and_zero_has_no_sign(scripts):
    angles = [math.pi, -math.pi, 3 * math.pi, -0.5 * math.pi, 5.5 * math.pi, -1e-9, 2 * math.pi]
    said = scripts.evaluate(
        "async (load, angles) => angles.map((await load('lesson.js')).showDegrees)",
        angles,
    )
    assert said == ['180.0°', '180.0°', '180.0°', '−90.0°', '−90.0°', '0.0°', '0.0°']


# Frozen together: what the overlay draws from, and what the table says.
LAST = """
() => bounce.story.count > %d && { ...bounce.story.last, texts: Object.fromEntries(
  ['a-v', 'a-n', 'a-d', 'a-pc', 's-before', 's-after', 'p-across', 'p-along']
  .map((id) => [id, document.getElementById(id).textContent])) }
"""


def test_the_overlays_angles_are_those_of_the_kernel(lesson_page, observer):
    page = lesson_page
    contacts = observer.listen(PointCloud2, 'contacts')
    observer.collect(contacts, 5)
    pause(page)
    # A click where the circle is selects it.
    x, y = page.evaluate(
        'bounce.view.camera.toScreen(bounce.world.get(0, "x"), bounce.world.get(0, "y"))'
    )
    page.locator('#bodies').click(position={'x': x, 'y': y})
    wait_until(page, 'bounce.story.circle === 0')
    page.locator('#pause').click()
    page.locator('#speed').fill('8')
    seen = {}
    deadline = time.monotonic() + PATIENCE
    while not {1, 2} <= {story['kind'] for story in seen.values()}:
        assert time.monotonic() < deadline, 'a contact with a wall and one with the red circle'
        count = page.evaluate('bounce.story.count')
        story = wait_until(page, LAST % count)
        seen[story['time']] = story
        observer.spin_for(0.0)
    bounces = bounces_of_the_lesson(max(seen) + 1.0)
    for instant, story in seen.items():
        bounce = bounces[instant]
        # What is on the topic is float32, good to 1e-7; of two contacts in one tick, the velocity between them
        # follows from the impulses, a few roundings later.
        assert story['kind'] == bounce.kind
        assert story['point'] == pytest.approx(bounce.point, abs=1e-6)
        assert story['normal'] == pytest.approx(bounce.normal, abs=1e-6)
        assert story['before'] == pytest.approx(bounce.before, abs=5e-6)
        assert story['after'] == pytest.approx(bounce.after, abs=5e-6)
        assert story['after'] == pytest.approx(
            kernel.reflect(bounce.before, bounce.normal), abs=5e-6
        )
        assert_shown(story['texts'], bounce)
        (row,) = observer.spin_until(
            lambda instant=instant: [
                row
                for message in contacts
                for row in read_points(message)
                if row['time'] == instant
            ],
            'the contact, on the topic',
        )
        assert story['point'] == [row['x'], row['y']]


def assert_shown(texts, bounce):
    """Compare a table with the kernel: degrees to a tenth, m/s to a thousandth or a hundredth."""
    angles = kernel.bounce_angles(bounce.before, bounce.normal)
    for name, angle in zip(('a-v', 'a-n', 'a-d', 'a-pc'), angles, strict=True):
        turns = (number(texts[name]) - math.degrees(angle)) / 360
        assert abs(turns - round(turns)) * 360 <= 0.051, name
    for name, velocity in (('s-before', bounce.before), ('s-after', bounce.after)):
        assert number(texts[name]) == pytest.approx(math.hypot(*velocity), abs=5.1e-4)
    side = np.array([-bounce.normal[1], bounce.normal[0]])
    for name, direction in (('p-across', bounce.normal), ('p-along', side)):
        parts = [number(part) for part in texts[name].removesuffix('m/s').split('→')]
        expected = [bounce.before @ direction, bounce.after @ direction]
        assert parts == pytest.approx(expected, abs=5.1e-3), name


def test_while_it_approaches_the_distance_is_shown_against_the_radii(lesson_page):
    page = lesson_page
    restart_paused(page)
    press(page, 'k')
    wait_until(page, "document.getElementById('gap-partner').textContent === 'locked circle 1'")
    # From config/scenes/lesson.yaml: centres, radii and velocity.
    own, red = [-1.4, -0.6], [0.3, 0.15]
    assert text_of(page, 'gap-d') == f'{kernel.distance(own, red):.3f} m'
    assert text_of(page, 'gap-sum') == '0.900 m'
    time_left = kernel.time_to_touch(np.subtract(own, red), [1.3, 0.45], 0.9)
    assert text_of(page, 'gap-time') == f'{time_left:.2f} s'


@pytest.fixture
def meeting(tmp_path):
    """Return the path of a scene in which a circle comes upon a locked one after 0.6 s."""
    path = tmp_path / 'meeting.yaml'
    path.write_text(
        'circles:\n'
        '  - {position: [-0.9, 0.1], velocity: [1, 0.2], radius: 0.2}\n'
        '  - {position: [0.3, 0.6], radius: 0.5, locked: true}\n'
        'walls:\n  - box: {min: [-2, -1.5], max: [2, 1.5]}\n'
    )
    return path


def test_a_contact_is_drawn_where_and_as_it_happened(show, meeting):
    page = show(meeting)
    restart_paused(page)
    press(page, 'k')
    # `contacts` is subscribed to from now on, and the node has to have noticed before the contact.
    while page.evaluate('bounce.story.last') is None:
        step(page)
        assert page.evaluate('bounce.world.seconds') < 1.0
    start, velocity, red = np.array([-0.9, 0.1]), np.array([1, 0.2]), np.array([0.3, 0.6])
    centre = start + velocity * kernel.time_to_touch(start - red, velocity, 0.7)
    normal = kernel.contact_normal(centre, red)
    picture, overlay = Picture(page), pixels_of(page, 'overlay')

    def share(colour, direction, least, most):
        """Return how much of a line from the centre at the contact (px along a direction) has a colour."""
        x, y = picture.place(*centre)
        steps = np.arange(least, most)
        rows = (y - steps * direction[1]).astype(int)
        columns = (x + steps * direction[0]).astype(int)
        return is_near(overlay[rows, columns], picture.look[colour]).mean()

    px, py = (int(value) for value in picture.place(*kernel.contact_point(centre, 0.2, red)))
    assert is_near(overlay[py, px], picture.look['normal']), 'the contact point'
    after = kernel.reflect(velocity, normal)
    # Labels and arcs may lie over an arrow here and there.
    speed = math.hypot(*velocity)
    assert share('after', after / speed, 40, 120) > 0.6
    assert share('before', -velocity / speed, 40, 120) > 0.6
    assert share('after', -after / speed, 40, 120) < 0.2
    # Dashes along the normal, beyond the contact point.
    assert share('normal', normal, 0.2 * picture.scale + 8, 0.2 * picture.scale + 80) > 0.3


def test_before_the_contact_the_distance_is_drawn_with_a_ghost_where_they_will_touch(
    show, meeting
):
    page = show(meeting)
    restart_paused(page)
    press(page, 'k')
    while page.evaluate('bounce.story.next.time') > 0.1:
        step(page)
    start, velocity, red = np.array([-0.9, 0.1]), np.array([1, 0.2]), np.array([0.3, 0.6])
    left = page.evaluate('bounce.story.next.time')
    gone = page.evaluate('bounce.world.seconds')
    touch = kernel.time_to_touch(start - red, velocity, 0.7)
    # Positions are float32 on the topic.
    assert left + gone == pytest.approx(touch, abs=1e-5)
    picture, overlay = Picture(page), pixels_of(page, 'overlay')
    x, y = picture.place(*(start + velocity * touch))
    turns = np.linspace(0, 2 * math.pi, 200)
    radius = 0.2 * picture.scale
    rows, columns = (
        (y + radius * np.sin(turns)).astype(int),
        (x + radius * np.cos(turns)).astype(int),
    )
    assert is_near(overlay[rows, columns], picture.look['dim'], 60).mean() > 0.25, 'a dashed ghost'
    assert number(text_of(page, 'gap-d')) == pytest.approx(
        kernel.distance(start + velocity * gone, red), abs=6e-4
    )


# Whether each turn to slow motion came before a contact, rather than in the time after one.
WATCH_TURNS = """
() => {
  const { playback } = bounce;
  const turn = playback.turn.bind(playback);
  const touched = playback.touched.bind(playback);
  window.before = [];
  window.speeds = []; // that the node had reported, at each contact
  playback.touched = (now) => {
    window.speeds.push(bounce.node.values.time_scale);
    touched(now);
  };
  playback.turn = (isSlow) => {
    const isSoon = bounce.story.next.time / playback.chosen < 0.3;
    if (isSlow) window.before.push(performance.now() > playback.slowUntil && isSoon);
    turn(isSlow);
  };
}
"""


def test_slow_motion_begins_before_a_contact_and_ends_after_it(lesson_page):
    page = lesson_page
    page.evaluate(WATCH_TURNS)
    press(page, 'm')
    wait_for_values(page, time_scale='0.12')
    assert text_of(page, 'speed-value') == 'slow 1 ×'
    wait_until(page, "window.speeds.includes('0.12')", 'a contact in slow motion')
    # On a busy machine the page may come too late for one contact, not for every one.
    wait_until(page, 'window.before.includes(true)', 'slow motion before a contact')
    press(page, 'm')
    wait_for_values(page, time_scale='1.0')
    wait_until(page, "document.getElementById('speed-value').innerText === '1 ×'")


# As a browser does with a tab that nobody sees.
HIDE_IN_SLOW_MOTION = """
bounce.playback.isSlow && bounce.node.values.time_scale === '0.12' && (() => {
  window.requestAnimationFrame = () => 0;
  Object.defineProperty(document, 'hidden', { value: true });
  document.dispatchEvent(new Event('visibilitychange'));
  return true;
})()
"""


def test_slow_motion_ends_when_the_page_is_hidden(lesson_page):
    press(lesson_page, 'm')
    wait_until(lesson_page, HIDE_IN_SLOW_MOTION)
    wait_for_values(lesson_page, time_scale='1.0')


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
    # Left sides, and their middle: of the first two lit, of the third not.
    picture, overlay = Picture(page), pixels_of(page, 'overlay')
    for x, y, is_lit in ((-0.5, 0.2, True), (0.3, 1.0, True), (1.5, 0.2, False)):
        px, py = (int(value) for value in picture.place(x, y))
        side = overlay[py, px - 2 : px + 3]
        assert is_near(side, picture.look['lit']).any() == is_lit
        assert is_lit or is_near(side, picture.look['dim'], 80).any(), 'a square all the same'
    page.evaluate('bounce.selectNext(1)')
    wait_until(page, "!document.getElementById('squares-say').classList.contains('lit')")
