"""What is recorded of a contact: the one list of fields that the kernel, messages, tables and the page share."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np


class ContactKind(IntEnum):
    """What a moving circle has touched."""

    CIRCLE = 0  # another moving circle
    LOCKED = 1
    WALL = 2
    WALL_END = 3


class ContactField(NamedTuple):
    """
    One number of the record.

    Attributes
    ----------
    name : str
    type : numpy scalar type
    unit : str
        '1' where there is none.
    meaning : str

    """

    name: str
    type: type[np.generic]
    unit: str
    meaning: str


# Circle a has touched b: the circle of that id, or the wall of that number (the lowest, for an end that walls share).
# Of two moving circles a is the one of lower id. What is locked has velocity 0.
CONTACT_FIELDS = (
    ContactField('time', np.float64, 's', 'scene time'),
    ContactField('a', np.int64, '1', 'index of the moving circle in the scene'),
    ContactField('b', np.int64, '1', 'index of the other circle in the scene, or of the wall'),
    ContactField('kind', np.uint8, '1', '0 moving circle, 1 locked circle, 2 wall, 3 wall end'),
    ContactField('x', np.float64, 'm', 'contact point'),
    ContactField('y', np.float64, 'm', 'contact point'),
    ContactField('nx', np.float64, '1', 'unit normal from a to b'),
    ContactField('ny', np.float64, '1', 'unit normal from a to b'),
    ContactField('impulse', np.float64, 'N s', 'what b receives along the normal'),
    ContactField('ax0', np.float64, 'm/s', 'velocity of a before'),
    ContactField('ay0', np.float64, 'm/s', 'velocity of a before'),
    ContactField('ax1', np.float64, 'm/s', 'velocity of a after'),
    ContactField('ay1', np.float64, 'm/s', 'velocity of a after'),
    ContactField('bx0', np.float64, 'm/s', 'velocity of b before'),
    ContactField('by0', np.float64, 'm/s', 'velocity of b before'),
    ContactField('bx1', np.float64, 'm/s', 'velocity of b after'),
    ContactField('by1', np.float64, 'm/s', 'velocity of b after'),
)

# One row per contact.
CONTACT = np.dtype([(field.name, field.type) for field in CONTACT_FIELDS])
