"""Trails, the histogram of speeds and the plot of the energy, by their pixels."""

import math

import numpy as np
import pytest
from browsing import press, restart_paused, step, text_of, wait_until
from observing import read_points
from picture import Picture, is_near, pixels_of
from sensor_msgs.msg import PointCloud2

RATE = 60.0  # Hz, the node's default


# Trails


@pytest.fixture
def straight(tmp_path):
    """Return the path of a scene in which one circle goes straight on: 2 m/s for more than 2 s."""
    path = tmp_path / 'straight.yaml'
    path.write_text(
        'circles:\n  - {position: [-2, 0], velocity: [2, 0], radius: 0.05}\n'
        'walls:\n  - box: {min: [-3, -1], max: [3, 1]}\n'
    )
    return path


@pytest.mark.parametrize('seconds', [0.0, 0.25, 0.5])
def test_a_trail_is_as_long_as_chosen(show, straight, seconds):
    page = show(straight)
    page.locator('#trails').fill(str(seconds))
    assert text_of(page, 'trails-value') == (f'{seconds:g} s' if seconds else 'off')
    restart_paused(page)
    step(page, 40)
    picture = Picture(page)
    x, y = page.evaluate("[bounce.world.get(0, 'x'), bounce.world.get(0, 'y')]")
    assert x == pytest.approx(-2 + 2 * 40 / RATE, abs=1e-6)
    px, py = (int(value) for value in picture.place(x, y))
    wall, _ = picture.place(-3, 0)
    # A line is a pixel wide; its oldest end is faint.
    lit = picture.contrast[py - 1 : py + 2].max(axis=0) > 6
    behind = np.flatnonzero(lit[int(wall) + 4 : px]) + int(wall) + 4
    length = (px - behind.min()) / picture.scale if behind.size else 0.0
    # As many whole periods as fit, up to one more or less; without a trail there is the circle itself.
    assert length == pytest.approx(max(2 * seconds, 0.05), abs=2 / RATE + 2 / picture.scale)
    ahead = np.flatnonzero(lit[px:]) + px
    beyond = ahead[(ahead - px) / picture.scale > 0.06]
    assert beyond.min() > picture.place(2.9, 0)[0], 'nothing ahead of it but the wall'


def test_trails_end_where_the_scene_begins_again(show, straight):
    page = show(straight)
    page.locator('#trails').fill('4')
    restart_paused(page)
    step(page, 5)
    assert page.evaluate('bounce.picture.past.length') == 6
    press(page, 'r')
    wait_until(page, 'bounce.world.seconds === 0 && !bounce.isDirty')
    picture = Picture(page)
    py = int(picture.place(0, 0)[1])
    px = int(picture.place(-1.9, 0)[0])
    assert picture.contrast[py, px : px + 20].max() < 6


REMEMBER = """
(count) => {
  const { picture, world: { bytes, cloud } } = bounce;
  picture.forget();
  const past = [];
  for (let tick = 0; tick <= 600; tick += 1) {
    picture.setBodies({ bytes, cloud, count, seconds: tick / 60 }, true, 4);
    past.push(picture.past.map(({ time }) => time));
  }
  return past;
}
"""


def test_trails_of_many_circles_have_fewer_pieces_and_the_same_length(show):
    page = show(paused=True)
    for count in (1, 160, 1000, 4000):
        longest_piece = max(4 * count / 40000, 0) + 2 / RATE
        for tick, times in enumerate(page.evaluate(REMEMBER, count)):
            assert times[-1] == tick / 60, 'it reaches to the circle'
            assert 4 - longest_piece < times[-1] - times[0] <= 4 or times[0] == 0
            assert np.diff(times).max(initial=0) < longest_piece
            assert len(times) - 1 <= min(4 * RATE, 40000 / count) + 1


def test_where_trails_would_be_too_many_the_page_says_so(show, many):
    page = show(many, 10000)
    assert text_of(page, 'trails-value') == 'off'
    page.locator('#trails').fill('4')
    assert text_of(page, 'trails-value') == 'too many circles'
    assert page.locator('#trails').input_value() == '0'


# Speeds


def test_the_histogram_is_that_of_the_speeds_on_the_topic(show, observer):
    page = show('gas', 1000, paused=True)
    points = read_points(observer.collect(observer.listen(PointCloud2, 'bodies'), 1)[0])
    speeds = np.hypot(points['vx'], points['vy'])
    sigma = math.sqrt(np.mean(speeds**2) / 2)
    wait_until(
        page, "document.getElementById('histogram-note').textContent.includes('1,000 circles')"
    )
    said = text_of(page, 'histogram-note').rpartition(' = ')[2].partition(' ')[0]
    assert float(said) == pytest.approx(sigma, rel=0.005)  # shown with three digits

    pixels = pixels_of(page, 'histogram')
    look = page.evaluate('bounce.looks.colours')
    height, width, _ = pixels.shape
    curve = is_near(pixels, look['curve'])
    base = height - 16
    tops = {
        x: base - np.flatnonzero(curve[:, x]).mean() for x in range(width) if curve[:base, x].any()
    }
    # Maxwell's law in the plane, v / s^2 exp(-v^2 / 2 s^2), is highest at s; the axis goes to 4 s.
    assert max(tops, key=tops.get) == pytest.approx(width / 4, abs=0.04 * width)
    for share, expected in ((0.5, 2 * math.exp(-1.5)), (0.75, 3 * math.exp(-4.0))):
        at = min(tops, key=lambda x: abs(x - share * width))
        # Within 3 px of some 90: the line is two pixels wide.
        assert tops[at] == pytest.approx(expected * max(tops.values()), abs=3)
    bins = np.histogram(np.minimum(speeds, 3.999 * sigma), 28, (0, 4 * sigma))[0]
    bars = is_near(pixels, look['bar'])
    wide = (width - 4) / 28
    for number, count in enumerate(bins):
        column = bars[:base, int(2 + number * wide) + 1 : int(2 + (number + 1) * wide) - 1]
        rows = np.flatnonzero(column.any(axis=1))
        shown = base - rows.min() if rows.size else 0
        # The curve of the same area is the measure of the bars.
        density = count / 1000 * 28 / (4 * sigma)
        expected = density / (math.exp(-0.5) / sigma) * max(tops.values())
        assert shown == pytest.approx(expected, abs=5), number


def test_a_few_circles_are_no_distribution(lesson_page):
    wait_until(lesson_page, "document.getElementById('histogram-note').textContent !== ''")
    assert 'no distribution' in text_of(lesson_page, 'histogram-note')


# Energy


def test_the_energy_of_the_lesson_is_a_straight_line(lesson_page):
    page = lesson_page
    wait_until(page, "document.getElementById('energy-note').textContent.includes('1 part in 10')")
    assert 'within 1 part in 10¹²' in text_of(page, 'energy-note')
    # Two reports make a line, and its level is that of E0.
    wait_until(page, 'bounce.energyPlot.samples.length >= 3')
    page.evaluate('bounce.refreshNumbers(performance.now())')
    pixels = pixels_of(page, 'energy')
    curve = is_near(pixels, page.evaluate('bounce.looks.colours.curve'))
    rows, columns = np.nonzero(curve)
    assert rows.max() - rows.min() <= 2
    assert columns.max() >= pixels.shape[1] - 6


DRAW_ENERGY = """
async () => {
  const { EnergyPlot } = await import('/plots.js');
  const canvas = document.getElementById('energy');
  const plot = new EnergyPlot(canvas);
  for (let second = 0; second <= 300; second += 1) plot.add(second, (second / 300) * 9e-4);
  return [plot.draw(bounce.looks.colours), plot.samples.length];
}
"""


def test_an_energy_that_grows_is_seen_to_grow(stage, open_page):
    page = open_page(stage.address)
    page.evaluate('bounce.refreshNumbers = () => {}')
    said, kept = page.evaluate(DRAW_ENERGY)
    assert 'within 1 part in 10³' in said
    assert kept == 121, 'two minutes'
    pixels = pixels_of(page, 'energy')
    curve = is_near(pixels, page.evaluate('bounce.looks.colours.curve'))
    height = {x: np.flatnonzero(curve[:, x]).mean() for x in np.flatnonzero(curve.any(axis=0))}
    left, right = min(height), max(height)
    # From 60 % of the way up to the top line; both ends are on the straight line between.
    assert right - left > 0.95 * pixels.shape[1]
    assert height[right] < height[left] - 5
    middle = min(height, key=lambda x: abs(x - (left + right) / 2))
    assert height[middle] == pytest.approx((height[left] + height[right]) / 2, abs=1)
