"""`tools/set_up.py` sets up once, starts again after a cut, and says in one sentence what is missing."""

import json
import shutil
import subprocess
import sys

import pytest
from installs import ROOT

GOOD = {
    'version': [3, 12],
    'implementation': 'cpython',
    'system': 'Linux',
    'machine': 'x86_64',
    'venv': True,
    'rclpy': False,
}
# Answers the script's question, makes an environment of nothing but itself, and writes down each pip.
FAKE_PYTHON = """#!/bin/sh
if [ "$1" = -S ]; then echo '{answer}'; exit; fi
if [ "$2" = venv ]; then
    echo "$@" >> '{calls}'
    for folder; do :; done
    /bin/mkdir -p "$folder/bin"
    /bin/ln -s "$0" "$folder/bin/python"
    exit
fi
echo "$@" >> '{calls}'
test ! -e '{broken}'
"""


class Machine:
    """A source tree, and a PATH with nothing but made-up Pythons."""

    def __init__(self, folder):
        self.tree = folder / 'tree'
        self.path = folder / 'bin'
        self.calls_file = folder / 'calls'
        self.broken = folder / 'broken'
        self.path.mkdir()
        for name in ('setup.py', 'setup.cfg', 'tools/set_up.py'):
            (self.tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, self.tree / name)

    def python(self, name, **differences):
        program = self.path / name
        answer = json.dumps(GOOD | {'executable': str(program)} | differences)
        program.write_text(
            FAKE_PYTHON.format(answer=answer, calls=self.calls_file, broken=self.broken)
        )
        program.chmod(0o755)
        return str(program)

    def set_up(self, wanted='', environment='.venv', **variables):
        """Return the exit status and what was said."""
        program = self.tree / 'tools/set_up.py'
        done = subprocess.run(
            [sys.executable, '-S', str(program), '--python', wanted, environment],
            env={'PATH': str(self.path)} | variables,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        return done.returncode, done.stdout

    @property
    def calls(self):
        return self.calls_file.read_text().splitlines() if self.calls_file.exists() else []

    @property
    def set_ups(self):
        return sum(call.startswith('-m venv') for call in self.calls)


@pytest.fixture
def machine(tmp_path):
    return Machine(tmp_path)


@pytest.mark.parametrize(
    ('differences', 'sentence'),
    [
        (
            {'version': [3, 9]},
            'Python 3.10-3.13 is needed, {python} is cpython 3.9 (another one: make PYTHON=...)',
        ),
        (
            {'version': [3, 14]},
            'Python 3.10-3.13 is needed, {python} is cpython 3.14 (another one: make PYTHON=...)',
        ),
        (
            {'implementation': 'pypy'},
            'Python 3.10-3.13 is needed, {python} is pypy 3.12 (another one: make PYTHON=...)',
        ),
        (
            {'system': 'Darwin'},
            'the ROS packages on PyPI are for Linux on x86_64, this is Darwin on x86_64: '
            'install ROS 2 Jazzy and source it',
        ),
        (
            {'machine': 'aarch64'},
            'the ROS packages on PyPI are for Linux on x86_64, this is Linux on aarch64: '
            'install ROS 2 Jazzy and source it',
        ),
        (
            {'venv': False},
            '{python} cannot make virtual environments: sudo apt install python3.12-venv',
        ),
    ],
)
@pytest.mark.parametrize('chosen', ['by the user', 'by us'])
def test_what_cannot_work_is_said_in_one_sentence_before_pip_runs(
    machine, differences, sentence, chosen
):
    python = machine.python('python3', **differences)
    status, said = machine.set_up(python if chosen == 'by the user' else '')
    assert (status, said) == (1, f'circle_bounce_ros: {sentence.format(python=python)}\n')
    assert machine.calls == []


def test_no_python_at_all(machine):
    sentence = 'circle_bounce_ros: Python 3.10-3.13 is needed, found none\n'
    assert machine.set_up() == (1, sentence)


def test_a_wanted_python_that_does_not_run(machine):
    sentence = 'circle_bounce_ros: /no/such/python is no Python that runs\n'
    assert machine.set_up('/no/such/python') == (1, sentence)


def test_another_python_on_the_path_serves_when_python3_does_not(machine):
    machine.python('python3', version=[3, 14])
    machine.python('python3.10', version=[3, 10])
    status, said = machine.set_up()
    assert (status, said) == (0, 'Setting up .venv with Python 3.10, once ...\n')


def test_pypi_brings_ros_where_none_is_sourced(machine):
    machine.python('python3')
    machine.set_up()
    venv, pip, _ = machine.calls
    assert '--system-site-packages' not in venv
    assert pip.endswith('--editable .[ros,fast,test,check,docs,offline,viewer,browser]')


def test_a_sourced_ros_is_used_as_it_is(machine):
    machine.python('python3', rclpy=True, machine='aarch64')
    assert machine.set_up(ROS_DISTRO='jazzy')[0] == 0
    venv, pip, _ = machine.calls
    assert '--system-site-packages' in venv
    assert pip.endswith('--editable .[fast,test,check,docs,offline,viewer,browser]')


def test_the_engine_is_compiled_ahead(machine):
    machine.python('python3')
    machine.set_up()
    assert 'compile_ahead()' in machine.calls[-1]


def test_the_kernels_environment_has_numpy_and_pytest_and_nothing_of_the_system(machine):
    machine.python('python3', rclpy=True)
    machine.set_up(environment='.venvs/kernel', ROS_DISTRO='jazzy')
    venv, pip = machine.calls
    assert '--system-site-packages' not in venv
    assert pip.endswith('--use-pep517 numpy pytest')


def test_another_ros_is_refused(machine):
    machine.python('python3')
    sentence = (
        'circle_bounce_ros: ROS 2 humble is sourced here, '
        'but jazzy or a terminal without ROS is needed\n'
    )
    assert machine.set_up(ROS_DISTRO='humble') == (1, sentence)
    assert machine.calls == []


def test_a_python_that_does_not_belong_to_the_sourced_ros_is_refused(machine):
    python = machine.python('mine')
    sentence = (
        f'circle_bounce_ros: ROS 2 is sourced, but {python} cannot import rclpy '
        '(another one: make PYTHON=...)\n'
    )
    assert machine.set_up(python, ROS_DISTRO='jazzy') == (1, sentence)
    assert machine.calls == []


def test_the_second_time_nothing_is_done(machine):
    python = machine.python('python3')
    machine.set_up()
    before = machine.calls
    assert machine.set_up() == (0, '')
    assert machine.set_up(python) == (0, '')
    assert machine.calls == before


@pytest.mark.parametrize('name', ['setup.py', 'setup.cfg', 'tools/set_up.py'])
def test_a_change_of_what_is_to_be_installed_sets_up_again(machine, name):
    machine.python('python3')
    machine.set_up()
    with (machine.tree / name).open('a') as file:
        file.write('\n')
    machine.set_up()
    assert machine.set_ups == 2
    assert machine.set_up() == (0, '')


def test_sourcing_ros_sets_up_again(machine):
    machine.python('python3', rclpy=True)
    machine.set_up()
    machine.set_up(ROS_DISTRO='jazzy')
    assert machine.set_ups == 2


def test_a_moved_tree_sets_up_again(machine):
    machine.python('python3')
    machine.set_up()
    machine.tree = machine.tree.rename(machine.tree.with_name('moved'))
    machine.set_up()
    assert machine.set_ups == 2


def test_another_wanted_python_sets_up_again(machine):
    machine.python('python3')
    other = machine.python('python3.11', version=[3, 11])
    machine.set_up()
    assert machine.set_up(other) == (0, 'Setting up .venv with Python 3.11, once ...\n')
    assert machine.set_up() == (0, '')


def test_a_python_that_is_gone_sets_up_again(machine):
    machine.python('python3')
    machine.set_up()
    (machine.path / 'python3').unlink()
    machine.python('python3.12')
    assert machine.set_up() == (0, 'Setting up .venv with Python 3.12, once ...\n')


def test_a_set_up_that_was_cut_short_is_done_again_from_nothing(machine):
    machine.python('python3')
    machine.broken.touch()
    status, said = machine.set_up()
    assert status == 1
    assert 'set-up failed, the next make starts it again' in said
    assert 'Traceback' not in said
    leftover = machine.tree / '.venv/half-installed'
    leftover.touch()
    machine.broken.unlink()
    assert machine.set_up()[0] == 0
    assert not leftover.exists()
    assert machine.set_up() == (0, '')


def test_an_environment_that_somebody_else_made_is_left_alone(machine):
    machine.python('python3')
    theirs = machine.tree / '.venv/pyvenv.cfg'
    theirs.parent.mkdir()
    theirs.touch()
    sentence = (
        f'circle_bounce_ros: {theirs.parent} was not made by this script: '
        'remove it or move it away\n'
    )
    assert machine.set_up() == (1, sentence)
    assert theirs.exists()
