"""Compiled code is kept between runs, for this very source, wherever there is a place for it."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import circle_bounce_ros.kernel
from circle_bounce_ros.kernel.engine import compilation

pytest.importorskip('numba', reason='numba is not installed: there is nothing to compile')

KERNEL = Path(circle_bounce_ros.kernel.__file__).parent

# Prints where compiled code is kept, whether it was ready, and the CPU time of the first call (unless told to look).
FIRST_CALL = """
import sys, time
from circle_bounce_ros.kernel import Circle, Scene, Simulation, compile_ahead, compiled_code_is_ready
from circle_bounce_ros.kernel.engine import compilation
ready = compiled_code_is_ready()
if sys.argv[1:] == ['look']:
    print(compilation.cache_directory(), ready, 0.0)
    sys.exit()
began = time.process_time()
compile_ahead()
simulation = Simulation(Scene([Circle((0.0, 0.0), (1.0, 0.0), radius=1.0)]), compiled=True)
simulation.advance_to(1.0)
assert simulation.positions.tolist() == [[1.0, 0.0]]
print(compilation.cache_directory(), ready, time.process_time() - began)
"""


@pytest.fixture
def package(tmp_path):
    """Return a folder with a kernel of its own to import, whose source may be changed."""
    target = tmp_path / 'package/circle_bounce_ros'
    target.mkdir(parents=True)
    (target / '__init__.py').touch()
    shutil.copytree(KERNEL, target / 'kernel', ignore=shutil.ignore_patterns('__pycache__'))
    return target.parent


def first_call(package, *arguments, **variables):
    """Return what FIRST_CALL finds in a new process: folder, whether it was ready, s of CPU."""
    environment = {**os.environ, 'PYTHONPATH': str(package), **variables}
    command = [sys.executable, '-c', FIRST_CALL, *arguments]
    output = subprocess.check_output(command, env=environment, cwd=package, text=True)
    folder, ready, seconds = output.split()
    return Path(folder), ready == 'True', float(seconds)


def test_compiled_code_survives_between_runs_until_the_source_changes(package, tmp_path):
    place = {'XDG_CACHE_HOME': str(tmp_path / 'cache')}
    folder, ready, cold = first_call(package, **place)
    assert not ready
    assert folder.is_relative_to(tmp_path / 'cache')
    same, ready, warm = first_call(package, **place)
    assert ready
    assert same == folder
    # Measured: 7 s and 0.5 s. What is wanted, 8 s and 0.6 s, with the margin of a machine that others use.
    assert cold < 30.0
    assert warm < min(3.0, cold / 3.0)
    with (package / 'circle_bounce_ros/kernel/reflection.py').open('a') as source:
        source.write('# changed\n')
    other, ready, _ = first_call(package, 'look', **place)
    assert not ready
    assert other != folder


def test_a_package_that_cannot_be_written_to_and_no_home_break_nothing(package, tmp_path):
    """Root may write anywhere, so what cannot be written to is under a file."""
    (tmp_path / 'file').touch()
    temporary = tmp_path / 'temporary'
    temporary.mkdir()
    subprocess.run(['chmod', '-R', 'a-w', str(package)], check=True)
    nowhere = str(tmp_path / 'file/cache')
    place = {'XDG_CACHE_HOME': nowhere, 'HOME': nowhere, 'TMPDIR': str(temporary)}
    folder, _, _ = first_call(package, **place)
    assert folder.is_relative_to(temporary)
    subprocess.run(['chmod', '-R', 'u+w', str(package)], check=True)
    assert not list(package.rglob('*.nbi'))


def test_with_no_place_at_all_compiled_code_is_not_kept(monkeypatch, tmp_path):
    (tmp_path / 'file').touch()
    nowhere = str(tmp_path / 'file/cache')
    monkeypatch.setenv('XDG_CACHE_HOME', nowhere)
    monkeypatch.setattr(compilation.tempfile, 'gettempdir', lambda: nowhere)
    assert compilation.cache_directory() is None
    assert not compilation.compiled_code_is_ready()
