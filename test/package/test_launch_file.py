"""The launch file starts the node as its arguments say. Needs ROS 2: `launch` is not on PyPI."""

import os
import signal
import subprocess

import pytest
from installs import PATIENCE, first_message

from circle_bounce_ros.installation import child_environment

pytest.importorskip(
    'launch_ros', reason='launch and launch_ros come with ROS 2 only, not from PyPI'
)


def test_ros2_launch_starts_the_node_in_a_namespace(colcon_install, listener, tmp_path):
    heard = listener('pose', '/here/green/pose')
    command = 'ros2 launch circle_bounce_ros bounce.launch.py namespace:=here scene:=lesson'
    launched = subprocess.Popen(
        ['sh', '-c', f'. {colcon_install}/setup.sh && exec {command}'],
        cwd=tmp_path,
        env=child_environment(),
        start_new_session=True,
    )
    try:
        assert len(first_message(heard)) == 2
    finally:
        os.killpg(launched.pid, signal.SIGINT)
        launched.wait(PATIENCE)
