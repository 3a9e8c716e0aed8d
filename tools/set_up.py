"""
Make the project's virtual environments, each once: `set_up.py [--python PYTHON] ENVIRONMENT...`.

Standard library only, and syntax of Python 3.6: whatever `python3` is must be able to say which Python is needed.
"""

import argparse
import fcntl
import hashlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
STAMP = 'circle_bounce_ros.json'
OLDEST, NEWEST = (3, 10), (3, 13)
# What the set-up follows from: a change of any of these makes it due again.
INPUTS = ['setup.py', 'setup.cfg', 'tools/set_up.py']

PROBE = """
import importlib.util, json, os, platform, sys
find = importlib.util.find_spec
print(json.dumps({
    'executable': os.path.realpath(getattr(sys, '_base_executable', sys.executable)),
    'version': list(sys.version_info[:2]),
    'implementation': sys.implementation.name,
    'system': platform.system(),
    'machine': platform.machine(),
    'venv': bool(find('venv') and find('ensurepip')),
    'rclpy': bool(find('rclpy')),
}))
"""


def packages(environment, ros_sourced):
    """Return what pip has to install into an environment."""
    if environment == '.venv':
        extras = 'fast,test,check,docs,offline,viewer,browser'
        return ['--editable', '.[{}]'.format(extras if ros_sourced else 'ros,' + extras)]
    if environment == '.venvs/offline':
        return ['--editable', '.[fast,offline,test-offline]']
    if environment == '.venvs/kernel':
        return ['numpy', 'pytest']
    if environment == '.venvs/bench':
        return ['--editable', '.[fast,bench]']
    if environment == '.venvs/colcon':
        # From 80 on setuptools has no `develop --editable`, which colcon build --symlink-install calls.
        # From 70.1 on it makes wheels without the package wheel.
        return ['colcon-core', 'colcon-ros', 'setuptools>=70.1,<80']
    raise Refusal('{}: no such environment'.format(environment))


class Refusal(Exception):
    """The reason, in one sentence, why there can be no environment."""


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        '--python', default='', help='the Python to use; default: the first that fits'
    )
    parser.add_argument('environments', nargs='+', metavar='ENVIRONMENT')
    arguments = parser.parse_args()
    try:
        for environment in arguments.environments:
            set_up(environment, arguments.python)
    except Refusal as reason:
        sys.exit('circle_bounce_ros: {}'.format(reason))
    except KeyboardInterrupt:
        sys.exit('circle_bounce_ros: set-up interrupted, the next make starts it again')


def set_up(environment, wanted_python):
    """Make an environment unless it is there, finished and up to date."""
    (ROOT / '.venvs').mkdir(exist_ok=True)
    with open(str(ROOT / '.venvs/lock'), 'w') as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            print('Another set-up is at work here, waiting for it ...', flush=True)
            fcntl.flock(lock, fcntl.LOCK_EX)
        ros_sourced = check_ros()
        key = key_of_inputs(environment, ros_sourced)
        python = choose_python(wanted_python, ros_sourced) if wanted_python else None
        if is_finished(ROOT / environment, key, python):
            return
        make(environment, key, python or choose_python('', ros_sourced), ros_sourced)


def check_ros():
    """Return whether ROS 2 is sourced in this terminal."""
    distribution = os.environ.get('ROS_DISTRO', '')
    if distribution not in ('', 'jazzy'):
        raise Refusal(
            'ROS 2 {} is sourced here, but jazzy or a terminal without ROS is needed'.format(
                distribution
            )
        )
    return distribution == 'jazzy'


def key_of_inputs(environment, ros_sourced):
    digest = hashlib.sha256()
    for name in INPUTS:
        digest.update((ROOT / name).read_bytes())
    # An environment knows its own path and that of the source tree.
    return '{} {} {} {}'.format(
        ROOT, environment, 'ros' if ros_sourced else 'pypi', digest.hexdigest()
    )


def is_finished(folder, key, python):
    try:
        stamp = json.loads((folder / STAMP).read_text())
    except (OSError, ValueError):
        return False
    base = os.path.realpath(str(folder / 'bin/python'))
    # A Python that was exchanged under the environment's link takes its packages away.
    unchanged = os.path.exists(base) and stamp.get('base') == base
    wanted = python is None or stamp.get('python') == python['executable']
    return stamp.get('key') == key and unchanged and wanted


def choose_python(wanted, ros_sourced):
    """Return what PROBE says about the wanted Python or about the first one that fits."""
    if wanted:
        found = probe(wanted)
        if found is None:
            raise Refusal('{} is no Python that runs'.format(wanted))
        problem = problem_with(found, ros_sourced)
        if problem:
            raise Refusal(problem)
        return found
    names = ['python3', '/usr/bin/python3'] if ros_sourced else ['python3']
    names += ['python3.{}'.format(minor) for minor in range(NEWEST[1], OLDEST[1] - 1, -1)]
    first_problem = None
    for name in names:
        found = probe(name)
        problem = found and problem_with(found, ros_sourced)
        if found and not problem:
            return found
        first_problem = first_problem or problem
    raise Refusal(first_problem or 'Python {} is needed, found none'.format(versions()))


def probe(name):
    """Return what PROBE says when this Python runs it, None when it does not run."""
    try:
        # -S: an environment with the ROS wheels would start itself a second time.
        command = [name, '-S', '-c', PROBE]
        output = subprocess.check_output(command, stderr=subprocess.DEVNULL)
        return json.loads(output.decode())
    except (OSError, ValueError, subprocess.CalledProcessError):
        return None


def problem_with(found, ros_sourced):
    """Return why a Python does not fit, None when it does."""
    version = '{}.{}'.format(*found['version'])
    if found['implementation'] != 'cpython' or not OLDEST <= tuple(found['version']) <= NEWEST:
        return 'Python {} is needed, {} is {} {} (another one: make PYTHON=...)'.format(
            versions(), found['executable'], found['implementation'], version
        )
    if ros_sourced and not found['rclpy']:
        return (
            'ROS 2 is sourced, but {} cannot import rclpy (another one: make PYTHON=...)'.format(
                found['executable']
            )
        )
    if not ros_sourced and (found['system'], found['machine']) != ('Linux', 'x86_64'):
        return (
            'the ROS packages on PyPI are for Linux on x86_64, this is {} on {}: '
            'install ROS 2 Jazzy and source it'.format(found['system'], found['machine'])
        )
    if not found['venv']:
        return '{} cannot make virtual environments: sudo apt install python{}-venv'.format(
            found['executable'], version
        )
    return None


def versions():
    return '{}.{}-{}.{}'.format(*(OLDEST + NEWEST))


def make(environment, key, python, ros_sourced):
    """Make an environment from nothing; its stamp is written last."""
    folder = ROOT / environment
    stamp = folder / STAMP
    if folder.exists() and not stamp.exists():
        raise Refusal('{} was not made by this script: remove it or move it away'.format(folder))
    print(
        'Setting up {} with Python {}.{}, once ...'.format(environment, *python['version']),
        flush=True,
    )
    # Renamed into place and out of it: whenever this is cut short, a folder without a stamp is not ours.
    removed, begun = ROOT / '.venvs/removed', ROOT / '.venvs/begun'
    shutil.rmtree(str(removed), ignore_errors=True)
    shutil.rmtree(str(begun), ignore_errors=True)
    begun.mkdir()
    (begun / STAMP).write_text('{}')
    if folder.exists():
        folder.rename(removed)
    begun.rename(folder)
    shutil.rmtree(str(removed), ignore_errors=True)
    # A sourced ROS builds on the system's packages. What is to work without ROS must have none of them.
    bare = environment in ('.venvs/kernel', '.venvs/offline')
    sites = ['--system-site-packages'] if ros_sourced and not bare else []
    run([python['executable'], '-m', 'venv'] + sites + [str(folder)])
    pip = [str(folder / 'bin/python'), '-m', 'pip', '--disable-pip-version-check']
    run(pip + ['install', '--quiet', '--use-pep517'] + packages(environment, ros_sourced))
    if environment in ('.venv', '.venvs/offline'):
        compile_ahead = 'from circle_bounce_ros.kernel import compile_ahead; compile_ahead()'
        run([str(folder / 'bin/python'), '-c', compile_ahead])
    base = os.path.realpath(str(folder / 'bin/python'))
    finished = stamp.with_suffix('.new')
    finished.write_text(json.dumps({'key': key, 'base': base, 'python': python['executable']}))
    finished.replace(stamp)


def run(command):
    try:
        subprocess.check_call(command, cwd=str(ROOT))
    except (OSError, subprocess.CalledProcessError) as error:
        raise Refusal('set-up failed, the next make starts it again: {}'.format(error)) from error


if __name__ == '__main__':
    main()
