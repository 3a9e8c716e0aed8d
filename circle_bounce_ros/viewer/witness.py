"""What a selected circle was doing just before and just after it touched something."""

from __future__ import annotations

import json
from collections import deque
from typing import Any

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.kernel import ContactKind
from circle_bounce_ros.viewer.cloud import Cloud, read_cloud, stamp_of

# Messages kept until the other topic's come; more are not on their way at any time.
KEPT = 16

PLACE = ('x', 'y', 'vx', 'vy')
BODY = (*PLACE, 'id')
CONTACT = ('time', 'x', 'y', 'nx', 'ny', 'impulse', 'a', 'b', 'kind')


class Witness:
    """
    Brings `bodies` and `contacts` together by stamp.

    A page may miss messages, and the velocity before a contact is in the one before: so this is done
    where all of them come by. What a circle touched between two states that came belongs to these two.
    """

    def __init__(self) -> None:
        self._bodies: deque[bytes] = deque(maxlen=KEPT)
        self._contacts: deque[Cloud] = deque(maxlen=KEPT)

    def see(self, bodies: bytes) -> None:
        """Take note of a serialized `bodies` message."""
        self._bodies.append(bodies)

    def hear(self, contacts: bytes) -> None:
        """
        Take note of a serialized `contacts` message; there is one each tick, often without any.

        Raises
        ------
        ValueError
            For a message that is no cloud, or one without the fields of a contact.

        """
        self._contacts.append(_cloud_with(CONTACT, contacts))

    def forget(self) -> None:
        """Forget what came: what comes next may be much later."""
        self._bodies.clear()
        self._contacts.clear()

    def take(self, circles: set[int]) -> dict[int, list[str]]:
        """
        Return what can be said by now about these circles, as JSON, and forget it.

        Parameters
        ----------
        circles : set of int
            Ids.

        Returns
        -------
        dict
            For each id its messages, oldest first.

        Raises
        ------
        ValueError
            For a `bodies` message that is no cloud, or one without the fields of a circle.

        """
        said: dict[int, list[str]] = {}
        while len(self._bodies) > 1 and self._contacts:
            then, now = stamp_of(self._bodies[0]), stamp_of(self._bodies[1])
            # More contacts may be on their way. A clock that jumped back is waited for in vain.
            if self._contacts[-1].stamp_ns < now and then < now:
                break
            first = self._bodies.popleft()
            between = [cloud.points for cloud in self._contacts if then < cloud.stamp_ns <= now]
            if not any(map(len, between)):
                continue
            before, after = (_cloud_with(BODY, message) for message in (first, self._bodies[0]))
            for circle in circles:
                story = _story(circle, before, after, np.concatenate(between))
                if story:
                    said.setdefault(circle, []).append(json.dumps(story))
        return said


def _cloud_with(fields: tuple[str, ...], message: bytes) -> Cloud:
    cloud = read_cloud(message)
    missing = set(fields) - set(cloud.points.dtype.names or ())
    if missing:
        raise ValueError(f'cloud: must have the fields {", ".join(sorted(missing))}')
    return cloud


def _story(
    circle: int, before: Cloud, after: Cloud, points: NDArray[np.void]
) -> dict[str, Any] | None:
    second = points['kind'] == ContactKind.CIRCLE
    own = points[(points['a'] == circle) | (second & (points['b'] == circle))]
    places = [_place(circle, cloud) for cloud in (before, after)]
    if not len(own) or None in places:
        return None
    return {
        'type': 'contacts',
        'circle': circle,
        'before': places[0],
        'after': places[1],
        'contacts': [{name: row[name].item() for name in CONTACT} for row in own],
    }


def _place(circle: int, bodies: Cloud) -> dict[str, float] | None:
    rows = np.flatnonzero(bodies.points['id'] == circle)
    if not rows.size:
        return None
    point = bodies.points[rows[0]]
    return {name: float(point[name]) for name in PLACE}
