"""A recording holds the bytes that the node in clock mode says over DDS."""

from __future__ import annotations

import importlib
import json
import math
import time
from pathlib import Path

import pytest

pytest.importorskip('rosbags', reason='recordings need the extra `offline`')

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseArray, PoseStamped, TwistStamped
from mcap.reader import make_reader
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import deserialize_message
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import PointCloud2, TimeReference
from visualization_msgs.msg import MarkerArray

from circle_bounce_ros.kernel import Simulation
from circle_bounce_ros.offline import plot
from circle_bounce_ros.offline.bag_source import of_bag
from circle_bounce_ros.offline.record import main
from circle_bounce_ros.scene_file import load_scene

TYPES = {
    '/clock': Clock,
    '/time': TimeReference,
    '/poses': PoseArray,
    '/bodies': PointCloud2,
    '/contacts': PointCloud2,
    '/markers': MarkerArray,
    '/ball/pose': PoseStamped,
    '/ball/twist': TwistStamped,
}
LATCHED = {'/markers/static': MarkerArray, '/post/pose': PoseStamped}
RATE = 50.0  # Hz
ENOUGH = 45  # messages: the scene has started again


def listen(observer, topic, kind, latched):
    """Return the list that the bytes of all messages of a topic are going to be in."""
    heard = []
    durability = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
    qos = QoSProfile(depth=1000, durability=durability)
    observer.node.create_subscription(kind, topic, heard.append, qos, raw=True)
    return heard


def test_every_message_of_the_node_is_in_the_recording_byte_for_byte(
    start, observer, write_scene, tmp_path
):
    scene = write_scene(
        'small',
        circles=[
            {'name': 'ball', 'position': [0.5, 0.5], 'velocity': [1.3, 0.7], 'radius': 0.2},
            {'name': 'post', 'position': [2.0, 2.0], 'radius': 0.5, 'locked': True},
        ],
        groups=[
            {
                'count': 20,
                'radius': 0.1,
                'speed': 2.0,
                'region': {'min': [0.0, 2.7], 'max': [4.0, 4.0]},
            }
        ],
        walls=[{'box': {'min': [0.0, 0.0], 'max': [4.0, 4.0]}}],
        restart_after=0.75,
    )
    heard = {
        topic: listen(observer, topic, kind, topic in LATCHED)
        for topic, kind in (TYPES | LATCHED).items()
    }
    start(scene=scene, seed=4, publish_clock='true', rate=RATE)
    try:
        observer.spin_until(lambda: all(heard[topic] for topic in LATCHED), 'what is latched')
        observer.spin_until(
            lambda: all(len(heard[topic]) > ENOUGH for topic in TYPES),
            f'{ENOUGH} messages of each topic',
            within=60.0,
        )
    finally:
        print({topic: len(messages) for topic, messages in heard.items()})
    folder = tmp_path / 'bag'
    arguments = [scene, '--seed', 4, '--rate', RATE, '--duration', 120, '-o', folder]
    assert main([str(argument) for argument in arguments]) == 0
    recorded = {topic: [] for topic in heard}
    types = {}
    with (folder / 'bag.mcap').open('rb') as file:
        for schema, channel, message in make_reader(file).iter_messages():
            # On its way through DDS a message is filled up to a multiple of four bytes.
            recorded[channel.topic].append(message.data + bytes(-len(message.data) % 4))
            types[channel.topic] = schema.name
    for topic in LATCHED:
        assert heard[topic] == recorded[topic], topic
    for topic in TYPES:
        place = {data: k for k, data in enumerate(recorded[topic])}
        # The first one is as the node was when it learned of its listener: contacts from then on only, and
        # markers that say to forget what was shown before.
        later = heard[topic][1:]
        assert [data for data in later if data not in place] == [], topic
        order = [place[data] for data in later]
        assert order == sorted(order), topic
    # All that the node has is in the recording, but for what it says about itself by the clock on the wall.
    kinds = {kind.__module__.split('.')[0] + '/msg/' + kind.__name__ for kind in [DiagnosticArray]}
    said = {
        name: names[0]
        for name, names in observer.node.get_topic_names_and_types()
        if observer.node.get_publishers_info_by_topic(name)
    }
    said = {
        name: kind
        for name, kind in said.items()
        if name not in ('/rosout', '/parameter_events') and kind not in kinds
    }
    assert said == types


def test_a_recording_offers_what_the_node_offers(start, observer, lesson, tmp_path):
    from rosbags.rosbag2 import Reader

    start(scene=lesson, publish_clock='true')
    assert main([str(lesson), '--duration', '1', '-o', str(tmp_path / 'bag')]) == 0
    with Reader(tmp_path / 'bag') as reader:
        offered = {c.topic: c.ext.offered_qos_profiles[0] for c in reader.connections}
    observer.spin_until(
        lambda: all(observer.node.get_publishers_info_by_topic(topic) for topic in offered),
        'every topic',
    )
    for topic, recorded in offered.items():
        (publisher,) = observer.node.get_publishers_info_by_topic(topic)
        qos = publisher.qos_profile
        assert qos.reliability.name == recorded.reliability.name, topic
        assert qos.durability.name == recorded.durability.name, topic


def test_what_a_recorder_hears_of_the_node_can_be_drawn(start, observer, lesson, tmp_path):
    """As `ros2 bag record` does it: the bytes of each message, at the time when they came."""
    kinds = {'/bodies': PointCloud2, '/contacts': PointCloud2, '/time': TimeReference}
    kinds['/markers/static'] = MarkerArray
    heard = []

    def recorder_of(topic):
        return lambda data: heard.append((topic, time.time_ns(), data))

    for topic, kind in kinds.items():
        durability = (
            DurabilityPolicy.TRANSIENT_LOCAL if topic in LATCHED else DurabilityPolicy.VOLATILE
        )
        qos = QoSProfile(depth=1000, durability=durability)
        observer.node.create_subscription(kind, topic, recorder_of(topic), qos, raw=True)
    # By the clock on the wall, but ten times as fast as it.
    start(scene=lesson, time_scale=10.0, rate=50.0)
    observer.spin_until(lambda: len([t for t, _, _ in heard if t == '/bodies']) > 60, 'bodies')
    # Topics are found one after the other: bodies may have been heard before the first time.
    references = [deserialize_message(d, TimeReference) for t, _, d in heard if t == '/time']
    stamps = [r.header.stamp for r in references]
    heard = [
        (topic, came, data)
        for topic, came, data in heard
        if topic in LATCHED or deserialize_message(data, kinds[topic]).header.stamp in stamps
    ]
    folder = tmp_path / 'heard'
    types = get_typestore(Stores.ROS2_JAZZY)
    with Writer(folder, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connections = {
            topic: writer.add_connection(
                topic, f'{kind.__module__.split(".")[0]}/msg/{kind.__name__}', typestore=types
            )
            for topic, kind in kinds.items()
        }
        for topic, came, data in heard:
            writer.write(connections[topic], came, data)
    source = of_bag(folder, math.inf, 1000.0)
    scene = load_scene(lesson)
    assert source.scene.walls == scene.walls
    frames = list(source.frames())
    first = deserialize_message(
        next(d for t, _, d in heard if t == '/bodies'), PointCloud2
    ).header.stamp
    (began,) = [
        r.time_ref.sec + r.time_ref.nanosec * 1e-9 for r in references if r.header.stamp == first
    ]
    assert frames[-1].time > 5.0  # more than half a second on the wall
    simulation = Simulation(scene)
    for frame in frames:
        simulation.advance_to(began + frame.time)
        # float32 in the message, metres.
        assert frame.positions == pytest.approx(simulation.positions, abs=1e-6)
    assert sum(len(frame.contacts) for frame in frames) > 3
    assert plot.main(['energy', str(folder), '-o', str(tmp_path / 'energy.png')]) == 0
    assert plot.main(['free_path', str(folder), '-o', str(tmp_path / 'path.png')]) == 0


def test_channels_have_the_hash_of_their_type_that_ros_itself_has(tmp_path):
    """As rosbag2_storage_mcap writes it, so that a player can tell another version of a type."""
    bag = tmp_path / 'bag'
    assert main(['lesson', '--duration', '1', '-o', str(bag)]) == 0
    with next(bag.glob('*.mcap')).open('rb') as file:
        summary = make_reader(file).get_summary()
    said = {}
    for channel in summary.channels.values():
        assert set(channel.metadata) == {'offered_qos_profiles', 'topic_type_hash'}
        said[summary.schemas[channel.schema_id].name] = channel.metadata['topic_type_hash']
    assert len(said) == 7
    for name, found in said.items():
        package, _, kind = name.split('/')
        here = Path(importlib.import_module(package).__file__)
        places = [folder / 'share' / package / 'msg' / f'{kind}.json' for folder in here.parents]
        description = next(path for path in places if path.exists())
        hashes = json.loads(description.read_text())['type_hashes']
        assert found == next(h['hash_string'] for h in hashes if h['type_name'] == name)
    # A repair keeps them.
    (bag / 'metadata.yaml').unlink()
    assert main(['--repair', str(bag)]) == 0
    with next(bag.glob('*.mcap')).open('rb') as file:
        again = make_reader(file).get_summary()
    assert [c.metadata for c in again.channels.values()] == [
        c.metadata for c in summary.channels.values()
    ]
