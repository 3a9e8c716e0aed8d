"""What does not fit into a message is refused with place, rule and value."""

import re

import numpy as np
import pytest

from circle_bounce_ros.encoding import (
    MOST_RADII,
    BodiesEncoder,
    ClockEncoder,
    ContactsEncoder,
    MovingMarkersEncoder,
    PoseArrayEncoder,
    PoseStampedEncoder,
    TimeReferenceEncoder,
    TwistStampedEncoder,
    encode_static_markers,
)
from circle_bounce_ros.kernel import CONTACT, Circle, Scene

PAIR = [(0.0, 0.0), (1.0, 1.0)]
SCENE = Scene([Circle((0, 0), radius=1)])

WITH_STAMP = {
    'PoseStamped': lambda t: PoseStampedEncoder('w').encode(t, (0, 0)),
    'TwistStamped': lambda t: TwistStampedEncoder('w').encode(t, (0, 0)),
    'PoseArray': lambda t: PoseArrayEncoder('w', 2).encode(t, PAIR),
    'Bodies': lambda t: BodiesEncoder('w', [0, 1], [1, 1], [1, 1]).encode(t, PAIR, PAIR),
    'Contacts': lambda t: ContactsEncoder('w').encode(t, np.zeros(0, CONTACT)),
    'TimeReference': lambda t: TimeReferenceEncoder('w', 's').encode(t, 0),
    'Clock': lambda t: ClockEncoder().encode(t),
    'MovingMarkers': lambda t: MovingMarkersEncoder('w', [1, 1]).encode(t, PAIR),
    'cleared markers': lambda t: MovingMarkersEncoder('w', [1, 1]).encode(t, PAIR, clear=True),
    'static markers': lambda t: encode_static_markers('w', t, SCENE),
}


@pytest.mark.parametrize('stamp_ns', [-1, 2**31 * 10**9, np.int64(-(10**9))])
@pytest.mark.parametrize('encode', WITH_STAMP.values(), ids=WITH_STAMP)
def test_a_stamp_out_of_range(encode, stamp_ns):
    said = f'stamp: must be from 0 to below 2147483648000000000 ns, got {stamp_ns}'
    with pytest.raises(ValueError, match=f'^{re.escape(said)}$'):
        encode(stamp_ns)


@pytest.mark.parametrize('encode', WITH_STAMP.values(), ids=WITH_STAMP)
def test_a_stamp_that_is_no_whole_number(encode):
    with pytest.raises(TypeError):
        encode(1e9)


@pytest.mark.parametrize('encode', WITH_STAMP.values(), ids=WITH_STAMP)
def test_a_whole_number_of_numpy_is_as_good_a_stamp(encode):
    assert encode(np.int64(5_000_000_007)) == encode(5_000_000_007)


@pytest.mark.parametrize(
    ('said', 'act'),
    [
        (
            'scene time: must be from 0 to below 2147483648000000000 ns, got -5',
            lambda: TimeReferenceEncoder('w', 's').encode(0, -5),
        ),
        (
            "source: must not contain a NUL, got '\\x00'",
            lambda: TimeReferenceEncoder('w', '\0'),
        ),
        (
            'position: must have shape (2,), got (3,)',
            lambda: PoseStampedEncoder('w').encode(0, (1, 2, 3)),
        ),
        (
            'velocity: must have shape (2,), got ()',
            lambda: TwistStampedEncoder('w').encode(0, 1.0),
        ),
        ('count: must be >= 0, got -1', lambda: PoseArrayEncoder('w', -1)),
        (
            'positions: must have shape (3, 2), got (2, 2)',
            lambda: PoseArrayEncoder('w', 3).encode(0, PAIR),
        ),
        (  # numpy would stretch one to all
            'positions: must have shape (3, 2), got (1, 2)',
            lambda: PoseArrayEncoder('w', 3).encode(0, PAIR[:1]),
        ),
        (
            'positions: must have shape (2, 2), got (2, 3)',
            lambda: BodiesEncoder('w', [0, 1], [1, 1], [1, 1]).encode(0, np.zeros((2, 3)), PAIR),
        ),
        (
            'velocities: must have shape (2, 2), got (4,)',
            lambda: BodiesEncoder('w', [0, 1], [1, 1], [1, 1]).encode(0, PAIR, np.zeros(4)),
        ),
        (
            'ids: must have shape (2,), got (3,)',
            lambda: BodiesEncoder('w', [0, 1, 2], [1, 1], [1, 1]),
        ),
        (
            'ids[1]: must be from 0 to below 2**32, got -1',
            lambda: BodiesEncoder('w', [0, -1], [1, 1], [1, 1]),
        ),
        (
            'ids[0]: must be from 0 to below 2**32, got 4294967296',
            lambda: BodiesEncoder('w', [2**32, 0], [1, 1], [1, 1]),
        ),
        (
            'radii: must have shape (n,), got (1, 2)',
            lambda: BodiesEncoder('w', [0, 1], [[1, 1]], [1, 1]),
        ),
        (
            'radii[1]: must be finite and > 0 m, got -0.1',
            lambda: BodiesEncoder('w', [0, 1], [1, -0.1], [1, 1]),
        ),
        (
            'radii[0]: must be finite and > 0 m, got 0.0',
            lambda: BodiesEncoder('w', [0, 1], [0, 1], [1, 1]),
        ),
        (
            'radii[0]: must be finite and > 0 m, got nan',
            lambda: MovingMarkersEncoder('w', [np.nan, 1]),
        ),
        (
            'radii[2]: must be finite and > 0 m, got inf',
            lambda: MovingMarkersEncoder('w', [1, 1, np.inf]),
        ),
        (
            'radii: must have at most 64 different values, got 65',
            lambda: MovingMarkersEncoder('w', [*range(1, 66), 1, 2]),
        ),
        (
            'positions: must have shape (2, 2), got (0, 2)',
            lambda: MovingMarkersEncoder('w', [1, 1]).encode(0, np.zeros((0, 2))),
        ),
        (
            'contacts: must have shape (k,) of kernel.CONTACT, got shape (2, 2) of float64',
            lambda: ContactsEncoder('w').encode(0, np.zeros((2, 2))),
        ),
    ],
    ids=lambda value: value if isinstance(value, str) else '',
)
def test_refused(said, act):
    with pytest.raises(ValueError, match=f'^{re.escape(said)}$'):
        act()


def test_as_many_radii_as_markers_may_have_are_taken():
    assert MOST_RADII == 64
    assert MovingMarkersEncoder('w', range(1, 65)).encode(0, np.zeros((64, 2)))


def test_what_was_refused_leaves_no_trace():
    encoder = PoseArrayEncoder('w', 2)
    before = encoder.encode(7, PAIR)
    with pytest.raises(ValueError, match='positions'):
        encoder.encode(8, PAIR[:1])
    assert encoder.encode(7, PAIR) == before
