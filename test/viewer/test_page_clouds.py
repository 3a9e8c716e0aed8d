"""Serialized messages as the page reads them."""

import base64
import struct

import numpy as np
import pytest
from messages_by_hand import MOST, X, cloud_of
from scripting import ScriptError

from circle_bounce_ros.encoding import BodiesEncoder
from circle_bounce_ros.encoding.clouds import BODY
from circle_bounce_ros.encoding.markers import encode_static_markers
from circle_bounce_ros.kernel import Circle, Scene, Wall

READ = """
async (load, messages) => {
  const { World } = await load('world.js');
  const world = new World();
  const read = (text) => {
    const { buffer } = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    try {
      world.setBodies(buffer, 0, 0);
    } catch (error) {
      return error.message;
    }
    return Array.from({ length: world.count }, (_, row) => world.circle(row));
  };
  return messages.map(read);
}
"""
LAYOUT = """
async (load, text) => {
  const { World } = await load('world.js');
  const world = new World();
  world.setBodies(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer, 0, 0);
  const { step, fields } = world.cloud;
  return [step, ...['x', 'y', 'vx', 'vy', 'radius', 'id'].map((name) => fields[name].offset)];
}
"""
READ_MARKERS = """
async (load, text) => {
  const { World } = await load('world.js');
  const world = new World();
  world.setStatic(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer, 0);
  return [world.locked, world.walls];
}
"""

IDS, PLACES, SPEEDS = [3, 5], [[1.5, -2.5], [3.0, 4.0]], [[0.5, 0.25], [-1.0, 8.0]]
BODIES = BodiesEncoder('world', IDS, [0.25, 0.5], [1.0, 1.0]).encode(10**9, PLACES, SPEEDS)
ROWS = [
    {'row': 0, 'x': 1.5, 'y': -2.5, 'vx': 0.5, 'vy': 0.25, 'radius': 0.25, 'id': 3},
    {'row': 1, 'x': 3.0, 'y': 4.0, 'vx': -1.0, 'vy': 8.0, 'radius': 0.5, 'id': 5},
]


def in_base64(message):
    return base64.b64encode(message).decode()


@pytest.fixture
def read(scripts):
    """Return a function that gives messages to one page, one after the other: circles of each, or what was wrong."""
    return lambda *messages: scripts.evaluate(READ, [in_base64(each) for each in messages])


def test_bodies_are_read_as_they_were_written(read):
    assert read(BODIES) == [ROWS]


# All that the page needs, and one thing wrong.
FIELDS = [(name, at, 6 if name == 'id' else 7, 1) for name, (_, at) in BODY.fields.items()]
DATA = BODIES[-1 - 2 * BODY.itemsize : -1]
STEP = BODY.itemsize


def wrong(place, *last_field, data=DATA, **parts):
    fields = [*FIELDS[:-1], last_field or FIELDS[-1]]
    return pytest.param(
        cloud_of(fields, data, **({'width': 2, 'step': STEP} | parts)), place, id=place
    )


@pytest.mark.parametrize(
    ('message', 'place'),
    [
        wrong('point_step: must be > 0', width=MOST, step=0, data=b''),
        wrong('fields.id: must end', 'id', STEP - 3, 6, 1),
        wrong('fields.id: must end within', 'id', MOST, 6, 1),
        wrong('fields.id: must have a datatype', 'id', STEP - 4, 9, 1),
        wrong('fields.id: must have count', 'id', STEP - 4, 6, 2),
        wrong('fields.id: must be there', 'id', STEP - 4, 5, 1),
        wrong('fields: must have names', 'x', STEP - 4, 6, 1),
        wrong('fields: must have names that differ', '', STEP - 4, 6, 1),
        wrong('row_step: must', row=STEP),
        wrong('data: must have height', height=MOST),
        wrong('data: must have height * row_step', length=MOST),
        wrong('ends too early', width=4, length=4 * STEP),
        wrong('is_bigendian', big=True),
        pytest.param(b'\0\0' + BODIES[2:], 'little-endian', id='little-endian'),
    ],
)
def test_a_cloud_that_contradicts_itself_is_refused_in_words_and_the_next_is_read(
    read, message, place
):
    fault, circles = read(message, BODIES)
    assert place in fault
    assert circles == ROWS


def test_fields_that_are_missing_or_of_another_type_are_refused_by_name(read):
    narrow = [('x', 0, 8, 1), ('y', 8, 7, 1)]
    missing, wrong = read(cloud_of([X], bytes(4)), cloud_of(narrow, bytes(12), step=12))
    assert missing.startswith('fields.y: must be there')
    assert wrong.startswith('fields.x: must be there')


def test_messages_that_are_cut_short_are_refused_wherever_they_are_cut(read):
    # Nobody asks for the last byte, is_dense.
    *faults, last = read(*(BODIES[:length] for length in range(len(BODIES) - 1)), BODIES)
    assert last == ROWS
    assert all(isinstance(fault, str) for fault in faults)


@pytest.mark.parametrize('step', [27, 28, 300])
def test_points_that_no_graphics_card_takes_are_copied(read, scripts, step):
    names = ['id', 'x', 'y', 'vx', 'vy', 'radius']
    # One byte further than a multiple of 4.
    fields = [(name, 4 * i + 1, 6 if name == 'id' else 7, 1) for i, name in enumerate(names)]
    data = b''.join(
        struct.pack('<xIfffff', *(row[name] for name in names)).ljust(step, b'\1') for row in ROWS
    )
    message = cloud_of(fields, data, width=2, step=step)
    assert read(message) == [ROWS]
    # Attributes of 4 bytes have to begin at multiples of 4, and are at most 255 bytes apart.
    stride, *offsets = scripts.evaluate(LAYOUT, in_base64(message))
    assert stride < 256
    assert {number % 4 for number in (stride, *offsets)} == {0}


def test_a_field_may_have_any_name(read):
    odd = [('__proto__', 0, 7, 1), ('constructor', 0, 7, 1)]
    assert read(cloud_of([*odd, *FIELDS], DATA, width=2, step=STEP)) == [ROWS]


def test_markers_are_read_or_refused_wherever_they_are_cut(scripts):
    circles = [Circle((1, 2), radius=0.5, locked=True), Circle((9, 9), radius=0.1)]
    scene = Scene(circles, walls=[Wall((0, 0), (3, 1))])
    message = encode_static_markers('world', 0, scene)
    locked, walls = scripts.evaluate(READ_MARKERS, in_base64(message))
    assert locked == [{'id': 0, 'x': 1, 'y': 2, 'radius': 0.5}]
    assert walls == [[0, 0, 3, 1]]
    for length in range(len(message)):
        with pytest.raises(ScriptError, match='ends'):
            scripts.evaluate(READ_MARKERS, in_base64(message[:length]))
    number = struct.pack('<d', 3.0)
    at = message.index(number)
    with pytest.raises(ScriptError, match='finite'):
        scripts.evaluate(
            READ_MARKERS, in_base64(message[:at] + struct.pack('<d', np.nan) + message[at + 8 :])
        )
    # As many markers as can be counted.
    with pytest.raises(ScriptError, match='ends'):
        scripts.evaluate(
            READ_MARKERS, in_base64(message[:4] + struct.pack('<I', MOST - 1) + message[8:])
        )
