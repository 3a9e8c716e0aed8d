"""bounce_plot: what the pictures show is what is so."""

from __future__ import annotations

import math
import signal

import numpy as np
import pyarrow as pa
import pytest
from conftest import files_of
from PIL import Image
from pyarrow import parquet

from circle_bounce_ros.kernel import Circle, ContactKind, Scene, Simulation, Wall
from circle_bounce_ros.offline import record
from circle_bounce_ros.offline.bag_source import of_bag
from circle_bounce_ros.offline.expected import billiard_of
from circle_bounce_ros.offline.observables import open_border
from circle_bounce_ros.offline.pictures import style
from circle_bounce_ros.offline.pictures.free_path import free_path
from circle_bounce_ros.offline.pictures.speeds import speeds
from circle_bounce_ros.offline.plot import main
from circle_bounce_ros.offline.source import of_scene
from circle_bounce_ros.scene_file import load_scene


def numbers_of(text):
    """Return the numbers of a picture by name, from `a = 1; b = 2`."""
    parts = (part.rsplit(' = ', 1) for part in text.split('; '))
    return {name: float(value) for name, value in parts}


@pytest.fixture
def draw(tmp_path, capsys):
    """Return a function that draws and returns the picture's numbers."""

    def draw(picture, source, *options, name='picture.png'):
        path = tmp_path / name
        status = main([picture, str(source), '-o', str(path), *map(str, options)])
        out, error = capsys.readouterr()
        assert status == 0, error
        return numbers_of(out.removeprefix(f'{path}: '))

    return draw


@pytest.fixture(scope='module')
def gas_bag(tmp_path_factory):
    folder = tmp_path_factory.mktemp('bags') / 'gas'
    command = ['gas', '--duration', '4', '--rate', '10', '-o', str(folder)]
    assert record.main([*command, '--topics', 'bodies', 'contacts', 'markers/static']) == 0
    return folder


@pytest.mark.parametrize(
    ('picture', 'source', 'name'),
    [
        ('trajectories', 'lesson', 'a.png'),
        ('trajectories', 'digits_of_pi', 'a.svg'),
        ('trajectories', 'gas', 'a.svg'),
        ('speeds', 'mixed', 'a.png'),
        ('energy', 'mixed', 'a.png'),
        ('free_path', 'lesson', 'a.png'),
        ('free_path', 'mixed', 'a.png'),
        ('animation', 'lesson', 'a.gif'),
    ],
)
def test_every_picture_is_drawn_the_same_each_time(tmp_path, draw, picture, source, name):
    draw(picture, source, '--duration', 2, name=name)
    first = (tmp_path / name).read_bytes()
    draw(picture, source, '--duration', 2, '--force', name=name)
    assert (tmp_path / name).read_bytes() == first
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_a_png_keeps_its_numbers_and_fits_a_readme(tmp_path, draw):
    numbers = draw('energy', 'gas', '--duration', 2)
    picture = Image.open(tmp_path / 'picture.png')
    assert numbers_of(picture.text['Numbers']) == numbers
    assert picture.width == 960
    assert (tmp_path / 'picture.png').stat().st_size < 150_000


def test_colours_that_eyes_tell_apart_reach_the_png_as_they_are(tmp_path, draw):
    draw('trajectories', 'break')
    pixels = np.asarray(Image.open(tmp_path / 'picture.png').convert('RGB')).reshape(-1, 3)
    colours, counts = np.unique(pixels, axis=0, return_counts=True)
    seen = {bytes(c).hex().upper() for c, n in zip(colours, counts, strict=True) if n > 100}
    assert {'FFFFFF', *(color.lstrip('#') for color in style.CYCLE)} <= seen


def simulated_deuteranope(color):
    """Return how somebody without green cones sees a colour, linear RGB (Vienot, Brettel and Mollon 1999)."""
    srgb = np.array([int(color[k : k + 2], 16) for k in (1, 3, 5)]) / 255
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    to_cones = np.array(
        [[17.8824, 43.5161, 4.11935], [3.45565, 27.1554, 3.86714], [0.0299566, 0.184309, 1.46709]]
    )
    cones = to_cones @ linear
    cones[1] = 0.494207 * cones[0] + 1.24827 * cones[2]
    return np.linalg.solve(to_cones, cones)


def test_lines_differ_for_who_cannot_tell_red_from_green():
    seen = [simulated_deuteranope(color) for color in style.CYCLE]
    apart = [np.abs(a - b).max() for k, a in enumerate(seen) for b in seen[:k]]
    # Pure red and the green that such an eye takes for it are 0 apart; black and white 1.
    assert min(apart) > 0.1


def test_where_no_moving_circles_hit_each_other_maxwells_law_is_not_claimed():
    def said(name):
        figure, _ = speeds(of_scene(load_scene(name), 2.0, 10.0))
        return ' '.join(text.get_text() for text in figure.axes[0].texts)

    assert 'not for these' in said('pegboard')
    assert 'not for these' in said('billiard')
    assert 'not for these' not in said('mixed')


def test_an_animation_shows_the_circle_where_the_kernel_has_it(tmp_path, draw):
    numbers = draw('animation', 'lesson', '--duration', 2, name='a.gif')
    assert numbers['frames'] == 41  # at 20 Hz, the first instant included
    simulation = Simulation(load_scene('lesson'))
    with Image.open(tmp_path / 'a.gif') as gif:
        assert gif.n_frames == 41
        for k in range(0, 41, 8):
            gif.seek(k)
            assert gif.info['duration'] == 50  # ms
            simulation.advance_to(k / 20)
            pixels = np.asarray(gif.convert('RGB')).astype(int)
            greenish = pixels[..., 1] - pixels[..., 0] > 20
            rows, columns = np.nonzero(greenish)
            # 4 m and a rim of 2 % on both sides are 480 px.
            metres = 4.16 / 480
            x, y = columns.mean() * metres - 2.08, 1.58 - rows.mean() * metres
            assert (x, y) == pytest.approx(tuple(simulation.positions[0]), abs=2 * metres)


def test_a_picture_of_a_bag_says_what_that_of_the_scene_says(draw, gas_bag):
    from_bag = draw('free_path', gas_bag)
    from_scene = draw('free_path', 'gas', '--duration', 4, '--rate', 10, '--force')
    # The bag begins with the first tick, and its numbers are float32.
    for name in ('packing', 'theory path', 'theory rate'):
        assert from_bag[name] == pytest.approx(from_scene[name], rel=0.01), name
    for name in ('mean free path', 'contact rate'):
        assert from_bag[name] == pytest.approx(from_scene[name], rel=0.05), name


def test_a_bag_without_its_scene_gives_the_same_states_and_walls(tmp_path, gas_bag):
    bare = tmp_path / 'bare'
    bare.mkdir()
    for path in gas_bag.iterdir():
        if path.name != 'scene.yaml':
            (bare / path.name).write_bytes(path.read_bytes())
    with_scene, without = (of_bag(folder, 9.0, 60.0) for folder in (gas_bag, bare))
    assert not without.masses_known
    assert with_scene.masses_known
    ends = [sorted((w.start, w.end) for w in s.scene.walls) for s in (with_scene, without)]
    assert ends[0] == ends[1]
    assert len(without.moving) == 1000
    for a, b in zip(with_scene.frames(), without.frames(), strict=True):
        np.testing.assert_array_equal(a.positions, b.positions)
        np.testing.assert_array_equal(a.contacts, b.contacts)


def test_speeds_of_a_gas_are_maxwells(draw):
    numbers = draw('speeds', 'gas')
    assert numbers['Maxwell'] == pytest.approx(math.sqrt(math.pi / 2), rel=1e-5)  # six digits
    # 1,000 circles, each some 90 times independent: 0.52 / sqrt(90,000), four times.
    assert numbers['mean speed'] == pytest.approx(numbers['Maxwell'], abs=0.007)


def test_a_gas_has_the_free_path_and_rate_of_enskog(draw):
    numbers = draw('free_path', 'gas', '--duration', 30)
    # Enskog's collision rate is exact but for chi, good to 0.5 %; 100,000 pairs in the window.
    assert numbers['mean free path'] == pytest.approx(numbers['theory path'], rel=0.015)
    assert numbers['contact rate'] == pytest.approx(numbers['theory rate'], rel=0.015)


def test_bars_of_the_contact_rate_are_those_of_independent_contacts():
    """Where walls and pairs are counted together: var(sum of ends) = sum of ends^2 over contacts."""
    scene = load_scene('mixed')
    figure, _ = free_path(of_scene(scene, 4.0, 10.0))
    bars = figure.axes[1].containers[0][2][0].get_segments()
    simulation = Simulation(scene, record_contacts=True)
    kinds = set()
    for k, bar in enumerate(bars, start=1):
        simulation.advance_to(k * 4.0 / len(bars))
        contacts = simulation.drain_contacts()['kind']
        ends = np.where(contacts == ContactKind.CIRCLE, 2.0, 1.0)
        circle_time = len(simulation.ids) * 4.0 / len(bars)
        middle, half = ends.sum() / circle_time, math.sqrt((ends**2).sum()) / circle_time
        assert bar[:, 1] == pytest.approx([middle - half, middle + half])
        kinds |= set(contacts)
    assert len(bars) == 20
    assert len(kinds) > 1


def test_a_billiard_has_the_free_path_pi_a_by_p(draw):
    numbers = draw('free_path', 'billiard', '--duration', 2000, '--rate', 1)
    area = 1.9**2 - math.pi * 0.45**2
    border = 4 * 1.9 + 2 * math.pi * 0.45
    assert numbers['theory path'] == pytest.approx(math.pi * area / border, rel=1e-5)
    # 3,000 contacts; single runs of 1,300 scatter by 2 %: three times that, less by sqrt(2.3).
    assert numbers['mean free path'] == pytest.approx(numbers['theory path'], rel=0.04)


def test_the_energy_of_a_scene_is_kept_to_roundings(draw):
    numbers = draw('energy', 'mixed', '--duration', 20)
    assert numbers['contacts'] > 1000
    assert numbers['largest'] < 1e-14


def test_the_closed_form_is_for_billiards_in_which_nothing_is_out_of_reach():
    box = [
        Wall((0, 0), (4, 0)), Wall((4, 0), (4, 3)), Wall((4, 3), (0, 3)), Wall((0, 3), (0, 0))
    ]  # fmt: skip
    ball = Circle((0.5, 0.5), (1, 0), radius=0.1)

    def post(x, y, radius=0.5):
        return Circle((x, y), radius=radius, locked=True)

    area, border = billiard_of(Scene([ball, post(2, 1.5)], box), True)
    assert area == pytest.approx(3.8 * 2.8 - math.pi * 0.36)
    assert border == pytest.approx(2 * (3.8 + 2.8) + 2 * math.pi * 0.6)
    assert billiard_of(Scene([ball, post(2, 1.5), post(3.15, 1.5)], box), True) is None
    assert billiard_of(Scene([ball, post(3.35, 1.5)], box), True) is None
    assert billiard_of(Scene([ball, Circle((1, 1), radius=0.1)], box), True) is None
    assert open_border(Scene([ball], box[:3])) is None
    tilted = [
        Wall((0, -3), (3, 0)),
        Wall((3, 0), (0, 3)),
        Wall((0, 3), (-3, 0)),
        Wall((-3, 0), (0, -3)),
    ]
    assert open_border(Scene([ball], tilted)) is None


@pytest.mark.parametrize(
    ('arguments', 'reason'),
    [
        (['energy', 'gaz'], 'scene: must be one of'),
        (['energy', 'lesson', '-o', 'a.gif'], 'output: must end in .png or .svg, got a.gif'),
        (['animation', 'lesson', '-o', 'a.png'], 'output: must end in .gif, got a.png'),
        (['energy', '.', '-o', 'a.png'], 'has no metadata.yaml'),
        (['pressure', '.', '-o', 'a.png'], 'must be the folder of a sweep'),
        (['pressure', '.', '-o', 'a.png', '--seed', '1'], 'seed: does not go with a sweep'),
        (['pressure', '.', '-o', 'a.png', '--duration', '1'], 'duration: does not go with'),
        (['pressure', '.', '-o', 'a.png', '--rate', '1'], 'rate: does not go with a sweep'),
        (['pressure', '.', '-o', 'a.png', '--namespace', 'a'], 'namespace: does not go with'),
        (['energy', 'lesson', '--duration', '-1', '-o', 'a.png'], 'duration: must be > 0'),
        (['energy', 'lesson', '--duration', '0', '-o', 'a.png'], 'duration: must be > 0'),
        (['energy', 'lesson', '--namespace', 'a', '-o', 'a.png'], 'goes with a bag only'),
    ],
)
def test_what_is_wrong_is_said_and_leaves_nothing(
    tmp_path, capsys, monkeypatch, arguments, reason
):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 1
    assert reason in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ('write', 'reason'),
    [
        (lambda path: path.write_bytes(b'PAR1 no table'), 'cannot be read: '),
        (
            lambda path: parquet.write_table(pa.table({'packing': [0.1]}), path),
            'must be from a sweep, lacks the column compressibility',
        ),
    ],
)
def test_a_summary_that_is_none_is_said_in_one_sentence(tmp_path, capsys, write, reason):
    path = tmp_path / 'summary.parquet'
    write(path)
    assert main(['pressure', str(tmp_path), '-o', str(tmp_path / 'a.png')]) == 1
    error = capsys.readouterr().err
    assert f'bounce_plot: {path}: {reason}' in error
    assert len(error.splitlines()) == 1
    assert list(tmp_path.iterdir()) == [path]


def test_ctrl_c_ends_it_without_a_picture_and_without_a_word(tmp_path, capsys):
    arguments = ['animation', 'gas', '--duration', '5000', '-o', str(tmp_path / 'a.gif')]
    before = signal.signal(signal.SIGALRM, signal.default_int_handler)
    signal.setitimer(signal.ITIMER_REAL, 1.0)  # s; all of it would take an hour
    try:
        assert main(arguments) == 128 + signal.SIGINT
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert capsys.readouterr() == ('', '')
    assert list(tmp_path.iterdir()) == []


def test_the_line_of_the_theory_is_in_the_picture_however_far_it_is(write_scene):
    # Up and down only: 0.5 m instead of pi A / P.
    scene = write_scene(
        circles=[{'position': [2, 0.5], 'velocity': [0, 1], 'radius': 0.25}],
        walls=[{'box': {'min': [0, 0], 'max': [4, 1]}}],
    )
    figure, numbers = free_path(of_scene(load_scene(scene), 20.0, 10.0))
    assert numbers['mean free path'] == pytest.approx(0.5, rel=0.05)
    theory = math.pi * 3.5 * 0.5 / 8.0
    assert numbers['theory path'] == pytest.approx(theory)
    for axes, value in zip(figure.axes, (theory, 1.0 / theory), strict=True):
        low, high = axes.get_ylim()
        assert low < value < high


def test_a_picture_that_is_there_is_not_written_over(tmp_path, capsys):
    (tmp_path / 'a.png').write_text('precious')
    assert main(['energy', 'lesson', '-o', str(tmp_path / 'a.png')]) == 1
    assert 'exists already, nothing was touched' in capsys.readouterr().err
    assert files_of(tmp_path) == {'a.png': b'precious'}


def test_a_bag_without_bodies_and_one_cut_short_say_what_to_do(tmp_path, capsys, bounce):
    folder = tmp_path / 'bag'
    assert record.main(['lesson', '--topics', 'poses', '-o', str(folder), '--duration', '1']) == 0
    assert main(['energy', str(folder), '-o', str(tmp_path / 'a.png')]) == 1
    assert 'must hold the topic bodies, got /poses' in capsys.readouterr().err
    (folder / 'metadata.yaml').unlink()
    assert main(['energy', str(folder), '-o', str(tmp_path / 'a.png')]) == 1
    assert f'bounce_record --repair {folder}' in capsys.readouterr().err
