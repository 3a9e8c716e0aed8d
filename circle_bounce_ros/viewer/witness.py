"""What a selected circle was doing just before and just after it touched something."""

from __future__ import annotations

import json
from collections import deque
from typing import Any

import numpy as np

from circle_bounce_ros.kernel import ContactKind
from circle_bounce_ros.viewer.cloud import Cloud, read_cloud, stamp_of

# Messages kept until the other topic's come; more are not on their way at any time.
KEPT = 16

PLACE = ('x', 'y', 'vx', 'vy')
CONTACT = ('time', 'x', 'y', 'nx', 'ny', 'impulse', 'a', 'b', 'kind')


class Witness:
    """
    Brings `bodies` and `contacts` together by stamp.

    A page may miss messages, and the velocity before a contact is in the one before: so this is done
    where all of them come by.
    """

    def __init__(self) -> None:
        self._bodies: deque[bytes] = deque(maxlen=KEPT)
        self._contacts: deque[Cloud] = deque(maxlen=KEPT)

    def see(self, bodies: bytes) -> None:
        """Take note of a serialized `bodies` message."""
        self._bodies.append(bodies)

    def hear(self, contacts: bytes) -> None:
        """Take note of a serialized `contacts` message."""
        cloud = read_cloud(contacts)
        if len(cloud.points):
            self._contacts.append(cloud)

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

        """
        said: dict[int, list[str]] = {}
        while self._contacts and self._bodies:
            contacts = self._contacts[0]
            stamps = [stamp_of(message) for message in self._bodies]
            if max(stamps) < contacts.stamp_ns:
                break
            self._contacts.popleft()
            if contacts.stamp_ns not in stamps[1:]:
                continue
            now = stamps.index(contacts.stamp_ns)
            before, after = read_cloud(self._bodies[now - 1]), read_cloud(self._bodies[now])
            for circle in circles:
                story = _story(circle, before, after, contacts)
                if story:
                    said.setdefault(circle, []).append(json.dumps(story))
        return said


def _story(circle: int, before: Cloud, after: Cloud, contacts: Cloud) -> dict[str, Any] | None:
    points = contacts.points
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
