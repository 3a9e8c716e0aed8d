"""What RViz asks of markers, and what they show."""

import numpy as np
import pytest
from rclpy.serialization import deserialize_message
from visualization_msgs.msg import Marker, MarkerArray

from circle_bounce_ros.encoding import MovingMarkersEncoder, encode_static_markers
from circle_bounce_ros.kernel import Circle, Scene, Wall

SCENE = Scene(
    [
        Circle((1, 1), (1, 0), radius=0.5),
        Circle((4, 1), radius=0.25, locked=True),
        Circle((7, 1), radius=0.25),
        Circle((1, 4), radius=0.5),
        Circle((4, 4), radius=0.75, locked=True),
    ],
    [Wall((0, 0), (10, 0)), Wall((0, 0), (0, 20))],
)
MOVING = [circle for circle in SCENE.circles if not circle.locked]
RADII = [circle.radius for circle in MOVING]
POSITIONS = [circle.position for circle in MOVING]


def moving(clear=False):
    return markers(MovingMarkersEncoder('world', RADII).encode(1, POSITIONS, clear))


def static():
    return markers(encode_static_markers('world', 1, SCENE))


def markers(encoded):
    return deserialize_message(encoded, MarkerArray).markers


@pytest.mark.parametrize('show', [moving, lambda: moving(clear=True), static])
def test_rviz_has_nothing_to_warn_of(show):
    shown = show()
    # Its own checks (rviz_default_plugins, marker_common): each of these would show as a warning or an error.
    drawn = [marker for marker in shown if marker.action == Marker.ADD]
    assert all(marker.action == Marker.ADD for marker in shown[1:])  # DELETEALL comes first
    assert len({(marker.ns, marker.id) for marker in drawn}) == len(drawn)
    for marker in shown:
        assert marker.header.frame_id == 'world'
        turn = marker.pose.orientation
        assert (turn.x, turn.y, turn.z, turn.w) == (0.0, 0.0, 0.0, 1.0)
    for marker in drawn:
        assert marker.color.a == 1.0
        is_list = marker.type in (Marker.LINE_LIST, Marker.SPHERE_LIST)
        assert is_list == bool(marker.points)
        scale = (marker.scale.x, marker.scale.y, marker.scale.z)
        if marker.type == Marker.LINE_LIST:
            assert len(marker.points) % 2 == 0
            assert scale[0] > 0.0
            assert scale[1:] == (0.0, 0.0)
        else:
            assert min(scale) > 0.0


def test_only_what_clears_begins_with_a_marker_that_deletes_all():
    first = [moving()[0].action, moving(clear=True)[0].action, static()[0].action]
    assert first == [Marker.ADD, Marker.DELETEALL, Marker.DELETEALL]


def test_every_circle_is_shown_once_with_its_diameter_where_it_is():
    shown = [
        (point.x, point.y, point.z, marker.scale.x, marker.scale.y)
        for marker in moving()
        for point in marker.points
    ]
    shown += [
        (at.x, at.y, at.z, marker.scale.x, marker.scale.y)
        for marker in static()
        if marker.type == Marker.CYLINDER
        for at in [marker.pose.position]
    ]
    wanted = [(*c.position, 0.0, 2 * c.radius, 2 * c.radius) for c in SCENE.circles]
    assert sorted(shown) == sorted(wanted)


def test_a_disc_carries_the_id_of_its_circle():
    discs = [marker for marker in static() if marker.ns == 'locked']
    assert [marker.id for marker in discs] == [1, 4]


def test_a_wall_is_a_line_from_end_to_end():
    (lines,) = (marker for marker in static() if marker.ns == 'walls')
    assert [(point.x, point.y, point.z) for point in lines.points] == [
        (0.0, 0.0, 0.0),
        (10.0, 0.0, 0.0),
        (0.0, 0.0, 0.0),
        (0.0, 20.0, 0.0),
    ]
    assert lines.scale.x == 0.1  # 1/200 of 20 m


# Linear RGB to what the eyes with a kind of cones missing see, at full strength (Machado, Oliveira and
# Fernandes 2009, table 1).
EYES = {
    'all cones': np.eye(3),
    'no red cones': [
        (0.152286, 1.052583, -0.204868),
        (0.114503, 0.786281, 0.099216),
        (-0.003882, -0.048116, 1.051998),
    ],
    'no green cones': [
        (0.367322, 0.860646, -0.227968),
        (0.280085, 0.672501, 0.047413),
        (-0.011820, 0.042940, 0.968881),
    ],
    'no blue cones': [
        (1.255528, -0.076749, -0.178779),
        (-0.078411, 0.930809, 0.147602),
        (0.004733, 0.691367, 0.303900),
    ],
}


@pytest.mark.parametrize('eyes', EYES.values(), ids=EYES)
def test_every_kind_of_eye_tells_moving_from_locked_from_wall(eyes):
    colours = [moving()[0].color, *(marker.color for marker in static()[1:3])]
    seen = [np.asarray(eyes) @ (np.array([c.r, c.g, c.b]) ** 2.2) for c in colours]
    for index, one in enumerate(seen):
        for other in seen[:index]:
            assert np.abs(one - other).max() > 0.1  # of the whole range of a channel
