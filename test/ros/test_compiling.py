"""A node with no compiled code on disk starts plain, and the compiled engine takes over at a reset."""

from __future__ import annotations

import pytest
from geometry_msgs.msg import PoseArray
from observing import nanoseconds, scene_times
from sensor_msgs.msg import TimeReference

from circle_bounce_ros.kernel import Simulation, compiled_code_is_ready
from circle_bounce_ros.scene_file import load_scene


@pytest.fixture
def no_code_on_disk(tmp_path, monkeypatch):
    pytest.importorskip('numba', reason='numba is not installed: there is nothing to compile')
    monkeypatch.setenv('XDG_CACHE_HOME', str(tmp_path / 'cache'))
    assert not compiled_code_is_ready()


def test_nothing_waits_for_the_compiler(no_code_on_disk, start, observer):
    poses = observer.listen(PoseArray, 'poses')
    times = observer.listen(TimeReference, 'time')
    node = start(scene='mixed')
    observer.collect(poses, 5)
    assert 'compiling the engine in the background' in node.log
    # The first messages are there before the compiler is done, which takes seconds of CPU.
    assert not compiled_code_is_ready()
    observer.spin_until(compiled_code_is_ready, 'compiled code on disk', within=120.0)
    poses.clear()
    times.clear()
    assert observer.reset().success
    simulation = Simulation(load_scene('mixed'), compiled=False)
    observer.collect(poses, 20)
    observer.collect(times, 20)
    scene_ns = scene_times(times)
    shown = [(scene_ns.get(nanoseconds(m.header.stamp)), m) for m in poses]
    # From the first instant on again, and exactly what the plain engine says.
    begin = next(k for k, (at, _) in enumerate(shown) if at == 0)
    for at, message in shown[begin + 1 :]:
        if at is not None:
            simulation.advance_to(at * 1e-9)
            there = [(pose.position.x, pose.position.y) for pose in message.poses]
            assert there == [tuple(row) for row in simulation.positions.tolist()]
