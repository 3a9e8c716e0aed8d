"""Nothing here imports ROS, and who has not installed the extra is told so."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

# Refuses to import what is asked for, as where it is not installed.
BLOCK = """
import sys
class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.partition('.')[0] in {names!r}:
            raise ModuleNotFoundError(f'No module named {{name!r}}', name=name.partition('.')[0])
sys.meta_path.insert(0, Missing())
"""
ROS = {'rclpy', 'rosgraph_msgs', 'geometry_msgs', 'sensor_msgs', 'std_msgs', 'visualization_msgs'}


def run_without(names, code, *arguments):
    program = BLOCK.format(names=names) + code
    return subprocess.run(
        [sys.executable, '-c', program, *arguments],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=120,
    )


def test_every_module_is_imported_without_ros():
    folder = ROOT / 'circle_bounce_ros/offline'
    paths = [path.relative_to(ROOT).with_suffix('') for path in sorted(folder.rglob('[a-z]*.py'))]
    names = ['.'.join(path.parts) for path in paths]
    assert len(names) > 10
    done = run_without(ROS, '\n'.join(f'import {name}' for name in names))
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ('command', 'library'),
    [('record', 'rosbags'), ('record', 'mcap'), ('plot', 'matplotlib'), ('sweep', 'distributed')],
)
def test_a_library_that_is_missing_is_named_with_how_to_get_it(command, library):
    code = (
        f'from circle_bounce_ros.offline.commands import {command}_main as main; sys.exit(main())'
    )
    done = run_without({library}, code, '--help')
    assert done.returncode == 1
    assert done.stderr.startswith(f'bounce_{command}: needs {library}, which is not installed')
    assert "in a clone of circle_bounce_ros: pip install '.[offline]'" in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize('command', ['record', 'plot', 'sweep'])
def test_each_command_is_installed_and_helps(command):
    path = Path(sys.prefix) / 'bin' / f'bounce_{command}'
    if not path.exists():
        pytest.skip(f'{path} is not there: install the package')
    done = subprocess.run([path, '--help'], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0
    assert f'usage: bounce_{command}' in done.stdout
