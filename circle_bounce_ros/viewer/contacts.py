"""The contacts of one circle in a serialized `contacts` message, for the page."""

from __future__ import annotations

from typing import Any

import numpy as np

from circle_bounce_ros.kernel import CONTACT_FIELDS, ContactKind
from circle_bounce_ros.viewer.cloud import read_cloud

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
        For a message that is no cloud, one without the fields of a contact, or numbers that are not finite.

    """

    def __init__(self, message: bytes) -> None:
        self._points = read_cloud(message).points
        missing = set(FIELDS) - set(self._points.dtype.names or ())
        if missing:
            raise ValueError(f'cloud: must have the fields {", ".join(sorted(missing))}')
        for name in FIELDS:
            if not np.isfinite(self._points[name]).all():
                raise ValueError(f'cloud: {name} must be finite')

    def of(self, circle: int) -> list[dict[str, Any]]:
        """Return the contacts of the circle with this id, oldest first, with all fields of the record."""
        points = self._points
        is_second = (points['kind'] == ContactKind.CIRCLE) & (points['b'] == circle)
        own = points[(points['a'] == circle) | is_second]
        return [{name: row[name].item() for name in FIELDS} for row in own]
