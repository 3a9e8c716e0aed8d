"""
Which topic says what: each is fed by one encoder. Whoever speaks, live or into a file, speaks by this table.

Names are relative to the speaker's namespace, but for /clock.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.encoding.clouds import BodiesEncoder, ContactsEncoder
from circle_bounce_ros.encoding.markers import (
    MOST_RADII,
    MovingMarkersEncoder,
    encode_static_markers,
)
from circle_bounce_ros.encoding.poses import (
    PoseArrayEncoder,
    PoseStampedEncoder,
    TwistStampedEncoder,
)
from circle_bounce_ros.encoding.times import ClockEncoder, TimeReferenceEncoder
from circle_bounce_ros.kernel import Circle, Scene, Simulation

DEPTH = 10  # messages that are kept for a slow subscriber
LATCHED_DEPTH = 1


class State:
    """
    The moving circles at one instant, read from the kernel when somebody asks and only once.

    To be used before the simulation goes on.

    Attributes
    ----------
    positions : (n, 2) float, m
    velocities : (n, 2) float, m/s

    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    @cached_property
    def positions(self) -> NDArray[np.float64]:
        return self._simulation.positions

    @cached_property
    def velocities(self) -> NDArray[np.float64]:
        return self._simulation.velocities

    @cached_property
    def contacts(self) -> NDArray[np.void]:
        """The contacts logged since the last time they were read, (k,), dtype `kernel.CONTACT`."""
        return self._simulation.drain_contacts()


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
    """
    A topic as it is offered: reliable in any case.

    Attributes
    ----------
    name : str
    type : str
        As in `geometry_msgs/msg/PoseStamped`.
    latched : bool
        A late subscriber still gets the last message.

    """

    name: str
    type: str
    latched: bool = False

    @property
    def depth(self) -> int:
        """How many messages are kept for a subscriber."""
        return LATCHED_DEPTH if self.latched else DEPTH


Encode = Callable[[Moment], bytes]
Feed = tuple[Topic, Encode]

CLOCK = Topic('/clock', 'rosgraph_msgs/msg/Clock')
TIME = Topic('time', 'sensor_msgs/msg/TimeReference')
POSES = Topic('poses', 'geometry_msgs/msg/PoseArray')
BODIES = Topic('bodies', 'sensor_msgs/msg/PointCloud2')
CONTACTS = Topic('contacts', 'sensor_msgs/msg/PointCloud2')
MARKERS = Topic('markers', 'visualization_msgs/msg/MarkerArray')
STATIC_MARKERS = Topic('markers/static', 'visualization_msgs/msg/MarkerArray', latched=True)


def feeds_of_each_tick(scene: Scene, frame_id: str, with_clock: bool) -> Iterator[Feed]:
    """Return what is said on each tick, in this order."""
    moving = [(i, circle) for i, circle in enumerate(scene.circles) if not circle.locked]
    radii = [circle.radius for _, circle in moving]
    masses = [circle.mass for _, circle in moving]
    if with_clock:
        yield CLOCK, clock(ClockEncoder())
    yield TIME, scene_time(TimeReferenceEncoder(frame_id, scene.name))
    for row, (_, circle) in enumerate(moving):
        if circle.name:
            yield pose_topic(circle), pose(PoseStampedEncoder(frame_id), row)
            yield twist_topic(circle), twist(TwistStampedEncoder(frame_id), row)
    yield POSES, poses(PoseArrayEncoder(frame_id, len(moving)))
    yield BODIES, bodies(BodiesEncoder(frame_id, [i for i, _ in moving], radii, masses))
    yield CONTACTS, contacts(ContactsEncoder(frame_id))
    if can_be_marked(scene):
        yield MARKERS, markers(MovingMarkersEncoder(frame_id, radii))


def feeds_of_a_scene(scene: Scene, frame_id: str) -> Iterator[Feed]:
    """Return what is said once, with the first tick of a scene."""
    yield STATIC_MARKERS, lambda moment: encode_static_markers(frame_id, moment.stamp_ns, scene)
    for circle in scene.circles:
        if circle.locked and circle.name:
            yield pose_topic(circle), locked_pose(PoseStampedEncoder(frame_id), circle)


def can_be_marked(scene: Scene) -> bool:
    """Return whether the moving circles have few enough different radii for `markers`."""
    return len({circle.radius for circle in scene.circles if not circle.locked}) <= MOST_RADII


def pose_topic(circle: Circle) -> Topic:
    """Return where a named circle's pose is said; a locked one's is said once, to late subscribers too."""
    return Topic(f'{circle.name}/pose', 'geometry_msgs/msg/PoseStamped', latched=circle.locked)


def twist_topic(circle: Circle) -> Topic:
    """Return where a named circle's velocity is said."""
    return Topic(f'{circle.name}/twist', 'geometry_msgs/msg/TwistStamped')


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
