"""The contacts of one circle in a serialized `contacts` message, for the page."""

from __future__ import annotations

from typing import Any

from circle_bounce_ros.encoding.clouds import CONTACT_POINT
from circle_bounce_ros.kernel import CONTACT_FIELDS, ContactKind
from circle_bounce_ros.viewer.cloud import check_points, read_cloud

FIELDS = [field.name for field in CONTACT_FIELDS]


class Contacts:
    """
    What a `contacts` message says.

    Parameters
    ----------
    message : bytes
        Serialized.

    Raises
    ------
    ValueError
        For a message that is no cloud of contacts, or numbers that are not finite.

    """

    def __init__(self, message: bytes) -> None:
        self._points = read_cloud(message).points
        check_points(self._points, CONTACT_POINT, FIELDS)

    def of(self, circle: int) -> list[dict[str, Any]]:
        """Return the contacts of the circle with this id, oldest first, with all fields of the record."""
        points = self._points
        is_second = (points['kind'] == ContactKind.CIRCLE) & (points['b'] == circle)
        own = points[(points['a'] == circle) | is_second]
        return [{name: row[name].item() for name in FIELDS} for row in own]
