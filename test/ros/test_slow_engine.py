"""A scene that is too heavy skips frames and scene time; services answer and states stay exact."""

from __future__ import annotations

import time
from itertools import pairwise
from pathlib import Path

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseArray
from observing import SECOND, nanoseconds, scene_times, stamps
from sensor_msgs.msg import TimeReference

from circle_bounce_ros.kernel import Simulation
from circle_bounce_ros.scene_file import load_scene

SLOW_NODE = (str(Path(__file__).with_name('slow_node.py')),)


@pytest.fixture
def heavy(write_scene):
    """Return a scene with far more contacts than the slow engine can do."""
    balls = [
        {'position': [0.3 * x, 0.3 * y], 'velocity': [3.0 + x, 2.0 - y], 'radius': 0.1}
        for x in range(5)
        for y in range(5)
    ]
    return write_scene('heavy', circles=balls, walls=[{'box': {'min': [-1, -1], 'max': [2, 2]}}])


@pytest.mark.parametrize('publish_clock', ['false', 'true'])
def test_services_answer_within_a_second_and_diagnostics_warn(
    start, observer, heavy, monkeypatch, publish_clock
):
    monkeypatch.setenv('SECONDS_PER_SLICE', '0.03')
    diagnostics = observer.listen(DiagnosticArray, '/diagnostics')
    times = observer.listen(TimeReference, 'time')
    poses = observer.listen(PoseArray, 'poses')
    start(program=SLOW_NODE, scene=heavy, publish_clock=publish_clock)
    observer.spin_until(
        lambda: diagnostics and diagnostics[-1].status[0].level == DiagnosticStatus.WARN,
        'a warning',
    )
    values = {value.key: value.value for value in diagnostics[-1].status[0].values}
    if publish_clock == 'true':  # simulated time is slow then, and whole
        assert float(values['dropped scene time (s)']) == 0.0
    else:
        assert float(values['dropped scene time (s)']) > 0.0
    answers = [
        observer.reset,
        observer.pause,
        lambda: observer.pause(False),
        lambda: observer.set(time_scale=0.9),
    ]
    for ask in answers:
        began = time.monotonic()
        ask()
        assert time.monotonic() - began < 1.0
    observer.spin_until(
        lambda: (
            float({v.key: v.value for v in diagnostics[-1].status[0].values}['real-time factor'])
            < 0.8
        ),
        'a low real-time factor',
    )
    observer.collect(times, 5)
    # Slow is not wrong: what is shown is the state of the instant that `time` says.
    instants = scene_times(times)
    simulation = Simulation(load_scene(heavy))
    checked = 0
    for message in poses:
        scene_ns = instants.get(nanoseconds(message.header.stamp))
        if scene_ns is None:
            continue
        if scene_ns * 1e-9 < simulation.time:
            simulation.reset()
        simulation.advance_to(scene_ns * 1e-9)
        said = [(pose.position.x, pose.position.y) for pose in message.poses]
        assert said == [tuple(position) for position in simulation.positions]
        checked += 1
    assert checked >= 3
    if publish_clock == 'true':
        periods = {b - a for a, b in pairwise(stamps(times))}
        assert periods <= {SECOND // 60, SECOND // 60 + 1}


def test_a_step_of_a_heavy_scene_is_complete(start, observer, heavy, monkeypatch):
    monkeypatch.setenv('SECONDS_PER_SLICE', '0.03')
    times = observer.listen(TimeReference, 'time')
    start(program=SLOW_NODE, scene=heavy, start_paused='true', rate=10.0)
    observer.collect(times, 2)
    observer.step()
    observer.step()
    last = observer.spin_until(
        lambda: [t for t in times if nanoseconds(t.time_ref) == 2 * SECOND // 10], 'both steps'
    )
    assert nanoseconds(last[0].time_ref) == 200_000_000
