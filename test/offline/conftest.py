"""What the tests of recordings, pictures and sweeps share. No ROS is needed, but for the comparison with the node."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PATIENCE = 60.0  # s; only a fault takes that long


class Commands:
    """The commands, each in a process of its own."""

    def __init__(self):
        self._started = []

    def start(self, command, *arguments, **options):
        module = f'circle_bounce_ros.offline.{command.removeprefix("bounce_")}'
        process = subprocess.Popen(
            [sys.executable, '-W', 'error', '-m', module, *map(str, arguments)],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            **options,
        )
        self._started.append(process)
        return process

    def run(self, command, *arguments, status=0, **options):
        """Return what it wrote, to stdout if it is to succeed and to stderr otherwise."""
        process = self.start(command, *arguments, **options)
        out, error = process.communicate(timeout=2 * PATIENCE)
        assert process.returncode == status, error
        assert 'Traceback' not in error
        return error if status else out

    def end(self):
        """End what a test that failed has left: a recording would go on until the disk is full."""
        for process in self._started:
            process.kill()
            process.communicate(timeout=PATIENCE)


@pytest.fixture
def bounce():
    commands = Commands()
    try:
        yield commands
    finally:
        commands.end()


@pytest.fixture
def write_scene(tmp_path):
    """Return a function that writes a scene file and returns its path."""

    def write_scene(name='own', **content):
        path = tmp_path / f'{name}.yaml'
        path.write_text(json.dumps(content))  # which is YAML as well
        return path

    return write_scene


def wait_until(condition, what):
    """Wait until a condition holds."""
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, f'not within {PATIENCE} s: {what}'
        time.sleep(0.01)


def files_of(folder):
    """Return the content of all files below a folder, by name."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob('*'))
        if path.is_file()
    }


# A sweep of 3 x 2 short runs of a small gas.
SMALL = {
    'scene': './box.yaml',
    'parameters': {'groups[0].packing': {'from': 0.1, 'to': 0.3, 'steps': 3}},
    'seeds': {'first': 5, 'count': 2},
    'duration': 4.0,
    'warm_up': 1.0,
    'rate': 20.0,
}
BOX = {
    'groups': [
        {
            'count': 60,
            'packing': 0.2,
            'speed': {'maxwell': 1.0},
            'region': {'min': [0, 0], 'max': [2, 2]},
        }
    ],
    'walls': [{'box': {'min': [0, 0], 'max': [2, 2]}}],
}


@pytest.fixture
def write_sweep(tmp_path, write_scene):
    """Return a function that writes a sweep with changes and returns its path."""
    write_scene('box', **BOX)

    def write_sweep(name='sweep', **changes):
        path = tmp_path / f'{name}.yaml'
        path.write_text(json.dumps(SMALL | changes))
        return path

    return write_sweep


def perform_here(sweep, folder):
    """Carry out a sweep in this process, without Dask, and return its rows."""
    from circle_bounce_ros.offline.run import perform
    from circle_bounce_ros.offline.sweep_file import load_plan

    plan = load_plan(sweep)
    folder.mkdir()
    (folder / 'plan.json').write_text(plan.dump())
    return [perform(str(folder), plan.digest(), number) for number in range(len(plan))]


def rows_of(folder):
    return [json.loads(line) for line in (folder / 'rows.jsonl').read_text().splitlines()]
