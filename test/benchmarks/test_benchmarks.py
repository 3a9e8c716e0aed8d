"""The benchmark in its short form: it runs, says every line of the tables, and judges by what is known."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from circle_bounce_ros.installation import child_environment

ROOT = Path(__file__).resolve().parents[2]
PYTHON = ROOT / '.venvs/bench/bin/python'


def run(python, *arguments, environment=None):
    done = subprocess.run(
        [str(python), *map(str, arguments)],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        timeout=150,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def report(folder, readme):
    """Make the document, and put the short form into a copy of the README."""
    shutil.copy(ROOT / 'README.md', readme)
    command = ('-m', 'benchmarks.report', '--folder', folder, '--readme', readme)
    run(PYTHON, *command, environment=child_environment())


@pytest.fixture(scope='module')
def folder(tmp_path_factory):
    """Return where the short form has put everything."""
    if not PYTHON.exists():
        pytest.skip('no .venvs/bench: make .venvs/bench makes it')
    folder = tmp_path_factory.mktemp('docs') / 'benchmarks'
    run(
        PYTHON,
        '-m',
        'benchmarks.engine',
        '--short',
        '--into',
        folder,
        environment=child_environment(),
    )
    report(folder, folder.parent / 'README.md')
    return folder


@pytest.fixture(scope='module')
def engine(folder):
    return json.loads((folder / 'engine.json').read_text())


def test_every_peer_takes_part(engine):
    against = {row['against'] for row in engine['rows']}
    assert {'pymunk', 'pymunk, 10 substeps', 'Box2D', 'python-billiards'} <= against


def test_every_line_has_a_number_and_its_spread(engine):
    for row in engine['rows']:
        assert 0.0 < row['low'] <= row['median'] <= row['high'], row


def test_the_exact_engine_is_exact_and_nobody_leaves(engine):
    for one in engine['accuracy']:
        if one['name'] == 'circle_bounce_ros':
            # A few hundred contacts, each a rounding of 1e-16 of the energy at most.
            assert abs(one['energy_error']) < 1e-13
            assert one['deepest_overlap'] < 1e-12
            assert one['escaped'] == 0


def test_the_judge_sees_what_a_step_of_a_frame_does_to_fast_disks(engine):
    """At a hundred radii a frame most disks jump through a wall: a judge that finds none is blind."""
    pymunk = [one for one in engine['accuracy'] if one['name'] == 'pymunk']
    slow, fast = sorted(pymunk, key=lambda one: one['escaped'])
    assert slow['escaped'] == 0
    assert fast['escaped'] > 0.5 * fast['count']
    assert slow['deepest_overlap'] > 0.01


def test_the_document_shows_every_line(folder, engine):
    document = folder.with_suffix('.md').read_text()
    for row in engine['rows']:
        assert f'| {row["scene"]} | {row["against"]} |' in document
    for name in ('cost.png', 'speed.png'):
        assert f'(benchmarks/{name})' in document
        assert (folder / name).stat().st_size > 5_000


def test_the_committed_document_is_made_of_the_committed_numbers(tmp_path):
    if not PYTHON.exists():
        pytest.skip('no .venvs/bench: make .venvs/bench makes it')
    folder = tmp_path / 'benchmarks'
    folder.mkdir()
    for path in (ROOT / 'docs/benchmarks').glob('*.json'):
        (folder / path.name).write_bytes(path.read_bytes())
    readme = tmp_path / 'README.md'
    report(folder, readme)
    assert folder.with_suffix('.md').read_text() == (ROOT / 'docs/benchmarks.md').read_text()
    assert readme.read_text() == (ROOT / 'README.md').read_text()


def test_a_short_long_run_keeps_its_energy(tmp_path):
    run(sys.executable, '-m', 'benchmarks.long_run', '1e5', '--into', tmp_path)
    found = json.loads((tmp_path / 'long_run.json').read_text())
    assert found['contacts'] >= 100_000
    # Fewer contacts than there are in the run that allows 1e-13.
    assert found['largest_energy_error'] < 1e-13


def test_the_node_is_watched_over_dds(tmp_path):
    pytest.importorskip('rclpy', reason='the node needs ROS')
    run(sys.executable, '-m', 'benchmarks.node', '--short', '--into', tmp_path)
    rows = json.loads((tmp_path / 'node.json').read_text())['rows']
    found = {(row['scene'], row['against']): row['median'] for row in rows}
    assert found['one named circle at 1,000 Hz', 'largest error of a position'] == 0.0
    assert found['one named circle at 1,000 Hz', 'messages that came'] > 10.0
    assert found['200 disks, bodies at 30 Hz', 'CPU'] > 0.0
