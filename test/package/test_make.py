"""The two commands, as a stranger types them."""

import os
import re
import signal
import subprocess
import time

import pytest
from installs import PATIENCE, ROOT, first_message

from circle_bounce_ros.installation import child_environment

# What the make that runs these tests tells the makes that it starts itself.
INHERITED = ('MAKEFLAGS', 'MFLAGS', 'MAKELEVEL', 'MAKEOVERRIDES')


@pytest.fixture
def environment():
    return {name: value for name, value in child_environment().items() if name not in INHERITED}


@pytest.mark.skipif(
    not (ROOT / '.venv/circle_bounce_ros.json').exists(),
    reason='no .venv here that `make set-up` has made',
)
def test_make_run_publishes_within_3_seconds_and_ctrl_c_ends_it_cleanly(
    environment, domain, listener, tmp_path
):
    poses, times = listener('pose', '/green/pose'), listener('time', '/time')
    log = tmp_path / 'log'
    started = time.time()
    with log.open('w') as output:
        make = subprocess.Popen(
            ['make', 'run'],
            cwd=ROOT,
            env=environment | {'ROS_DOMAIN_ID': str(domain)},
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
    try:
        assert len(first_message(poses)) == 2
        # When the node began: listeners may find it later, because the middleware asks again after 3 s only.
        stamp, scene_time = first_message(times)
        assert stamp - scene_time - started < 3.0
    finally:
        # Ctrl-C goes to every process in the terminal.
        os.killpg(make.pid, signal.SIGINT)
        status = make.wait(PATIENCE)
    said = log.read_text()
    # make itself dies by the signal, unless whoever started it lets it ignore that.
    assert status in (0, -signal.SIGINT), said
    assert '/green/pose' in said
    assert 'make listen' in said
    assert 'http://127.0.0.1:' in said
    # make reports a child that ends with any status but 0.
    assert 'make:' not in said
    assert 'Traceback' not in said


def make_says(environment, *words):
    return subprocess.check_output(['make', *words], cwd=ROOT, env=environment, text=True)


@pytest.mark.parametrize(
    ('words', 'command'),
    [
        ([], '--ros-args'),
        (['SCENE=gas'], "--ros-args -p 'scene:=gas'"),
        (
            ['SCENE=my/own.yaml', 'ARGS=-p seed:=3'],
            "--ros-args -p 'scene:=my/own.yaml' -p seed:=3",
        ),
        (['PORT=9000'], "--ros-args -p 'bounce_viewer:port:=9000'"),
    ],
)
def test_make_run_passes_on_the_scene_and_the_arguments(environment, words, command):
    said = make_says(environment, '--dry-run', 'run', *words)
    last = said.splitlines()[-1]
    assert last.split() == ['exec', '.venv/bin/python', '-S', 'tools/run.py', *command.split()]


def test_make_help_names_every_command_for_users(environment):
    said = make_says(environment, 'help')
    phony = re.findall(r'^\.PHONY: (.*)', (ROOT / 'Makefile').read_text(), re.MULTILINE)
    commands = {name for names in phony for name in names.split() if name[0].isalpha()}
    internal = {'help'} | {name for name in commands if name.startswith('test-')}
    assert commands - internal <= set(re.findall(r'[a-z-]+', said))
    assert set(re.findall(r'^make ([a-z-]+)', said, re.MULTILINE)) <= commands
