"""Copies of the tree, installed as users install it, and a listener in a process of its own."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from installs import PACKAGE, ROOT, run

from circle_bounce_ros.installation import child_environment

LISTENER = Path(__file__).with_name('first_message.py')
BUILDER = ROOT / '.venvs/colcon'
LEFTOVERS = ['.*', '__pycache__', '*.egg-info', 'build', 'install', 'log', 'out']


@pytest.fixture(scope='session')
def source_tree(tmp_path_factory):
    """Return a copy of the sources: builds and editable installs write beside them."""
    tree = tmp_path_factory.mktemp('sources') / PACKAGE
    shutil.copytree(ROOT, tree, ignore=shutil.ignore_patterns(*LEFTOVERS))
    return tree


@pytest.fixture(scope='session')
def builder():
    """Return the bin folder of the environment with colcon and a setuptools that it can use."""
    if not (BUILDER / 'bin/colcon').exists():
        pytest.skip('no .venvs/colcon here: `make set-up` makes it')
    return BUILDER / 'bin'


@pytest.fixture(scope='session', params=['copied', 'symlinked'])
def colcon_install(request, builder, source_tree, tmp_path_factory):
    """Return the prefix of a colcon workspace, built both ways."""
    workspace = tmp_path_factory.mktemp(request.param)
    how = ['--symlink-install'] if request.param == 'symlinked' else []
    run(
        builder / 'colcon',
        *['--log-base', workspace / 'log', 'build', '--base-paths', source_tree, *how],
        *['--build-base', workspace / 'build', '--install-base', workspace / 'install'],
        cwd=workspace,
    )
    return workspace / 'install'


@pytest.fixture
def listener(domain):
    """Return a function that starts listening to a topic, of poses or of times, in another process."""
    processes = []

    def listen(kind, topic):
        process = subprocess.Popen(
            [sys.executable, str(LISTENER), kind, topic],
            env=child_environment(),
            stdout=subprocess.PIPE,
            text=True,
        )
        processes.append(process)
        assert process.stdout.readline() == 'listening\n'
        return process

    yield listen
    for process in processes:
        process.kill()
        process.communicate()
