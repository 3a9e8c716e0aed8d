"""Which topic says what: each is fed by one encoder, and only while somebody listens."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from geometry_msgs.msg import PoseArray, PoseStamped, TwistStamped
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import PointCloud2, TimeReference
from visualization_msgs.msg import MarkerArray

from circle_bounce_ros.encoding import (
    MOST_RADII,
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
from circle_bounce_ros.kernel import Circle, Scene
from circle_bounce_ros.ros.parameters import ParameterError
from circle_bounce_ros.ros.runner import State

DEPTH = 10  # messages that a publisher keeps for a slow subscriber


@dataclass(frozen=True)
class Moment:
    """
    What all messages of one tick say.

    Attributes
    ----------
    stamp_ns : int, ns
    scene_ns : int, ns
    state : State

    """

    stamp_ns: int
    scene_ns: int
    state: State


class Topic(NamedTuple):
    """A topic as the node offers it."""

    name: str
    type: type
    latched: bool = False  # a late subscriber still gets the last message

    def qos(self) -> QoSProfile:
        """Return the profile: reliable in any case."""
        if self.latched:
            return QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        return QoSProfile(depth=DEPTH)


Encode = Callable[[Moment], bytes]
Feed = tuple[Topic, Encode]

CLOCK = Topic('/clock', Clock)
TIME = Topic('time', TimeReference)
POSES = Topic('poses', PoseArray)
BODIES = Topic('bodies', PointCloud2)
CONTACTS = Topic('contacts', PointCloud2)
MARKERS = Topic('markers', MarkerArray)
STATIC_MARKERS = Topic('markers/static', MarkerArray, latched=True)


def create_publisher(node: Node, topic: Topic) -> Publisher:
    """
    Return a publisher whose QoS parameters may override.

    Raises
    ------
    ParameterError
        For QoS parameters that say nothing possible.

    """
    try:
        return node.create_publisher(
            topic.type,
            topic.name,
            topic.qos(),
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
            # The executor would ask each publisher for events in every round, a third of a tick's cost;
            # of a QoS that does not fit, the subscriber is told as well.
            event_callbacks=PublisherEventCallbacks(use_default_callbacks=False),
        )
    except (ParameterException, RuntimeError, ValueError) as error:
        raise ParameterError(f'qos_overrides of {topic.name}: {error}') from error


class Publishers:
    """
    All topics of a scene.

    Parameters
    ----------
    node : Node
    frame_id : str
    publish_clock : bool
        Whether /clock is one of them.

    """

    def __init__(self, node: Node, frame_id: str, publish_clock: bool) -> None:
        self._node = node
        self._frame_id = frame_id
        self._publish_clock = publish_clock
        self._publishers: dict[Topic, Publisher] = {}
        self._each_tick: list[tuple[Publisher, Encode]] = []
        self._once: list[tuple[Publisher, Encode]] = []

    def show(self, scene: Scene) -> None:
        """Publish this scene from now on. Topics that it shares with the last one stay as they are."""
        if not can_be_marked(scene):
            self._node.get_logger().warning(
                f'markers: none for scene {scene.name!r}, its moving circles have more than {MOST_RADII} '
                'different radii'
            )
        each_tick = dict(self._feeds_of_each_tick(scene))
        once = dict(self._feeds_of_a_scene(scene))
        for topic in self._publishers.keys() - each_tick.keys() - once.keys():
            self._node.destroy_publisher(self._publishers.pop(topic))
        for topic in (*each_tick, *once):
            if topic not in self._publishers:
                self._publishers[topic] = create_publisher(self._node, topic)
        self._each_tick = [
            (self._publishers[topic], encode) for topic, encode in each_tick.items()
        ]
        self._once = [(self._publishers[topic], encode) for topic, encode in once.items()]

    def publish(self, moment: Moment) -> None:
        """Publish a tick; for a topic without subscribers nothing is built."""
        for publisher, encode in self._each_tick:
            if publisher.get_subscription_count():
                publisher.publish(encode(moment))
        while self._once:
            publisher, encode = self._once.pop()
            publisher.publish(encode(moment))

    @property
    def contacts_are_wanted(self) -> bool:
        """Whether somebody subscribes to `contacts`."""
        return self._publishers[CONTACTS].get_subscription_count() > 0

    def _feeds_of_each_tick(self, scene: Scene) -> Iterator[Feed]:
        frame_id = self._frame_id
        moving = [(i, circle) for i, circle in enumerate(scene.circles) if not circle.locked]
        radii = [circle.radius for _, circle in moving]
        if self._publish_clock:
            yield CLOCK, clock(ClockEncoder())
        yield TIME, scene_time(TimeReferenceEncoder(frame_id, scene.name))
        for row, (_, circle) in enumerate(moving):
            if circle.name:
                yield pose_topic(circle), pose(PoseStampedEncoder(frame_id), row)
                yield twist_topic(circle), twist(TwistStampedEncoder(frame_id), row)
        yield POSES, poses(PoseArrayEncoder(frame_id, len(moving)))
        yield BODIES, bodies(BodiesEncoder(frame_id, [i for i, _ in moving], radii))
        yield CONTACTS, contacts(ContactsEncoder(frame_id))
        if can_be_marked(scene):
            yield MARKERS, markers(MovingMarkersEncoder(frame_id, radii))

    def _feeds_of_a_scene(self, scene: Scene) -> Iterator[Feed]:
        frame_id = self._frame_id
        yield (
            STATIC_MARKERS,
            lambda moment: encode_static_markers(frame_id, moment.stamp_ns, scene),
        )
        for circle in scene.circles:
            if circle.locked and circle.name:
                yield pose_topic(circle), locked_pose(PoseStampedEncoder(frame_id), circle)
        if MARKERS in self._publishers and not can_be_marked(scene):
            # What RViz shows of the scene before has to go all the same.
            yield MARKERS, no_markers(MovingMarkersEncoder(frame_id, []))


def can_be_marked(scene: Scene) -> bool:
    """Return whether the moving circles have few enough different radii for `markers`."""
    return len({circle.radius for circle in scene.circles if not circle.locked}) <= MOST_RADII


def pose_topic(circle: Circle) -> Topic:
    """Return where a named circle's pose is said; a locked one's is said once, to late subscribers too."""
    return Topic(f'{circle.name}/pose', PoseStamped, latched=circle.locked)


def twist_topic(circle: Circle) -> Topic:
    """Return where a named circle's velocity is said."""
    return Topic(f'{circle.name}/twist', TwistStamped)


def clock(encoder: ClockEncoder) -> Encode:
    return lambda moment: encoder.encode(moment.stamp_ns)


def scene_time(encoder: TimeReferenceEncoder) -> Encode:
    return lambda moment: encoder.encode(moment.stamp_ns, moment.scene_ns)


def pose(encoder: PoseStampedEncoder, row: int) -> Encode:
    return lambda moment: encoder.encode(moment.stamp_ns, moment.state.positions[row])


def twist(encoder: TwistStampedEncoder, row: int) -> Encode:
    return lambda moment: encoder.encode(moment.stamp_ns, moment.state.velocities[row])


def locked_pose(encoder: PoseStampedEncoder, circle: Circle) -> Encode:
    return lambda moment: encoder.encode(moment.stamp_ns, circle.position)


def poses(encoder: PoseArrayEncoder) -> Encode:
    return lambda moment: encoder.encode(moment.stamp_ns, moment.state.positions)


def bodies(encoder: BodiesEncoder) -> Encode:
    def encode(moment: Moment) -> bytes:
        state = moment.state
        return encoder.encode(moment.stamp_ns, state.positions, state.velocities)

    return encode


def contacts(encoder: ContactsEncoder) -> Encode:
    return lambda moment: encoder.encode(moment.stamp_ns, moment.state.contacts)


def no_markers(encoder: MovingMarkersEncoder) -> Encode:
    return lambda moment: encoder.encode(moment.stamp_ns, np.zeros((0, 2)), clear=True)


def markers(encoder: MovingMarkersEncoder) -> Encode:
    clear = True

    def encode(moment: Moment) -> bytes:
        nonlocal clear
        first, clear = clear, False
        return encoder.encode(moment.stamp_ns, moment.state.positions, clear=first)

    return encode
