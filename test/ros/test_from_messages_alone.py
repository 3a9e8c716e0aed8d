"""What somebody can check who has nothing but the messages."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from geometry_msgs.msg import PoseStamped, TwistStamped
from observing import SECOND, read_points, scene_times, stamps
from sensor_msgs.msg import PointCloud2, TimeReference
from visualization_msgs.msg import Marker, MarkerArray


def by_stamp(messages):
    return dict(zip(stamps(messages), messages, strict=True))


def xy(vector):
    return vector.x, vector.y


@pytest.fixture
def lesson_messages(start, observer):
    """Return what the lesson says from its start until green has bounced a few times, by topic."""
    messages = {
        topic: observer.listen(kind, topic, latched)
        for topic, kind, latched in (
            ('time', TimeReference, False),
            ('green/pose', PoseStamped, False),
            ('green/twist', TwistStamped, False),
            ('red/pose', PoseStamped, True),
            ('bodies', PointCloud2, False),
            ('contacts', PointCloud2, False),
            ('markers/static', MarkerArray, True),
        )
    }
    start(rate=100.0, time_scale=5.0)
    observer.spin_until(lambda: sum(m.width for m in messages['contacts']) > 6, 'seven contacts')
    return messages


def test_the_speed_of_the_lessons_circle_never_changes(lesson_messages):
    speeds = [math.hypot(*xy(m.twist.linear)) for m in lesson_messages['green/twist']]
    directions = {xy(m.twist.linear) for m in lesson_messages['green/twist']}
    assert len(directions) > 3  # of seven bounces, most come after the first message
    # Each bounce rounds a few times in the last of 53 bits.
    assert max(speeds) - min(speeds) < 1e-14 * max(speeds)


def test_nothing_leaves_the_box_or_enters_the_locked_circle(lesson_messages):
    radius = float(read_points(lesson_messages['bodies'][0])['radius'][0])
    markers = lesson_messages['markers/static'][0].markers
    corners = next(m for m in markers if m.type == Marker.LINE_LIST).points
    disc = next(m for m in markers if m.type == Marker.CYLINDER)
    locked = xy(lesson_messages['red/pose'][0].pose.position)
    assert xy(disc.pose.position) == locked
    slack = 1e-7  # radius is a float32
    for message in lesson_messages['green/pose']:
        position = xy(message.pose.position)
        for axis in (0, 1):
            ends = [xy(corner)[axis] for corner in corners]
            assert min(ends) + radius - slack <= position[axis] <= max(ends) - radius + slack
        assert math.dist(position, locked) >= radius + disc.scale.x / 2 - slack


def test_between_contacts_pose_moves_as_twist_says(lesson_messages):
    twists, contacts = (by_stamp(lesson_messages[t]) for t in ('green/twist', 'contacts'))
    scene_ns = scene_times(lesson_messages['time'])
    poses = by_stamp(lesson_messages['green/pose'])
    bounces = checked = 0
    complete = [s for s in poses if s in twists and s in contacts and s in scene_ns]
    for before, after in pairwise(sorted(complete)):
        if contacts[after].width:
            bounces += 1
            assert twists[before].twist.linear != twists[after].twist.linear
            continue
        seconds = (scene_ns[after] - scene_ns[before]) / SECOND
        velocity = xy(twists[after].twist.linear)
        assert xy(twists[before].twist.linear) == velocity
        start, end = (xy(poses[stamp].pose.position) for stamp in (before, after))
        moved = ((end[0] - start[0]) / seconds, (end[1] - start[1]) / seconds)
        # Positions of 2 m are rounded to 2e-16 m, and a tick is 10 ms of wall time at least.
        assert moved == pytest.approx(velocity, abs=1e-12)
        checked += 1
    assert bounces > 4
    assert checked > 100
