"""Above 200 Hz ticks come from a thread: as many as asked for, exact, and the services stay consistent."""

from __future__ import annotations

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from observing import nanoseconds
from sensor_msgs.msg import TimeReference

from circle_bounce_ros.kernel import Simulation
from circle_bounce_ros.scene_file import load_scene

RATE = 1000.0


@pytest.fixture
def ball(write_scene):
    circles = [{'name': 'ball', 'position': [0.0, 0.1], 'velocity': [1.3, 0.7], 'radius': 0.1}]
    return write_scene('ball', circles=circles, walls=[{'box': {'min': [-1, -1], 'max': [1, 1]}}])


def check(poses, times, scene):
    """Check each pose against the kernel at the scene time that goes with its stamp."""
    scene_time = {nanoseconds(t.header.stamp): nanoseconds(t.time_ref) for t in times}
    checked = 0
    before = np.inf
    for pose in poses:
        when = scene_time.get(nanoseconds(pose.header.stamp))
        if when is None:
            continue
        if when * 1e-9 < before:
            simulation = Simulation(scene)
        before = when * 1e-9
        simulation.advance_to(before)
        position = pose.pose.position
        assert [position.x, position.y] == simulation.positions[0].tolist()
        checked += 1
    return checked


def test_a_thousand_ticks_a_second_are_exact_through_services_and_changes_of_rate(
    start, observer, ball
):
    poses = observer.listen(PoseStamped, 'ball/pose', depth=10_000)
    times = observer.listen(TimeReference, 'time', depth=10_000)
    start(scene=ball, rate=RATE)
    observer.spin_until(lambda: len(poses) > 300, 'ticks')
    observer.reset()
    observer.pause()
    observer.step()
    observer.pause(False)
    observer.set(rate=20.0)
    count = len(poses)
    observer.spin_until(lambda: len(poses) > count + 5, 'slow ticks')
    observer.set(rate=RATE)
    count = len(poses)
    observer.spin_until(lambda: len(poses) > count + 300, 'fast ticks')
    stamps = [nanoseconds(pose.header.stamp) for pose in poses]
    assert stamps == sorted(set(stamps))
    assert check(poses, times, load_scene(ball)) > 300
