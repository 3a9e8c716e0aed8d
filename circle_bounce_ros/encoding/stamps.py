"""Time and header: builtin_interfaces/Time and std_msgs/Header."""

from __future__ import annotations

from operator import index

from circle_bounce_ros.encoding.layout import UINT32, Layout, Slot
from circle_bounce_ros.schedule.times import LAST_INSTANT, SECOND


def put_time(layout: Layout) -> Slot:
    """Append a Time; its slot takes what `split` gives."""
    # Both halves as uint32, although seconds are int32: up to LAST_INSTANT the bits are the same.
    return layout.put(UINT32, (0, 0))


def put_header(layout: Layout, frame_id: str) -> Slot:
    """Append a Header and return the slot of its stamp."""
    stamp = put_time(layout)
    layout.put_string(frame_id, 'frame_id')
    return stamp


def split(time_ns: int, place: str = 'stamp') -> tuple[int, int]:
    """
    Return seconds and nanoseconds.

    Raises
    ------
    ValueError
        For a time before 0 or beyond what seconds as int32 can say.
    TypeError
        For a time that is no whole number.

    """
    time_ns = index(time_ns)
    if not 0 <= time_ns <= LAST_INSTANT:
        raise ValueError(f'{place}: must be from 0 to below {LAST_INSTANT + 1} ns, got {time_ns}')
    return divmod(time_ns, SECOND)
