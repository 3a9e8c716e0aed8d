"""A node with no usable compiled code on disk starts plain, and the compiled engine takes over at a reset."""

from __future__ import annotations

import pytest
from geometry_msgs.msg import PoseArray
from observing import nanoseconds, scene_times
from sensor_msgs.msg import TimeReference

from circle_bounce_ros.kernel import Simulation, compiled_code_is_ready
from circle_bounce_ros.kernel.engine import code_cache
from circle_bounce_ros.scene_file import load_scene


@pytest.fixture
def damaged_code_on_disk(tmp_path, monkeypatch):
    pytest.importorskip('numba', reason='numba is not installed: there is nothing to compile')
    monkeypatch.setenv('XDG_CACHE_HOME', str(tmp_path / 'cache'))
    assert code_cache.write(b'was once code') == ''
    code_cache.find()[0].write_bytes(b'cut')
    assert not compiled_code_is_ready()


def test_nothing_waits_for_the_compiler(damaged_code_on_disk, start, observer):
    poses = observer.listen(PoseArray, 'poses')
    times = observer.listen(TimeReference, 'time')
    node = start(scene='mixed')
    observer.collect(poses, 5)
    assert 'compiling the engine in the background' in node.log
    # The first messages are there before the compiler is done, which takes seconds of CPU.
    assert not compiled_code_is_ready()
    observer.spin_until(compiled_code_is_ready, 'compiled code on disk', within=120.0)
    # It is kept before the warning is written.
    observer.spin_until(lambda: node.log.count('was damaged') == 1, 'one warning')
    assert observer.reset().success
    simulation = Simulation(load_scene('mixed'), compiled=False)

    def since_reset():
        """Return the messages whose scene time is known, from where that went back on."""
        scene_ns = scene_times(times)
        stamped = [(nanoseconds(m.header.stamp), m) for m in poses]
        shown = [(scene_ns[stamp], m) for stamp, m in stamped if stamp in scene_ns]
        begin = [k for k in range(1, len(shown)) if shown[k][0] < shown[k - 1][0]]
        return shown[begin[-1] :] if begin else []

    observer.spin_until(lambda: len(since_reset()) >= 20, 'messages since the reset')
    # Exactly what the plain engine says.
    for at, message in since_reset():
        simulation.advance_to(at * 1e-9)
        there = [(pose.position.x, pose.position.y) for pose in message.poses]
        assert there == [tuple(row) for row in simulation.positions.tolist()]
