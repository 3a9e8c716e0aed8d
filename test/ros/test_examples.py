"""The examples stand in for the ros2 command line where there is none."""

from __future__ import annotations

import subprocess
import sys

import pytest
from observing import PATIENCE, REPOSITORY, WARNINGS


@pytest.fixture
def example(domain):
    """Return a function that runs an example and returns its status, output and errors."""

    def example(name, *arguments):
        command = [sys.executable, *WARNINGS, f'examples/{name}', *arguments]
        done = subprocess.run(
            command, cwd=REPOSITORY, capture_output=True, text=True, timeout=PATIENCE, check=False
        )
        return done.returncode, done.stdout, done.stderr

    return example


def test_control_says_what_the_node_said(start, lesson, example):
    start(namespace='/here', scene=lesson)
    node = ('--node', '/here/bounce')
    status, output, _ = example('control.py', 'reset', *node)
    assert (status, output.startswith("scene 'small_lesson'")) == (0, True)
    status, _, errors = example('control.py', 'step', *node)
    assert (status, errors) == (1, 'not paused: only a paused scene goes step by step\n')
    assert example('control.py', 'set', 'rate', '100', *node) == (0, 'rate is 100.0\n', '')
    status, _, errors = example('control.py', 'set', 'rate', 'fast', *node)
    assert (status, errors) == (1, "rate: could not convert string to float: 'fast'\n")


def test_listen_prints_pose_and_twist(start, lesson, example):
    start(namespace='/here', scene=lesson)
    status, output, _ = example('listen.py', '--namespace', '/here', '--count', '3')
    assert status == 0
    lines = output.splitlines()
    assert sum(' x ' in line and line.endswith(' m') for line in lines) == 3
    assert any(' vx ' in line and line.endswith(' m/s') for line in lines)
