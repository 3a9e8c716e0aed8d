"""bounce_record: its options, what it refuses, and what it costs."""

from __future__ import annotations

import io
import json
import subprocess
import sys
from dataclasses import replace
from functools import partial

import pytest
from conftest import files_of
from reading import record

from circle_bounce_ros.kernel import Circle, SceneError
from circle_bounce_ros.offline import bag, recording
from circle_bounce_ros.offline.record import main
from circle_bounce_ros.offline.recording import _circle, scene_text
from circle_bounce_ros.scene_file import load_scene
from circle_bounce_ros.scene_file.reading import LARGEST_FILE


@pytest.mark.parametrize('options', [[], ['--compress'], ['--format', 'parquet']])
def test_the_same_command_gives_the_same_bytes(tmp_path, bounce, options):
    command = ['mixed', '--duration', 2, *options, '-o']
    for run, place in ((partial(bounce.run, 'bounce_record'), 'a'), (record, 'b')):
        (tmp_path / place).mkdir()
        run(*command, tmp_path / place / 'out')
    assert files_of(tmp_path / 'a') == files_of(tmp_path / 'b')


@pytest.mark.parametrize('form', ['bag', 'parquet'])
def test_an_existing_target_is_refused_and_nothing_is_touched(tmp_path, capsys, form):
    folder = tmp_path / 'bag'
    folder.mkdir()
    (folder / 'precious').write_text('data')
    assert main(['lesson', '-o', str(folder), '--format', form]) == 1
    assert f'{folder}: exists already, nothing was touched' in capsys.readouterr().err
    assert files_of(tmp_path) == {'bag/precious': b'data'}


@pytest.mark.parametrize(
    ('arguments', 'reason'),
    [
        (['gaz'], 'scene: must be one of'),
        (['lesson', '--topics', 'poses', 'moon'], 'got moon'),
        (['lesson', '--topics', 'poses', '/poses'], 'topics: must be given once, got poses twice'),
        (['lesson', '--rate', '0'], 'rate: must be > 0'),
        (['lesson', '--duration', '0.001'], 'duration: must be at least one period'),
        (['lesson', '--duration', '1e9', '--rate', '1e6'], 'duration: must be at most 1000000000'),
        (['lesson', '--duration', 'nan'], 'duration: must be > 0'),
        (['lesson', '--frame-id', ''], 'frame-id: must not be empty'),
        (['lesson', '--frame-id', '\udcff'], 'frame-id: must be UTF-8'),  # the byte 0xff
        (['lesson', '--format', 'parquet', '--topics', 'poses'], 'must be from bodies, contacts'),
        (['gas', '--seed', '-1'], 'seed: must be'),
    ],
)
def test_what_is_wrong_is_said_and_leaves_nothing(tmp_path, capsys, arguments, reason):
    assert main([*arguments, '-o', str(tmp_path / 'bag')]) == 1
    assert reason in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_tables_are_refused_a_folder_that_is_not_utf8(tmp_path, capsys):
    assert main(['lesson', '--format', 'parquet', '-o', str(tmp_path / '\udcff')]) == 1
    assert 'output: must be UTF-8' in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    'others', [['lesson'], ['-o', 'out'], ['--duration', '5'], ['--compress'], ['--topics', 'a']]
)
def test_a_repair_with_other_options_is_refused(tmp_path, capsys, others):
    with pytest.raises(SystemExit) as caught:
        main(['--repair', str(tmp_path), *others])
    assert caught.value.code == 2
    assert '--repair goes with nothing else' in capsys.readouterr().err


def test_a_recording_takes_the_same_memory_however_long_it_is(tmp_path, bounce):
    script = (
        'import resource, sys\n'
        'from circle_bounce_ros.offline.record import main\n'
        'assert main(sys.argv[1:]) == 0\n'
        'print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)\n'
    )
    peaks = []
    for seconds in (2, 20):
        arguments = ['gas', '--duration', str(seconds), '--topics', 'poses', 'bodies', '-o']
        done = subprocess.run(
            [sys.executable, '-c', script, *arguments, str(tmp_path / f'bag{seconds}')],
            capture_output=True,
            text=True,
            check=True,
        )
        peaks.append(int(done.stdout.split()[-1]))
    # 91 MB more on the disk; 10 MB is what an allocator may keep.
    assert peaks[1] < peaks[0] + 10_000


def test_the_bar_on_a_terminal_tells_the_time_left(monkeypatch, tmp_path):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    terminal = Terminal()
    monkeypatch.setattr('sys.stderr', terminal)
    record('gas', '--duration', 5, '--topics', 'poses', '-o', tmp_path / 'bag')
    assert 'left' in terminal.getvalue()
    assert '100%' in terminal.getvalue()


def test_what_is_written_beside_a_recording_can_be_read_again(write_scene, monkeypatch):
    """The largest scene of a hundred thousand circles, and one that is larger than any file may be."""
    digits = 0.1234567890123456  # 16 of them, and a sign where there may be one
    item = Circle((-digits, -digits), (-digits, -digits), radius=digits, mass=1e-10 + digits)
    longest = json.dumps(_circle(replace(item, name='n' * 100)))
    assert 100_000 * (len(longest) + len(', ')) < LARGEST_FILE - 1e6
    scene = load_scene(write_scene(circles=[{'position': [0, 0], 'radius': 0.1}]))
    monkeypatch.setattr(recording, 'LARGEST_FILE', 100)
    with pytest.raises(SceneError, match='MB when written out'):
        scene_text(scene)


def test_more_topics_than_a_bag_can_have_are_refused_before_it_is_begun(
    tmp_path, capsys, write_scene, monkeypatch
):
    circles = [{'name': f'a{k}', 'position': [k, 0], 'radius': 0.1} for k in range(10)]
    scene = str(write_scene(circles=circles))
    monkeypatch.setattr(bag, 'MOST_TOPICS', 20)
    assert main([scene, '--duration', '1', '-o', str(tmp_path / 'all')]) == 1
    assert 'topics: must be at most 20 in a bag, got 27' in capsys.readouterr().err
    assert not (tmp_path / 'all').exists()
    some = [
        scene,
        '--duration',
        '1',
        '--topics',
        'a1/pose',
        'bodies',
        '-o',
        str(tmp_path / 'some'),
    ]
    assert main(some) == 0
