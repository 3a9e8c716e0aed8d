"""The topics of `encoding.topics` as the node offers them, each fed only while somebody listens."""

from __future__ import annotations

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseArray, PoseStamped, TwistStamped
from rcl_interfaces.msg import SetParametersResult
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.qos_overriding_options import InvalidQosOverridesError, QoSOverridingOptions
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import PointCloud2, TimeReference
from visualization_msgs.msg import MarkerArray

from circle_bounce_ros.base_node import ParameterError
from circle_bounce_ros.encoding import MOST_RADII, MovingMarkersEncoder
from circle_bounce_ros.encoding.topics import (
    CONTACTS,
    MARKERS,
    Encode,
    Moment,
    Topic,
    can_be_marked,
    feeds_of_a_scene,
    feeds_of_each_tick,
    no_markers,
)
from circle_bounce_ros.kernel import Scene

MOST_DEPTH = 2**31 - 1  # messages kept for a slow subscriber; DDS counts in int32

TYPES = {
    'diagnostic_msgs/msg/DiagnosticArray': DiagnosticArray,
    'geometry_msgs/msg/PoseArray': PoseArray,
    'geometry_msgs/msg/PoseStamped': PoseStamped,
    'geometry_msgs/msg/TwistStamped': TwistStamped,
    'rosgraph_msgs/msg/Clock': Clock,
    'sensor_msgs/msg/PointCloud2': PointCloud2,
    'sensor_msgs/msg/TimeReference': TimeReference,
    'visualization_msgs/msg/MarkerArray': MarkerArray,
}


def qos(topic: Topic) -> QoSProfile:
    """Return the profile of a topic: reliable in any case."""
    if topic.latched:
        return QoSProfile(depth=topic.depth, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    return QoSProfile(depth=topic.depth)


def check_depth(profile: QoSProfile) -> SetParametersResult:
    """Say in words what the C library would say in a block of lines."""
    if 0 <= profile.depth <= MOST_DEPTH:
        return SetParametersResult(successful=True)
    reason = f'depth: must be from 0 to {MOST_DEPTH}, got {profile.depth}'
    return SetParametersResult(successful=False, reason=reason)


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
            TYPES[topic.type],
            topic.name,
            qos(topic),
            qos_overriding_options=QoSOverridingOptions.with_default_policies(
                callback=check_depth
            ),
            # The executor would ask each publisher for events in every round, a third of a tick's cost;
            # of a QoS that does not fit, the subscriber is told as well.
            event_callbacks=PublisherEventCallbacks(use_default_callbacks=False),
        )
    except (ParameterException, InvalidQosOverridesError, RuntimeError, ValueError) as error:
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
        each_tick = dict(feeds_of_each_tick(scene, self._frame_id, self._publish_clock))
        once = dict(feeds_of_a_scene(scene, self._frame_id))
        if MARKERS in self._publishers and not can_be_marked(scene):
            # What RViz shows of the scene before has to go all the same.
            once[MARKERS] = no_markers(MovingMarkersEncoder(self._frame_id, []))
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
