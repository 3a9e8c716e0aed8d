"""The drawings are what the kernel says today, and what can be worked out by hand."""

import math
import subprocess
import sys
from pathlib import Path

import pytest
from png import numbers_of, numbers_text_of, size_of

pytest.importorskip('matplotlib', reason='the drawings need matplotlib: the extra `docs`')

ROOT = Path(__file__).resolve().parents[2]
IMAGES = ROOT / 'docs' / 'images'


def draw(*arguments):
    command = [sys.executable, '-W', 'error', '-m', 'docs.figures', *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300)


@pytest.fixture(scope='module')
def drawn(tmp_path_factory):
    """Return the folder with all drawings, made afresh."""
    folder = tmp_path_factory.mktemp('images')
    done = draw('--into', folder)
    assert done.returncode == 0, done.stderr
    return folder


def test_the_script_makes_exactly_the_images_of_the_documents(drawn):
    assert sorted(p.name for p in drawn.iterdir()) == sorted(p.name for p in IMAGES.iterdir())


def test_the_images_of_the_documents_show_what_the_kernel_says_today(drawn):
    """If this fails for good reason: `python -m docs.figures`, look at the images, commit them."""
    for image in sorted(IMAGES.iterdir()):
        assert numbers_text_of(drawn / image.name) == numbers_text_of(image), image.name
        assert size_of(drawn / image.name) == size_of(image), image.name


def test_a_drawing_is_the_same_each_time(drawn, tmp_path):
    assert draw('--into', tmp_path, 'angles', 'lesson').returncode == 0
    for name in ('angles.png', 'lesson.png'):
        assert (tmp_path / name).read_bytes() == (drawn / name).read_bytes()


def test_an_unknown_drawing_is_refused(tmp_path):
    done = draw('--into', tmp_path, 'moon')
    assert done.returncode == 2
    assert done.stderr.strip().endswith('got moon')


# By hand, from the numbers in the drawings alone. Images keep six digits: hence 1e-5.
SIX_DIGITS = 1e-5


@pytest.mark.parametrize(
    ('image', 'by_hand'),
    [
        ('distance', {'D': math.sqrt(1.8**2 + 1.2**2)}),
        ('contact_test', {'apart: in contact': 0, 'touching: in contact': 1}),
        ('squares', {'D': math.sqrt(0.85**2 + 0.8**2), 'boxes overlap': 1, 'in contact': 0}),
        # Centres 1.3 apart along (12, 5) / 13, half a metre of it inside circle 1.
        ('contact_point', {'x': 0.5 * 12 / 13, 'y': 0.5 * 5 / 13, 'nx': 12 / 13, 'ny': 5 / 13}),
        # 0.4 m beside the line of centres, 0.75 m apart: a right triangle. 2.35 m ahead at 3 m/s.
        ('first_touch', {'t': (2.35 - math.sqrt(0.75**2 - 0.4**2)) / 3, 'D': 0.75}),
        # Off a slope of 53.13 degrees along (4, 3): along 1.08 stays, across 0.81 turns round.
        (
            'reflection',
            {"tilted v'h": 1.08 * 0.8 - 0.81 * 0.6, "tilted v'v": 1.08 * 0.6 + 0.81 * 0.8},
        ),
        # v = (3, 4), n = (12, 5) / 13: v.n = 56 / 13.
        ('angles', {"v'h": 3 - 2 * 56 * 12 / 169, "v'v": 4 - 2 * 56 * 5 / 169}),
        # Along the normal 1.6 m/s: all of it to an equal mass, half of it to three times the mass.
        ('exchange', {"1 kg v2'h": 1.6 * 0.8, "1 kg v1'v": -1.6 * 0.6, "3 kg v2'v": 0.8 * 0.6}),
        ('digits_of_pi', {'contacts': 31}),
        ('scene_digits_of_pi', {'moving': 2}),
        ('scene_gas', {'moving': 1000}),
    ],
)
def test_the_numbers_drawn_are_those_worked_out_by_hand(drawn, image, by_hand):
    numbers = numbers_of(drawn / f'{image}.png')
    assert {name: numbers[name] for name in by_hand} == pytest.approx(by_hand, rel=SIX_DIGITS)


def test_the_angles_drawn_are_the_lessons(drawn):
    numbers = numbers_of(drawn / 'angles.png')
    tolerance = 1e-3  # degrees: six digits of up to 180
    assert numbers['A_v'] == pytest.approx(math.degrees(math.acos(3 / 5)), abs=tolerance)
    assert numbers['A_n'] == pytest.approx(math.degrees(math.acos(12 / 13)), abs=tolerance)
    assert numbers['A_d'] == pytest.approx(numbers['A_v'] - numbers['A_n'], abs=tolerance)
    after = numbers['A_v'] - 2 * numbers['A_d'] + 180
    assert numbers['A_pc'] == pytest.approx(after, abs=tolerance)


def test_the_laws_drawn_hold(drawn):
    free = numbers_of(drawn / 'free_path.png')
    # Single runs scatter by 2 %, the mean of 40 by 0.3 %: three standard deviations.
    assert free['measured'] == pytest.approx(free['pi A / P'], rel=0.01)
    gas = numbers_of(drawn / 'speeds.png')
    # 150 looks at 196 circles, a tenth of them independent: 0.5 / sqrt(2900), three times.
    assert gas['mean speed'] == pytest.approx(gas['Maxwell'], rel=0.03)
