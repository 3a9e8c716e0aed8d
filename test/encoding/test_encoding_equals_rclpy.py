"""The bytes of every encoder are those that rclpy makes of the same message built field by field."""

import struct

import numpy as np
import pytest
import rclpy_oracle as ordinary
from geometry_msgs.msg import PoseArray, PoseStamped, TwistStamped
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message
from rclpy_oracle import (
    COUNTS,
    LAST_NS,
    assert_same,
    numbers,
    points,
    random_points,
    stamps,
    texts,
)
from sensor_msgs.msg import PointCloud2, TimeReference
from visualization_msgs.msg import MarkerArray

from circle_bounce_ros.encoding import (
    BodiesEncoder,
    ClockEncoder,
    ContactsEncoder,
    MovingMarkersEncoder,
    PoseArrayEncoder,
    PoseStampedEncoder,
    TimeReferenceEncoder,
    TwistStampedEncoder,
    encode_static_markers,
)
from circle_bounce_ros.kernel import CONTACT, Circle, Scene, Simulation, Wall

# Each encoder is used twice: what the first message held must not show in the second.
states = st.lists(st.tuples(stamps, points), min_size=2, max_size=2)

few = settings(max_examples=40, deadline=None)

BOX = (Wall((0, 0), (9, 0)), Wall((9, 0), (9, 6)), Wall((9, 6), (0, 6)), Wall((0, 6), (0, 0)))
FRAMES = ['', 'w', 'wo', 'wor', 'worl', 'world', 'größe', '世界']


def bits(number):
    return struct.pack('<d', number)


def cells(number):
    """Return a pattern of bits for each of many numbers."""
    return np.asarray(number, np.float64).view(np.uint64).tolist()


@few
@given(texts, states)
def test_pose_stamped(frame_id, states):
    encoder = PoseStampedEncoder(frame_id)
    for stamp_ns, position in states:
        encoded = encoder.encode(stamp_ns, position)
        assert_same(encoded, ordinary.pose_stamped(frame_id, stamp_ns, position))
        read = deserialize_message(encoded, PoseStamped).pose.position
        assert (bits(read.x), bits(read.y)) == (bits(position[0]), bits(position[1]))


@few
@given(texts, states)
def test_twist_stamped(frame_id, states):
    encoder = TwistStampedEncoder(frame_id)
    for stamp_ns, velocity in states:
        encoded = encoder.encode(stamp_ns, velocity)
        assert_same(encoded, ordinary.twist_stamped(frame_id, stamp_ns, velocity))
        read = deserialize_message(encoded, TwistStamped).twist.linear
        assert (bits(read.x), bits(read.y)) == (bits(velocity[0]), bits(velocity[1]))


@few
@given(texts, texts, st.lists(st.tuples(stamps, stamps), min_size=2, max_size=2))
def test_time_reference(frame_id, source, times):
    encoder = TimeReferenceEncoder(frame_id, source)
    for stamp_ns, scene_ns in times:
        encoded = encoder.encode(stamp_ns, scene_ns)
        assert_same(encoded, ordinary.time_reference(frame_id, source, stamp_ns, scene_ns))
        read = deserialize_message(encoded, TimeReference)
        assert read.time_ref.sec * 10**9 + read.time_ref.nanosec == scene_ns
        assert read.header.stamp.sec * 10**9 + read.header.stamp.nanosec == stamp_ns
        assert (read.header.frame_id, read.source) == (frame_id, source)


@few
@given(st.lists(stamps, min_size=2, max_size=2))
def test_clock(times):
    encoder = ClockEncoder()
    for stamp_ns in times:
        assert_same(encoder.encode(stamp_ns), ordinary.clock(stamp_ns))


@few
@given(texts, stamps, st.lists(points, max_size=7))
def test_pose_array(frame_id, stamp_ns, positions):
    encoder = PoseArrayEncoder(frame_id, len(positions))
    encoded = encoder.encode(stamp_ns, np.reshape(positions, (-1, 2)))
    assert_same(encoded, ordinary.pose_array(frame_id, stamp_ns, positions))


@pytest.mark.parametrize('count', COUNTS)
@pytest.mark.parametrize('frame_id', FRAMES)
def test_pose_array_of_any_length_in_any_frame(count, frame_id):
    rng = np.random.default_rng(count)
    encoder = PoseArrayEncoder(frame_id, count)
    for stamp_ns in (LAST_NS, 0):
        positions = random_points(rng, count)
        encoded = encoder.encode(stamp_ns, positions)
        assert_same(encoded, ordinary.pose_array(frame_id, stamp_ns, positions))
        read = deserialize_message(encoded, PoseArray).poses
        assert cells([pose.position.x for pose in read]) == cells(positions[:, 0])
        assert cells([pose.position.y for pose in read]) == cells(positions[:, 1])


sizes = st.floats(1e-60, 1e60)


@few
@given(
    texts,
    stamps,
    st.lists(st.tuples(st.integers(0, 2**32 - 1), sizes, sizes, points, points), max_size=7),
)
def test_bodies(frame_id, stamp_ns, rows):
    ids, radii, masses, positions, velocities = zip(*rows, strict=True) if rows else [()] * 5
    encoded = BodiesEncoder(frame_id, ids, radii, masses).encode(
        stamp_ns, np.reshape(positions, (-1, 2)), np.reshape(velocities, (-1, 2))
    )
    wanted = ordinary.bodies(frame_id, stamp_ns, ids, radii, masses, positions, velocities)
    assert_same(encoded, wanted)


@pytest.mark.parametrize('count', COUNTS)
@pytest.mark.parametrize('frame_id', FRAMES)
def test_bodies_of_any_number_in_any_frame(count, frame_id):
    rng = np.random.default_rng(count)
    ids, radii = rng.permutation(count) * 1000, rng.uniform(0.01, 2.0, count)
    masses = rng.uniform(0.01, 2.0, count)
    encoder = BodiesEncoder(frame_id, ids, radii, masses)
    for stamp_ns in (LAST_NS, 0):
        positions, velocities = random_points(rng, count), random_points(rng, count)
        encoded = encoder.encode(stamp_ns, positions, velocities)
        wanted = ordinary.bodies(frame_id, stamp_ns, ids, radii, masses, positions, velocities)
        assert_same(encoded, wanted)
        message = deserialize_message(encoded, PointCloud2)
        assert message.is_dense
        read = ordinary.read_points(message)
        assert len(read) == message.width == count
        assert [point['id'] for point in read] == ids.tolist()
        for name, values in {
            'x': positions[:, 0],
            'y': positions[:, 1],
            'z': np.zeros(count),
            'vx': velocities[:, 0],
            'vy': velocities[:, 1],
            'radius': radii,
            'mass': masses,
        }.items():
            assert cells([point[name] for point in read]) == cells(
                [ordinary.float32(value) for value in values]
            )


contact_rows = st.tuples(
    numbers,
    st.integers(0, 2**32 - 1),
    st.integers(0, 2**32 - 1),
    st.integers(0, 3),
    *[numbers] * 13,
)


@few
@given(texts, st.lists(st.tuples(stamps, st.lists(contact_rows, max_size=7)), max_size=3))
def test_contacts(frame_id, ticks):
    encoder = ContactsEncoder(frame_id)
    for stamp_ns, rows in ticks:
        encoded = encoder.encode(stamp_ns, np.array(rows, CONTACT))
        assert_same(encoded, ordinary.contacts(frame_id, stamp_ns, rows))


@pytest.mark.parametrize('frame_id', FRAMES)
def test_contacts_of_a_simulation_however_many_a_tick(frame_id):
    circles = [
        Circle((1 + i, 1 + j), (i - 3, 2 - j), radius=0.3, locked=(i, j) == (3, 2))
        for i in range(8)
        for j in range(5)
        if (i, j) != (3, 2)
    ]
    locked = Circle((4, 3), radius=0.3, locked=True)
    simulation = Simulation(Scene([*circles, locked], BOX), record_contacts=True)
    encoder = ContactsEncoder(frame_id)
    counts = set()
    for time in (0.0, 0.01, 0.1, 8.0, 8.01):
        simulation.advance_to(time)
        contacts = simulation.drain_contacts()
        counts.add(contacts.size)
        encoded = encoder.encode(LAST_NS, contacts)
        assert_same(encoded, ordinary.contacts(frame_id, LAST_NS, contacts.tolist()))
        read = ordinary.read_points(deserialize_message(encoded, PointCloud2))
        assert cells([point['time'] for point in read]) == cells(contacts['time'])
        for name in ('a', 'b', 'kind'):
            assert [point[name] for point in read] == contacts[name].tolist()
    assert 0 in counts
    assert max(counts) > 300  # far more than any tick before: nothing of a fixed size will do


@pytest.mark.parametrize('clear', [False, True])
@few
@given(frame_id=texts, data=st.data())
def test_moving_markers(clear, frame_id, data):
    radii = data.draw(
        st.lists(st.sampled_from([0.1, 1.0, 3.0]) | st.floats(1e-60, 1e60), max_size=7)
    )
    encoder = MovingMarkersEncoder(frame_id, radii)
    for _ in range(2):
        stamp_ns = data.draw(stamps)
        positions = data.draw(st.lists(points, min_size=len(radii), max_size=len(radii)))
        encoded = encoder.encode(stamp_ns, np.reshape(positions, (-1, 2)), clear=clear)
        assert_same(encoded, ordinary.moving_markers(frame_id, stamp_ns, radii, positions, clear))


@pytest.mark.parametrize('count', COUNTS)
@pytest.mark.parametrize('frame_id', FRAMES)
def test_moving_markers_of_any_number_in_any_frame(count, frame_id):
    rng = np.random.default_rng(count)
    radii = rng.choice(np.linspace(0.1, 6.4, 64), count)
    encoder = MovingMarkersEncoder(frame_id, radii)
    for stamp_ns, clear in [(0, True), (1, False), (LAST_NS, False)]:
        positions = random_points(rng, count)
        encoded = encoder.encode(stamp_ns, positions, clear)
        assert_same(encoded, ordinary.moving_markers(frame_id, stamp_ns, radii, positions, clear))


# Scenes for static markers: the moving circle is in the box, everything locked beside it.
MOVER = Circle((1, 1), (1, 2), radius=0.5)
PEGS = [Circle((20 + 3 * i, -7.5), radius=0.1 + i / 7, locked=True) for i in range(7)]
MANY_PEGS = [
    Circle((20 + 3 * i, -7.5), radius=0.25 + 0.5 * (i % 3), locked=True) for i in range(1001)
]


@pytest.mark.parametrize('frame_id', FRAMES)
@pytest.mark.parametrize('stamp_ns', [0, LAST_NS])
@pytest.mark.parametrize('walls', [(), BOX[:1], BOX], ids=len)
@pytest.mark.parametrize(
    'circles', [[MOVER], [*PEGS, MOVER], [*PEGS[:2], MOVER, *PEGS[2:]]], ids=len
)
def test_static_markers(frame_id, stamp_ns, walls, circles):
    scene = Scene(circles, walls)
    encoded = encode_static_markers(frame_id, stamp_ns, scene)
    assert_same(encoded, ordinary.static_markers(frame_id, stamp_ns, scene))


@pytest.mark.parametrize('locked', [1000, 1001])
def test_static_markers_of_many_locked_circles(locked):
    scene = Scene([MOVER, *MANY_PEGS[:locked]], BOX)
    encoded = encode_static_markers('world', 5, scene)
    assert_same(encoded, ordinary.static_markers('world', 5, scene))
    # The lines, what deletes, and discs one by one or a list for each of three radii.
    wanted = 2 + (1000 if locked == 1000 else 3)
    assert len(deserialize_message(encoded, MarkerArray).markers) == wanted


def test_what_float32_cannot_hold_is_infinite_and_the_cloud_says_so():
    encoder = BodiesEncoder('world', [0], [1.0], [1.0])
    far = deserialize_message(encoder.encode(0, [(1e39, -1e39)], [(1, 2)]), PointCloud2)
    assert [far.is_dense, *map(ordinary.read_points(far)[0].get, 'xy')] == [False, np.inf, -np.inf]
    near = deserialize_message(encoder.encode(0, [(1e38, -1e38)], [(1, 2)]), PointCloud2)
    assert near.is_dense
    huge = BodiesEncoder('world', [0], [1e39], [1.0]).encode(0, [(0, 0)], [(1, 2)])
    assert not deserialize_message(huge, PointCloud2).is_dense


@pytest.mark.parametrize('encoder', ['bodies', 'contacts'])
def test_points_are_as_long_as_their_fields_and_in_their_order(encoder):
    """What readers make points by, who know the fields only: sensor_msgs_py.point_cloud2.create_cloud."""
    if encoder == 'bodies':
        encoded = BodiesEncoder('w', [3], [0.5], [2.0]).encode(1, [(1.0, 2.0)], [(3.0, 4.0)])
    else:
        encoded = ContactsEncoder('w').encode(1, np.zeros(1, CONTACT))
    cloud = deserialize_message(encoded, PointCloud2)
    sizes = [{2: 1, 6: 4, 7: 4, 8: 8}[field.datatype] * field.count for field in cloud.fields]
    assert [field.offset for field in cloud.fields] == [sum(sizes[:k]) for k in range(len(sizes))]
    assert cloud.point_step == sum(sizes)


def test_a_cloud_goes_through_sensor_msgs_py_and_back():
    library = pytest.importorskip('sensor_msgs_py.point_cloud2', reason='has no package on PyPI')
    log = np.zeros(2, CONTACT)
    log['time'] = [1.5, 2.5]
    log['kind'] = [2, 3]
    cloud = deserialize_message(ContactsEncoder('w').encode(1, log), PointCloud2)
    points = library.read_points(cloud)
    assert points['time'].tolist() == [1.5, 2.5]
    again = library.create_cloud(cloud.header, cloud.fields, points)
    assert (again.data, again.point_step) == (cloud.data, cloud.point_step)
