"""
State to serialized ROS 2 messages, with numpy and without ROS.

Building a nested message object by object costs more than the physics in it. So each encoder lays its
message out once, in the order of the message definition, and overwrites per tick what has changed.
`layout` is the wire format, `stamps` time and header, the other modules one family of messages each.

Stamps and scene times are whole nanoseconds, from 0 to below 2**31 s. What is given in the wrong shape
or out of range raises ValueError with place, rule and value. An encoder serves one thread at a time.
"""

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

__all__ = [
    'MOST_RADII',
    'BodiesEncoder',
    'ClockEncoder',
    'ContactsEncoder',
    'MovingMarkersEncoder',
    'PoseArrayEncoder',
    'PoseStampedEncoder',
    'TimeReferenceEncoder',
    'TwistStampedEncoder',
    'encode_static_markers',
]
