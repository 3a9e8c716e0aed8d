"""The ordinary way to the same bytes: messages built field by field, serialized by rclpy."""

import math
import struct

import numpy as np
from geometry_msgs.msg import Point, Pose, PoseArray, PoseStamped, TwistStamped
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import PointCloud2, PointField, TimeReference
from visualization_msgs.msg import Marker, MarkerArray

LAST_NS = 2**31 * 10**9 - 1

stamps = st.sampled_from([0, 1, 10**9 - 1, 10**9, LAST_NS]) | st.integers(0, LAST_NS)
texts = st.sampled_from(['', 'world', 'a/b', 'größe', '世界', '🟢']) | st.text(
    st.characters(exclude_categories=['Cs'], exclude_characters='\0'), max_size=17
)
numbers = st.floats(allow_nan=False, allow_infinity=False)
points = st.tuples(numbers, numbers)

COUNTS = [0, 1, 2, 7, 1000]


def random_points(rng, count):
    """Return numbers of all sizes that float32 can hold, (count, 2)."""
    return rng.normal(size=(count, 2)) * 10.0 ** rng.integers(-30, 30, (count, 2))


def assert_same(encoded, message):
    """
    Check that the bytes are those that rclpy makes of the message, and mean the same.

    Where alignment leaves a gap, rclpy leaves what the memory held before (Fast CDR skips the gap) and
    the encoders have zeros. So a difference is allowed where ours is 0 and rclpy's reader does not look.
    """
    assert isinstance(encoded, bytes)
    ordinary = serialize_message(message)
    assert len(encoded) == len(ordinary)
    ours = np.frombuffer(encoded, np.uint8)
    theirs = np.frombuffer(ordinary, np.uint8)
    differ = np.flatnonzero(ours != theirs)
    if differ.size:
        assert not ours[differ].any(), differ
        disturbed = theirs.copy()
        disturbed[differ] ^= 0xFF
        assert deserialize_message(disturbed.tobytes(), type(message)) == message, differ
    assert deserialize_message(encoded, type(message)) == message


def set_time(time, nanoseconds):
    time.sec = nanoseconds // 10**9
    time.nanosec = nanoseconds % 10**9


def set_header(header, frame_id, stamp_ns):
    header.frame_id = frame_id
    set_time(header.stamp, stamp_ns)


def pose_stamped(frame_id, stamp_ns, position):
    message = PoseStamped()
    set_header(message.header, frame_id, stamp_ns)
    message.pose.position.x, message.pose.position.y = map(float, position)
    message.pose.orientation.w = 1.0
    return message


def twist_stamped(frame_id, stamp_ns, velocity):
    message = TwistStamped()
    set_header(message.header, frame_id, stamp_ns)
    message.twist.linear.x, message.twist.linear.y = map(float, velocity)
    return message


def pose_array(frame_id, stamp_ns, positions):
    message = PoseArray()
    set_header(message.header, frame_id, stamp_ns)
    for x, y in positions:
        pose = Pose()
        pose.position.x, pose.position.y = float(x), float(y)
        pose.orientation.w = 1.0
        message.poses.append(pose)
    return message


def time_reference(frame_id, source, stamp_ns, scene_ns):
    message = TimeReference(source=source)
    set_header(message.header, frame_id, stamp_ns)
    set_time(message.time_ref, scene_ns)
    return message


def clock(stamp_ns):
    message = Clock()
    set_time(message.clock, stamp_ns)
    return message


def float32(value):
    """Return a number rounded to float32, infinite beyond its range."""
    try:
        return struct.unpack('<f', struct.pack('<f', value))[0]
    except OverflowError:
        return math.copysign(math.inf, value)


def cloud(frame_id, stamp_ns, fields, point_format, rows):
    """Return a PointCloud2 of rows packed with a `struct` format whose x are the gaps."""
    message = PointCloud2(height=1, width=len(rows), is_bigendian=False)
    set_header(message.header, frame_id, stamp_ns)
    for name, offset, datatype in fields:
        message.fields.append(PointField(name=name, offset=offset, datatype=datatype, count=1))
    message.point_step = struct.calcsize(point_format)
    message.row_step = message.point_step * len(rows)
    message.data = b''.join(struct.pack(point_format, *row) for row in rows)
    message.is_dense = all(math.isfinite(value) for row in rows for value in row)
    return message


BODY_FIELDS = [
    ('x', 0, PointField.FLOAT32),
    ('y', 4, PointField.FLOAT32),
    ('z', 8, PointField.FLOAT32),
    ('vx', 12, PointField.FLOAT32),
    ('vy', 16, PointField.FLOAT32),
    ('radius', 20, PointField.FLOAT32),
    ('mass', 24, PointField.FLOAT32),
    ('id', 28, PointField.UINT32),
]


def bodies(frame_id, stamp_ns, ids, radii, masses, positions, velocities):
    rows = [
        (*map(float32, (x, y, 0.0, vx, vy, radius, mass)), int(id))
        for id, radius, mass, (x, y), (vx, vy) in zip(
            ids, radii, masses, positions, velocities, strict=True
        )
    ]
    return cloud(frame_id, stamp_ns, BODY_FIELDS, '<7fI', rows)


CONTACT_FIELDS = [
    ('x', 0, PointField.FLOAT32),
    ('y', 4, PointField.FLOAT32),
    ('z', 8, PointField.FLOAT32),
    ('nx', 12, PointField.FLOAT32),
    ('ny', 16, PointField.FLOAT32),
    ('nz', 20, PointField.FLOAT32),
    ('time', 24, PointField.FLOAT64),
    ('a', 32, PointField.UINT32),
    ('b', 36, PointField.UINT32),
    ('impulse', 40, PointField.FLOAT32),
    ('ax0', 44, PointField.FLOAT32),
    ('ay0', 48, PointField.FLOAT32),
    ('ax1', 52, PointField.FLOAT32),
    ('ay1', 56, PointField.FLOAT32),
    ('bx0', 60, PointField.FLOAT32),
    ('by0', 64, PointField.FLOAT32),
    ('bx1', 68, PointField.FLOAT32),
    ('by1', 72, PointField.FLOAT32),
    ('kind', 76, PointField.UINT8),
]


def contacts(frame_id, stamp_ns, rows):
    """Return the cloud of rows that are (time, a, b, kind, x, y, nx, ny, impulse, 8 velocities)."""
    points = [
        (*map(float32, (x, y, 0.0, nx, ny, 0.0)), time, a, b, *map(float32, rest), kind)
        for time, a, b, kind, x, y, nx, ny, *rest in rows
    ]
    return cloud(frame_id, stamp_ns, CONTACT_FIELDS, '<6fdII9fB', points)


def read_points(message):
    """Return what a reader finds in a cloud: for each point its values by name, as its fields say."""
    codes = {
        PointField.UINT8: 'B',
        PointField.UINT32: 'I',
        PointField.FLOAT32: 'f',
        PointField.FLOAT64: 'd',
    }
    assert len(message.data) == message.height * message.row_step
    return [
        {
            field.name: struct.unpack_from(
                '<' + codes[field.datatype], message.data, start + field.offset
            )[0]
            for field in message.fields
        }
        for start in range(0, message.row_step, message.point_step)
    ]


GREEN = (0.0, 158 / 255, 115 / 255, 1.0)
RED = (213 / 255, 94 / 255, 0.0, 1.0)
GREY = (0.6, 0.6, 0.6, 1.0)


def marker(frame_id, stamp_ns, ns, id, type, scale, colour, points=(), position=(0.0, 0.0)):
    message = Marker(ns=ns, id=int(id), type=type, action=Marker.ADD)
    set_header(message.header, frame_id, stamp_ns)
    message.pose.position.x, message.pose.position.y = map(float, position)
    message.pose.orientation.w = 1.0
    message.scale.x, message.scale.y, message.scale.z = map(float, scale)
    message.color.r, message.color.g, message.color.b, message.color.a = map(float32, colour)
    message.points = [Point(x=float(x), y=float(y)) for x, y in points]
    return message


def delete_all(frame_id, stamp_ns):
    message = Marker(action=Marker.DELETEALL)
    set_header(message.header, frame_id, stamp_ns)
    return message


def sphere_lists(frame_id, stamp_ns, ns, colour, radii, positions):
    return [
        marker(
            frame_id,
            stamp_ns,
            ns,
            number,
            Marker.SPHERE_LIST,
            (2 * radius,) * 3,
            colour,
            [point for own, point in zip(radii, positions, strict=True) if own == radius],
        )
        for number, radius in enumerate(sorted(set(radii)))
    ]


def moving_markers(frame_id, stamp_ns, radii, positions, clear):
    start = [delete_all(frame_id, stamp_ns)] if clear else []
    lists = sphere_lists(frame_id, stamp_ns, 'moving', GREEN, radii, positions)
    return MarkerArray(markers=start + lists)


def static_markers(frame_id, stamp_ns, scene):
    markers = [delete_all(frame_id, stamp_ns)]
    if scene.walls:
        ends = [end for wall in scene.walls for end in (wall.start, wall.end)]
        box = [max(axis) - min(axis) for axis in zip(*ends, strict=True)]
        scale = (0.005 * max(box), 0.0, 0.0)
        markers.append(marker(frame_id, stamp_ns, 'walls', 0, Marker.LINE_LIST, scale, GREY, ends))
    locked = [(index, circle) for index, circle in enumerate(scene.circles) if circle.locked]
    if len(locked) > 1000:
        radii = [circle.radius for _, circle in locked]
        positions = [circle.position for _, circle in locked]
        markers += sphere_lists(frame_id, stamp_ns, 'locked', RED, radii, positions)
        return MarkerArray(markers=markers)
    for index, circle in locked:
        diameter = 2 * circle.radius
        markers.append(
            marker(
                frame_id,
                stamp_ns,
                'locked',
                index,
                Marker.CYLINDER,
                (diameter, diameter, 0.1 * diameter),
                RED,
                position=circle.position,
            )
        )
    return MarkerArray(markers=markers)
