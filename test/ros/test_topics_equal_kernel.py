"""Every topic says what the kernel has at the scene time that `time` gives for its stamp, to the last bit."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from geometry_msgs.msg import PoseArray, PoseStamped, TwistStamped
from observing import nanoseconds, read_points, scene_times, stamps
from sensor_msgs.msg import PointCloud2, TimeReference
from visualization_msgs.msg import Marker, MarkerArray

from circle_bounce_ros.kernel import CONTACT, Simulation
from circle_bounce_ros.scene_file import load_scene

# Every kind of contact, names and none, several radii, locked circles before and between moving ones.
VARIED = {
    'circles': [
        {'name': 'anchor', 'position': [0.0, 0.0], 'radius': 0.2, 'locked': True},
        {'name': 'blue', 'position': [-0.6, 0.1], 'velocity': [4.0, 1.0], 'radius': 0.1},
        {'position': [0.6, 0.3], 'velocity': [-3.0, 2.0], 'radius': 0.15, 'mass': 2.0},
        {'position': [0.5, -0.6], 'radius': 0.2, 'locked': True},
        {'name': 'green', 'position': [-0.5, -0.6], 'velocity': [1.0, 5.0], 'radius': 0.1},
    ],
    'walls': [
        {'box': {'min': [-1.0, -1.0], 'max': [1.0, 1.0]}},
        {'start': [-0.2, 0.5], 'end': [0.2, 0.6]},
    ],
}


class Oracle:
    """The kernel, asked at the scene times of messages."""

    def __init__(self, path):
        self._simulation = Simulation(load_scene(path), record_contacts=True)
        self._states = {}
        self.contacts = []

    def at(self, scene_ns):
        """Return positions and velocities; times must not go back."""
        if scene_ns not in self._states:
            self._simulation.advance_to(scene_ns * 1e-9)
            self._states[scene_ns] = (self._simulation.positions, self._simulation.velocities)
            self.contacts += self._simulation.drain_contacts().tolist()
        return self._states[scene_ns]


@pytest.mark.parametrize(
    'mode', [{}, {'time_scale': 3.7, 'rate': 200.0}, {'publish_clock': 'true'}], ids=str
)
def test_all_topics_equal_the_kernel_bit_for_bit(start, observer, write_scene, mode):
    path = write_scene(**VARIED)
    times = observer.listen(TimeReference, 'time')
    poses = observer.listen(PoseArray, 'poses')
    bodies = observer.listen(PointCloud2, 'bodies')
    contacts = observer.listen(PointCloud2, 'contacts')
    markers = observer.listen(MarkerArray, 'markers')
    pose = {name: observer.listen(PoseStamped, f'{name}/pose') for name in ('blue', 'green')}
    twist = {name: observer.listen(TwistStamped, f'{name}/twist') for name in ('blue', 'green')}
    start(scene=path, **mode)
    observer.collect(times, 120)
    oracle = Oracle(path)
    scene_ns = scene_times(times)
    assert {m.source for m in times} == {'own'}
    for topic in (poses, bodies, contacts, *pose.values(), *twist.values()):
        assert len(topic) > 100
    instants = sorted(scene_ns.values())
    states = {stamp: oracle.at(ns) for stamp, ns in sorted(scene_ns.items(), key=lambda i: i[1])}

    def known(messages):
        pairs = zip(stamps(messages), messages, strict=True)
        return [(stamp, message) for stamp, message in pairs if stamp in states]

    for name, row in (('blue', 0), ('green', 2)):
        for stamp, message in known(pose[name]):
            assert message.header.frame_id == 'world'
            position, orientation = message.pose.position, message.pose.orientation
            assert (position.x, position.y, position.z) == (*states[stamp][0][row], 0.0)
            turn = (orientation.x, orientation.y, orientation.z, orientation.w)
            assert turn == (0.0, 0.0, 0.0, 1.0)
        for stamp, message in known(twist[name]):
            linear, angular = message.twist.linear, message.twist.angular
            assert (linear.x, linear.y, linear.z) == (*states[stamp][1][row], 0.0)
            assert (angular.x, angular.y, angular.z) == (0.0, 0.0, 0.0)
    for stamp, message in known(poses):
        said = [(pose.position.x, pose.position.y) for pose in message.poses]
        assert said == [tuple(position) for position in states[stamp][0]]
    for stamp, message in known(bodies):
        positions, velocities = (array.astype(np.float32) for array in states[stamp])
        points = read_points(message)
        assert points['id'].tolist() == [1, 2, 4]
        assert points['radius'].tolist() == np.float32([0.1, 0.15, 0.1]).tolist()
        assert (points['x'] == positions[:, 0]).all()
        assert (points['y'] == positions[:, 1]).all()
        assert (points['z'] == 0).all()
        assert (points['vx'] == velocities[:, 0]).all()
        assert (points['vy'] == velocities[:, 1]).all()
    for message in markers:
        moving = [marker for marker in message.markers if marker.action == Marker.ADD]
        assert [marker.type for marker in moving] == [Marker.SPHERE_LIST] * 2
        stamp = nanoseconds(moving[0].header.stamp)
        if stamp in states:
            said = [(point.x, point.y) for marker in moving for point in marker.points]
            assert said == [tuple(states[stamp][0][row]) for row in (0, 2, 1)]

    # Every contact between the first message and the last is in the message of the tick that it precedes.
    said = known(contacts)
    # The first message may have been begun before the node heard of its subscriber.
    for (before, _), (stamp, message) in pairwise(said):
        after, until = scene_ns[before] * 1e-9, scene_ns[stamp] * 1e-9
        assert instants.index(scene_ns[stamp]) == instants.index(scene_ns[before]) + 1
        expected = [contact for contact in oracle.contacts if after < contact[0] <= until]
        points = read_points(message)
        assert points['time'].tolist() == [contact[0] for contact in expected]
        for column, name in enumerate(CONTACT.names[1:], start=1):
            values = np.array([contact[column] for contact in expected])
            assert points[name].tolist() == values.astype(points[name].dtype).tolist()
    assert len({contact[3] for contact in oracle.contacts}) >= 3


def test_static_topics_reach_late_subscribers(start, observer, write_scene):
    start(scene=write_scene(**VARIED), frame_id='table')
    times = observer.listen(TimeReference, 'time')
    observer.collect(times, 5)
    anchor = observer.listen(PoseStamped, 'anchor/pose', latched=True)
    static = observer.listen(MarkerArray, 'markers/static', latched=True)
    observer.spin_until(lambda: anchor and static, 'both latched messages')
    assert anchor[0].header.frame_id == 'table'
    assert (anchor[0].pose.position.x, anchor[0].pose.position.y) == (0.0, 0.0)
    actions = [marker.action for marker in static[0].markers]
    assert actions[0] == Marker.DELETEALL
    assert set(actions[1:]) == {Marker.ADD}
    lines = [marker for marker in static[0].markers if marker.type == Marker.LINE_LIST]
    assert len(lines[0].points) == 2 * 5
    observer.collect(times, 20)
    assert (len(anchor), len(static)) == (1, 1)
