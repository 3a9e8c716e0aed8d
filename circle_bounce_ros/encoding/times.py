"""sensor_msgs/TimeReference and rosgraph_msgs/Clock."""

from __future__ import annotations

from circle_bounce_ros.encoding.layout import Layout
from circle_bounce_ros.encoding.stamps import put_header, put_time, split


class TimeReferenceEncoder:
    """Which scene time belongs to a stamp, as sensor_msgs/TimeReference."""

    def __init__(self, frame_id: str, source: str) -> None:
        layout = Layout()
        stamp = put_header(layout, frame_id)
        scene_time = put_time(layout)
        layout.put_string(source, 'source')
        self._message = layout.finish()
        self._stamp = self._message.view(stamp)
        self._scene_time = self._message.view(scene_time)

    def encode(self, stamp_ns: int, scene_ns: int) -> bytes:
        """Return the message: at the stamp it was `scene_ns` in the scene, both in ns."""
        self._stamp[:] = split(stamp_ns)
        self._scene_time[:] = split(scene_ns, 'scene time')
        return self._message.to_bytes()


class ClockEncoder:
    """The time as rosgraph_msgs/Clock."""

    def __init__(self) -> None:
        layout = Layout()
        clock = put_time(layout)
        self._message = layout.finish()
        self._clock = self._message.view(clock)

    def encode(self, stamp_ns: int) -> bytes:
        """Return the message for a time in ns."""
        self._clock[:] = split(stamp_ns)
        return self._message.to_bytes()
