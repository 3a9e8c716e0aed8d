"""A child process sees nothing of what the ROS packages from PyPI did to this one."""

import json
import os
import sys
from pathlib import Path

import pytest
from installs import run

from circle_bounce_ros.installation import child_environment

GUARD = '_ROS_WHEELS_BOOTSTRAP_COMPLETE'
LIB = str(Path(sys.prefix, 'lib'))
LIBS = f'{LIB}/python3.11/site-packages/ros_rcl.libs'


@pytest.mark.parametrize(
    ('before', 'after'),
    [
        (f'{LIB}:{LIBS}', None),
        (f'/opt/cuda/lib:{LIB}:{LIBS}', '/opt/cuda/lib'),
        (f'{LIBS}::/opt/b:{LIB}:/opt/a', '/opt/b:/opt/a'),
    ],
)
def test_only_the_folders_of_the_wheels_leave_the_library_path(monkeypatch, before, after):
    monkeypatch.setenv(GUARD, '1')
    monkeypatch.setenv('LD_LIBRARY_PATH', before)
    environment = child_environment()
    assert environment.get('LD_LIBRARY_PATH') == after
    assert GUARD not in environment


def test_without_wheels_the_library_path_is_the_users_own(monkeypatch):
    monkeypatch.delenv(GUARD, raising=False)
    monkeypatch.setenv('LD_LIBRARY_PATH', f'/opt/ros/jazzy/lib:{LIB}')
    assert child_environment() == dict(os.environ)


def test_changes_are_for_the_child_only(monkeypatch):
    monkeypatch.setenv('ROS_DOMAIN_ID', '3')
    assert child_environment(ROS_DOMAIN_ID='7')['ROS_DOMAIN_ID'] == '7'
    assert os.environ['ROS_DOMAIN_ID'] == '3'


def test_a_child_with_the_same_packages_finds_them_by_itself():
    run(sys.executable, '-c', 'import rclpy; rclpy.init(); rclpy.shutdown()')


def test_a_child_with_a_bare_python_loads_no_library_of_the_wheels():
    code = 'import json, os; print(json.dumps(os.environ.get("LD_LIBRARY_PATH", "")))'
    # -S: without the packages that would set it up again.
    assert 'ros_' not in json.loads(run(sys.executable, '-S', '-c', code))
