"""
The kernel: circles, walls and time.

It knows no ROS, no scene files, no clock and no network; on disk it keeps compiled code only, in a cache folder.

Points and vectors are (2,) or (n, 2), all in SI units, x right, y up, angles counter-clockwise.
"""

from circle_bounce_ros.kernel.contact import (
    boxes_overlap,
    contact_normal,
    contact_point,
    distance,
    in_contact,
)
from circle_bounce_ros.kernel.contact_record import (
    CONTACT,
    CONTACT_FIELDS,
    ContactField,
    ContactKind,
)
from circle_bounce_ros.kernel.engine.backends import compile_ahead
from circle_bounce_ros.kernel.engine.compilation import compiled_code_is_ready
from circle_bounce_ros.kernel.impact import time_to_touch, time_to_wall
from circle_bounce_ros.kernel.invariants import deepest_overlap, kinetic_energy, momentum
from circle_bounce_ros.kernel.reflection import (
    BounceAngles,
    bounce_angles,
    exchange,
    reflect,
    reflect_by_angles,
)
from circle_bounce_ros.kernel.scene import Circle, Scene, SceneError, Wall
from circle_bounce_ros.kernel.simulation import EndlessContactsError, Simulation

__all__ = [
    'CONTACT',
    'CONTACT_FIELDS',
    'BounceAngles',
    'Circle',
    'ContactField',
    'ContactKind',
    'EndlessContactsError',
    'Scene',
    'SceneError',
    'Simulation',
    'Wall',
    'bounce_angles',
    'boxes_overlap',
    'compile_ahead',
    'compiled_code_is_ready',
    'contact_normal',
    'contact_point',
    'deepest_overlap',
    'distance',
    'exchange',
    'in_contact',
    'kinetic_energy',
    'momentum',
    'reflect',
    'reflect_by_angles',
    'time_to_touch',
    'time_to_wall',
]
