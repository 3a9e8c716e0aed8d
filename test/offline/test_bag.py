"""What is in a bag of bounce_record, by readers that are not ours."""

from __future__ import annotations

import numpy as np
import pytest
from reading import (
    SECOND,
    nanoseconds,
    points_of,
    raw_with_mcap,
    read_with_mcap,
    read_with_rosbags,
    record,
    stamp_of,
)
from rosbags.interfaces import QosDurability, QosReliability
from rosbags.rosbag2 import Reader

from circle_bounce_ros.kernel import Simulation
from circle_bounce_ros.scene_file import load_scene

READERS = [read_with_rosbags, read_with_mcap]


@pytest.fixture(scope='module')
def mixed(tmp_path_factory):
    """Return the folder of a bag of the scene `mixed`: 2 s at 50 Hz."""
    folder = tmp_path_factory.mktemp('bags') / 'mixed'
    record('mixed', '--duration', 2, '--rate', 50, '--seed', 3, '-o', folder)
    return folder


@pytest.mark.parametrize('read', READERS)
def test_foreign_readers_find_the_states_of_the_kernel(mixed, read):
    simulation = Simulation(load_scene('mixed', 3), record_contacts=True)
    messages = read(mixed)
    poses = [m for topic, _, m in messages if topic == '/poses']
    bodies = [m for topic, _, m in messages if topic == '/bodies']
    contacts = [m for topic, _, m in messages if topic == '/contacts']
    assert len(poses) == len(bodies) == len(contacts) == 100
    for k, (pose, body, contact) in enumerate(zip(poses, bodies, contacts, strict=True), start=1):
        assert stamp_of(pose) == stamp_of(body) == k * SECOND // 50
        simulation.advance_to(stamp_of(pose) * 1e-9)
        spots = [(p.position.x, p.position.y) for p in pose.poses]
        np.testing.assert_array_equal(spots, simulation.positions)  # to the last bit
        x, y = simulation.positions.T.astype('f4')
        vx, vy = simulation.velocities.T.astype('f4')
        expected = {'x': x, 'y': y, 'z': 0, 'vx': vx, 'vy': vy, 'id': simulation.ids}
        expected['radius'] = simulation.radii.astype('f4')
        expected['mass'] = simulation.masses.astype('f4')
        assert_points(body, expected)
        log = simulation.drain_contacts()
        exact = {name: log[name] for name in ('time', 'a', 'b', 'kind')}
        rounded = {name: log[name].astype('f4') for name in log.dtype.names if name not in exact}
        assert_points(contact, exact | rounded | {'z': 0, 'nz': 0})
    # In a scene that never restarts scene time and stamps go together.
    clock = [m.clock for topic, _, m in messages if topic == '/clock']
    scene = [m.time_ref for topic, _, m in messages if topic == '/time']
    for times in (clock, scene):
        assert list(map(nanoseconds, times)) == [k * SECOND // 50 for k in range(1, 101)]
    (static,) = [m for topic, _, m in messages if topic == '/markers/static']
    (walls,) = [m for m in static.markers if len(m.points) == 2 * len(simulation.scene.walls)]
    ends = [(p.x, p.y) for p in walls.points]
    assert ends == [end for wall in simulation.scene.walls for end in (wall.start, wall.end)]


def assert_points(cloud, expected):
    """Check that a cloud has exactly these fields with these values."""
    points = points_of(cloud)
    assert set(points.dtype.names) == set(expected)
    for name, values in expected.items():
        np.testing.assert_array_equal(points[name], values, err_msg=name)


def test_both_readers_agree_on_every_message(mixed):
    ours = [(topic, time) for topic, time, _ in read_with_rosbags(mixed)]
    theirs = [(topic, time) for topic, time, _ in read_with_mcap(mixed)]
    assert sorted(ours) == sorted(theirs)
    assert {topic for topic, _ in ours} == {
        '/clock', '/time', '/poses', '/bodies', '/contacts', '/markers', '/markers/static'
    }  # fmt: skip


def test_named_circles_have_poses_and_twists_and_locked_ones_are_said_once(tmp_path):
    record('lesson', '--duration', 1, '-o', tmp_path / 'bag')
    simulation = Simulation(load_scene('lesson'))
    messages = read_with_rosbags(tmp_path / 'bag')
    poses = [m for topic, _, m in messages if topic == '/green/pose']
    twists = [m for topic, _, m in messages if topic == '/green/twist']
    assert len(poses) == len(twists) == 60
    for pose, twist in zip(poses, twists, strict=True):
        simulation.advance_to(stamp_of(pose) * 1e-9)
        position, linear = pose.pose.position, twist.twist.linear
        assert (position.x, position.y) == tuple(simulation.positions[0])
        assert (linear.x, linear.y) == tuple(simulation.velocities[0])
    (red,) = [m for topic, _, m in messages if topic == '/red/pose']
    assert (red.pose.position.x, red.pose.position.y) == (0.3, 0.15)


def test_latched_topics_are_latched_in_the_bag_too(tmp_path):
    record('lesson', '--duration', 1, '-o', tmp_path / 'bag')
    with Reader(tmp_path / 'bag') as reader:
        offered = {c.topic: c.ext.offered_qos_profiles[0] for c in reader.connections}
    latched = {t for t, q in offered.items() if q.durability == QosDurability.TRANSIENT_LOCAL}
    assert latched == {'/markers/static', '/red/pose'}
    assert {q.reliability for q in offered.values()} == {QosReliability.RELIABLE}
    assert {t: q.depth for t, q in offered.items()} == {
        t: 1 if t in latched else 10 for t in offered
    }


def test_scene_time_starts_again_where_the_scene_says_so_while_stamps_go_on(tmp_path, write_scene):
    path = write_scene(
        circles=[{'position': [0, 0], 'velocity': [1, 0], 'radius': 0.1, 'name': 'ball'}],
        restart_after=0.45,
    )
    record(path, '--duration', 2, '--rate', 10, '-o', tmp_path / 'bag')
    messages = read_with_rosbags(tmp_path / 'bag')
    times = [m.time_ref for topic, _, m in messages if topic == '/time']
    scene = [t.sec * SECOND + t.nanosec for t in times]
    # 0.5 s would be beyond the end, which is shown; then it starts again.
    period = [100_000_000 * k for k in (1, 2, 3, 4)] + [450_000_000, 0]
    assert scene == (period * 4)[:20]
    xs = [m.pose.position.x for topic, _, m in messages if topic == '/ball/pose']
    assert xs == pytest.approx([t * 1e-9 for t in scene], abs=1e-12)  # 1 m/s, a few roundings
    assert [time for topic, time, _ in messages if topic == '/time'] == [
        k * SECOND // 10 for k in range(1, 21)
    ]


def test_a_compressed_bag_is_smaller_and_says_the_same(tmp_path, mixed):
    folder = tmp_path / 'mixed'
    record('mixed', '--duration', 2, '--rate', 50, '--seed', 3, '-o', folder, '--compress')
    assert raw_with_mcap(folder) == raw_with_mcap(mixed)
    size = (folder / 'mixed.mcap').stat().st_size
    assert size < 0.7 * (mixed / 'mixed.mcap').stat().st_size  # double digits hardly compress


def test_only_the_topics_that_were_asked_for_are_recorded(tmp_path):
    record('lesson', '--duration', 1, '--topics', 'poses', '/green/pose', '-o', tmp_path / 'bag')
    assert {t for t, _, _ in read_with_rosbags(tmp_path / 'bag')} == {'/poses', '/green/pose'}


def test_the_scene_beside_a_recording_is_the_scene_that_was_recorded(mixed):
    again, scene = load_scene(mixed / 'scene.yaml'), load_scene('mixed', 3)
    assert (again.circles, again.walls) == (scene.circles, scene.walls)  # to the last bit
