"""Compiled code is kept between runs, for this very source, wherever there is a place for it."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import circle_bounce_ros.kernel

pytest.importorskip('numba', reason='numba is not installed: there is nothing to compile')

KERNEL = Path(circle_bounce_ros.kernel.__file__).parent

# Prints the name of the file with compiled code, whether it was ready, and (unless told to look) the CPU time
# of the first call.
FIRST_CALL = """
import sys, time
from circle_bounce_ros.kernel import Circle, Scene, Simulation, compile_ahead, compiled_code_is_ready
from circle_bounce_ros.kernel.engine import code_cache
ready = compiled_code_is_ready()
if sys.argv[1:] == ['look']:
    print(code_cache.file_name(), ready, 0.0)
    sys.exit()
began = time.process_time()
compile_ahead()
simulation = Simulation(Scene([Circle((0.0, 0.0), (1.0, 0.0), radius=1.0)]), compiled=True)
simulation.advance_to(1.0)
assert simulation.positions.tolist() == [[1.0, 0.0]]
print(code_cache.file_name(), ready, time.process_time() - began)
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
    """Return what FIRST_CALL finds in a new process: the file, whether it was ready, s of CPU."""
    environment = {**os.environ, 'PYTHONPATH': str(package), **variables}
    command = [sys.executable, '-c', FIRST_CALL, *arguments]
    output = subprocess.check_output(command, env=environment, cwd=package, text=True)
    name, ready, seconds = output.split()
    return name, ready == 'True', float(seconds)


def test_compiled_code_survives_between_runs_until_the_source_changes(package, tmp_path):
    place = {'XDG_CACHE_HOME': str(tmp_path / 'cache')}
    subprocess.run(['chmod', '-R', 'a-w', str(package)], check=True)
    name, ready, cold = first_call(package, **place)
    assert not ready
    same, ready, warm = first_call(package, **place)
    assert ready
    assert same == name
    # Measured: 8 s and 0.5 s. What is wanted, 8 s and 0.6 s, with the margin of a machine that others use.
    assert cold < 30.0
    assert warm < min(3.0, cold / 3.0)
    subprocess.run(['chmod', '-R', 'u+w', str(package)], check=True)
    # In that one file and nowhere else: not beside the sources, which may be read-only.
    assert [path.name for path in tmp_path.glob('cache/*/*')] == [name]
    assert not list(package.rglob('*.nb[ic]'))
    # The same source at another place finds it: what colcon or pip has copied.
    moved = package.rename(package.with_name('moved'))
    assert first_call(moved, 'look', **place)[:2] == (name, True)
    with (moved / 'circle_bounce_ros/kernel/reflection.py').open('a') as source:
        source.write('# changed\n')
    other, ready, _ = first_call(moved, 'look', **place)
    assert not ready
    assert other != name
