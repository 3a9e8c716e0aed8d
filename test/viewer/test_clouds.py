"""Clouds as the viewer reads them."""

import struct

import numpy as np
import pytest
from messages_by_hand import MOST, X, cloud_of
from viewing import connected, run, serving

from circle_bounce_ros.encoding import BodiesEncoder, ContactsEncoder
from circle_bounce_ros.encoding.clouds import BODY
from circle_bounce_ros.kernel import CONTACT, Circle, ContactKind, Scene, Simulation
from circle_bounce_ros.viewer.cloud import read_cloud, stamp_of
from circle_bounce_ros.viewer.contacts import Contacts
from circle_bounce_ros.viewer.seldom import LONGEST

BODIES = BodiesEncoder('world', [3, 5], [0.1, 0.2], [1.0, 1.0])
CONTACTS = ContactsEncoder('world')


def bodies(stamp_ns, speed):
    return BODIES.encode(stamp_ns, [[1, 2], [3, 4]], [[speed, 0], [0, speed]])


def contacts(stamp_ns, *rows):
    log = np.zeros(len(rows), CONTACT)
    for entry, (a, b, kind) in zip(log, rows, strict=True):
        entry['a'], entry['b'], entry['kind'], entry['nx'], entry['time'] = a, b, kind, 1.0, 0.1
    return CONTACTS.encode(stamp_ns, log)


def test_a_cloud_is_read_as_it_was_written():
    stamp_ns = 12 * 10**9 + 34
    message = BODIES.encode(stamp_ns, [[1.5, -2.5], [3.0, 4.0]], [[0.5, 0.25], [-1.0, 8.0]])
    cloud = read_cloud(message)
    assert cloud.stamp_ns == stamp_of(message) == stamp_ns
    assert cloud.points['id'].tolist() == [3, 5]
    assert cloud.points['x'].tolist() == [1.5, 3.0]
    assert cloud.points['vy'].tolist() == [0.25, 8.0]
    assert cloud.points['radius'].tolist() == [np.float32(0.1), np.float32(0.2)]


def test_a_cloud_that_is_cut_short_is_refused_wherever_it_is_cut():
    message = bodies(1, 1.0)
    # Nobody asks for the last byte, is_dense.
    for length in range(len(message) - 1):
        with pytest.raises(ValueError, match=r'cloud|buffer'):
            read_cloud(message[:length])


def test_the_clouds_of_these_tests_are_those_that_the_encoder_writes():
    fields = [(name, 4 * i, 6 if name == 'id' else 7, 1) for i, name in enumerate(BODY.names)]
    own = bodies(10**9, 1.0)
    again = cloud_of(fields, own[-1 - 2 * BODY.itemsize : -1], width=2, step=BODY.itemsize)
    assert again == own


CONTRADICTIONS = {
    'cloud.point_step': cloud_of([], b'', width=MOST, step=0),
    'cloud.fields.x: must end': cloud_of([X], b'', width=MOST, step=0),
    'cloud.fields.x: must have a datatype': cloud_of([('x', 0, 9, 1)], bytes(4)),
    'cloud.fields.x: must have count': cloud_of([('x', 0, 7, 2)], bytes(8), step=8),
    'cloud.fields.y: must end': cloud_of([X, ('y', MOST, 7, 1)], bytes(4)),
    'cloud.fields: must have names that differ, got .x': cloud_of([X, X], bytes(4)),
    'cloud.fields: must have names that differ, got ..': cloud_of([('', 0, 7, 1)], bytes(4)),
    'cloud.row_step': cloud_of([X], bytes(4), row=8),
    'cloud.row_step: must be width': cloud_of([X], bytes(4), width=2**30, row=0),
    'cloud.data: must have height': cloud_of([X], bytes(4), height=2),
    'cloud.data: must have height .* got 4294967295': cloud_of([X], bytes(4), length=MOST),
    'cloud.data: must have 400 bytes': cloud_of([X], bytes(4), width=100, length=400),
    'cloud.is_bigendian': cloud_of([X], bytes(4), big=True),
    'cloud: must be little-endian': b'\0\0' + cloud_of([X], bytes(4))[2:],
    'cloud.point_step: must be from': cloud_of([X], b'', width=0, step=2**31),
}


@pytest.mark.parametrize('fault', CONTRADICTIONS)
def test_a_cloud_that_contradicts_itself_is_refused_with_the_place(fault):
    with pytest.raises(ValueError, match=fault):
        read_cloud(CONTRADICTIONS[fault])


def test_rows_and_fields_in_any_place_are_read():
    wide = struct.pack('<Bfd', 7, 1.5, 2.5) + struct.pack('<Bfd', 8, 3.5, 4.5)
    fields = [('kind', 0, 2, 1), ('x', 1, 7, 1), ('time', 5, 8, 1)]
    points = read_cloud(cloud_of(fields, wide, height=2, step=13)).points
    assert points.tolist() == [(7, 1.5, 2.5), (8, 3.5, 4.5)]


def test_a_cloud_without_the_fields_of_a_contact_is_refused_by_name():
    with pytest.raises(ValueError, match=r'fields a, ax0, .* time$'):
        Contacts(bodies(10, 1.0))


def test_contacts_that_are_not_finite_are_refused():
    log = np.zeros(2, CONTACT)
    log['by1'][1] = np.nan
    with pytest.raises(ValueError, match='by1 must be finite'):
        Contacts(CONTACTS.encode(10, log))


def test_contacts_of_other_types_are_refused_by_the_field():
    message = CONTACTS.encode(10, np.zeros(1, CONTACT))
    # From float32 to int32: where its description ends, 13 bytes behind its name.
    at = message.index(b'\x04\0\0\0ax0\0') + 8 + 4
    assert message[at] == 7
    with pytest.raises(ValueError, match=r'fields\.ax0: must be float32, got int32'):
        Contacts(message[:at] + b'\x05' + message[at + 1 :])


def test_the_contacts_of_a_circle_are_those_in_which_it_is_one_of_the_two():
    message = contacts(
        20,
        (3, 5, ContactKind.CIRCLE),
        (4, 3, ContactKind.WALL),  # the number of a wall
        (3, 0, ContactKind.LOCKED),
        (2, 3, ContactKind.CIRCLE),
    )
    own = Contacts(message).of(3)
    assert [(row['a'], row['b']) for row in own] == [(3, 5), (3, 0), (2, 3)]
    assert own[0].keys() == set(CONTACT.names)
    assert Contacts(message).of(0) == []


def test_contacts_carry_the_velocities_of_the_record():
    scene = Scene([Circle((0, 0), (2, 0), radius=0.5), Circle((3, 0), radius=0.5, mass=3.0)])
    simulation = Simulation(scene, record_contacts=True)
    simulation.advance_to(1.5)
    (row,) = Contacts(CONTACTS.encode(20, simulation.drain_contacts())).of(1)
    # Head-on, masses 1 and 3: half of the speed comes back, half goes on.
    velocities = {name: row[name] for name in ('ax0', 'ax1', 'bx0', 'bx1')}
    assert velocities == {'ax0': 2.0, 'ax1': -1.0, 'bx0': 0.0, 'bx1': 1.0}


def test_what_ends_before_its_stamp_is_said_once_and_stops_no_page():
    async def look():
        async with serving() as (server, link, address), connected(address) as page:
            for channel in ('time', 'bodies', 'bodies'):
                server.hear(channel, bodies(10, 1.0)[:9])
            server.hear('bodies', bodies(20, 1.0))
            return (await page.frame())[-1], link.logged

    message, logged = run(look())
    assert stamp_of(message) == 20
    assert [text.partition(':')[0] for text in logged] == ['time', 'bodies']


def test_bodies_that_no_page_could_draw_are_said_and_the_next_ones_drawn():
    async def look():
        async with serving() as (server, link, address), connected(address) as page:
            server.hear('bodies', cloud_of([X], b'', width=MOST, step=0))
            for x in (np.nan, np.inf):
                server.hear('bodies', BODIES.encode(10, [[x, 2], [3, 4]], np.ones((2, 2))))
            said = await page.until(lambda m: isinstance(m, dict) and m.get('faults'))
            server.hear('bodies', bodies(20, 1.0))
            *_, message = await page.frame()
            # What was said before the frame: that the fault is over.
            assert page.texts[-1]['faults'] == {}
            return said['faults'], message, link.logged

    faults, message, logged = run(look())
    assert faults['bodies'].startswith('cloud.fields.x: must end')
    assert stamp_of(message) == 20
    assert len(logged) == 1


def test_a_fault_is_one_short_printable_line_whatever_fields_are_called():
    async def look():
        async with serving() as (server, link, address), connected(address) as page:
            server.hear(
                'bodies', cloud_of([('\x1b[31m\n\u202e' * 200, 0, 7, 1)], b'', width=1, step=0)
            )
            said = await page.until(lambda m: isinstance(m, dict) and m.get('faults'))
            return [said['faults']['bodies'], *link.logged]

    for text in run(look()):
        assert text.isprintable()
        assert len(text) <= LONGEST
