"""bounce_check as people call it: one line a file, an exit status, never a traceback."""

import os
import subprocess
import sys

import pytest
from bad_files import BAD_FILES, GOOD_CIRCLE

from circle_bounce_ros.installation import share_directory
from circle_bounce_ros.scene_file import scene_names

# Python's modules are found from a folder that has no scene files, wherever the test runs.
ROOT = str(share_directory())


def bounce_check(*arguments, cwd=None):
    environment = {**os.environ, 'PYTHONPATH': ROOT, 'PYTHONWARNINGS': 'error'}
    return subprocess.run(
        [sys.executable, '-m', 'circle_bounce_ros.scene_file', *arguments],
        cwd=cwd,
        env=environment,
        capture_output=True,
        text=True,
        errors='surrogateescape',
        timeout=120,
        check=False,
    )


def test_each_bad_file_has_its_sentence(bad_folder):
    result = bounce_check(*(f'{name}.yaml' for name in BAD_FILES), cwd=bad_folder)
    assert result.stdout.splitlines() == [
        f'{name}.yaml: {sentence}' for name, (_, sentence) in BAD_FILES.items()
    ]
    assert result.stderr == ''
    assert result.returncode == 1


def test_what_cannot_be_read_has_its_sentence_too(tmp_path):
    os.mkfifo(tmp_path / 'pipe.yaml')
    (tmp_path / 'folder').mkdir()
    odd = os.fsdecode(b'gr\xfcn.yaml')
    (tmp_path / odd).write_text('[]')
    arguments = [
        'pipe.yaml',
        './folder',
        'missing.yaml',
        'pipe.yaml/x.yaml',
        odd,
        '/dev/null',
        'no',
    ]
    result = bounce_check(*arguments, cwd=tmp_path)
    assert result.stdout.splitlines() == [
        'pipe.yaml: must be a regular file, got a pipe, socket or device',
        './folder: must be a file, got a directory',
        'missing.yaml: must be a file, got a path where there is none',
        'pipe.yaml/x.yaml: must be a readable file, got an error: Not a directory',
        'gr\\udcfcn.yaml: must be a mapping, got []',
        '/dev/null: must be a regular file, got a pipe, socket or device',
        'scene: must be one of billiard, break, digits_of_pi, gas, lesson, mixed, pegboard, '
        "or a path (with '/' or ending in .yaml), got 'no'",
    ]
    assert result.stderr == ''
    assert result.returncode == 1


def test_the_packaged_scenes_are_fine():
    result = bounce_check(*scene_names())
    assert result.stdout.splitlines() == [
        'billiard: ok, 1 moving circle, 1 locked, 4 walls',
        'break: ok, 16 moving circles, 0 locked, 4 walls',
        'digits_of_pi: ok, 2 moving circles, 0 locked, 1 wall',
        'gas: ok, 1000 moving circles, 0 locked, 4 walls',
        'lesson: ok, 1 moving circle, 1 locked, 4 walls',
        'mixed: ok, 160 moving circles, 5 locked, 4 walls',
        'pegboard: ok, 300 moving circles, 28 locked, 9 walls',
    ]
    assert result.stderr == ''
    assert result.returncode == 0


def test_one_bad_file_among_good_ones_is_enough_for_status_1(tmp_path):
    (tmp_path / 'good.yaml').write_text(GOOD_CIRCLE)
    (tmp_path / 'bad.yaml').write_text('')
    result = bounce_check('good.yaml', 'bad.yaml', 'good.yaml', cwd=tmp_path)
    assert result.stdout.splitlines() == [
        'good.yaml: ok, 1 moving circle, 0 locked, 0 walls',
        'bad.yaml: must have circles or groups, got an empty file',
        'good.yaml: ok, 1 moving circle, 0 locked, 0 walls',
    ]
    assert result.returncode == 1


@pytest.mark.parametrize('arguments', [[], ['--nonsense']])
def test_wrong_usage_exits_with_status_2(arguments):
    result = bounce_check(*arguments)
    assert result.stdout == ''
    assert result.stderr.startswith('usage: bounce_check')
    assert result.returncode == 2
