"""Contacts and states, brought together by stamp."""

import asyncio
import json

import numpy as np
import pytest
from viewing import connected, run

from circle_bounce_ros.encoding import BodiesEncoder, ContactsEncoder
from circle_bounce_ros.kernel import CONTACT, ContactKind
from circle_bounce_ros.viewer.cloud import read_cloud, stamp_of
from circle_bounce_ros.viewer.server import Server
from circle_bounce_ros.viewer.witness import Witness

BODIES = BodiesEncoder('world', [3, 5], [0.1, 0.2], [1.0, 1.0])
CONTACTS = ContactsEncoder('world')


def bodies(stamp_ns, speed):
    return BODIES.encode(stamp_ns, [[1, 2], [3, 4]], [[speed, 0], [0, speed]])


def contacts(stamp_ns, *rows):
    log = np.zeros(len(rows), CONTACT)
    for entry, (a, b, kind) in zip(log, rows, strict=True):
        entry['a'], entry['b'], entry['kind'], entry['nx'], entry['time'] = a, b, kind, 1.0, 0.1
    return CONTACTS.encode(stamp_ns, log)


@pytest.fixture
def witness():
    return Witness()


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


def test_a_cloud_that_claims_more_points_than_can_be_counted_is_refused():
    message = bytearray(bodies(1, 1.0))
    # Height and width, behind the header of CDR, the stamp and the frame's name.
    message[24:32] = b'\xff' * 8
    with pytest.raises(ValueError, match='cloud: not readable'):
        read_cloud(bytes(message))


def test_a_cloud_without_the_fields_of_a_contact_is_refused_by_name(witness):
    with pytest.raises(ValueError, match='must have the fields a, b, impulse, kind, nx, ny, time'):
        witness.hear(bodies(10, 1.0))
    witness.see(contacts(10))
    witness.see(contacts(20))
    witness.hear(contacts(20, (3, 5, ContactKind.CIRCLE)))
    with pytest.raises(ValueError, match='must have the fields id, vx, vy'):
        witness.take({3})


def test_the_velocities_are_those_of_the_ticks_before_and_at_the_contact(witness):
    for stamp, speed in ((10, 1.0), (20, 2.0), (30, 3.0)):
        witness.see(bodies(stamp, speed))
    witness.hear(contacts(20, (5, 0, ContactKind.WALL)))
    (text,) = witness.take({5})[5]
    story = json.loads(text)
    assert (story['before']['vy'], story['after']['vy']) == (1.0, 2.0)
    assert [row['kind'] for row in story['contacts']] == [ContactKind.WALL]


def test_contacts_wait_for_the_state_of_their_tick(witness):
    witness.see(bodies(10, 1.0))
    witness.hear(contacts(20, (3, 5, ContactKind.CIRCLE)))
    assert witness.take({3, 5}) == {}
    witness.see(bodies(20, 2.0))
    assert witness.take({3, 5}).keys() == {3, 5}
    assert witness.take({3, 5}) == {}


def test_the_number_of_a_wall_is_not_taken_for_a_circle(witness):
    witness.see(bodies(10, 1.0))
    witness.see(bodies(20, 2.0))
    witness.hear(contacts(20, (3, 5, ContactKind.WALL)))
    assert witness.take({5}) == {}


def test_a_contact_whose_ticks_were_missed_is_not_told_wrongly(witness):
    witness.see(bodies(30, 3.0))
    witness.hear(contacts(20, (3, 5, ContactKind.CIRCLE)))
    witness.hear(contacts(30, (3, 5, ContactKind.CIRCLE)))
    assert witness.take({3, 5}) == {}


def test_contacts_of_a_tick_whose_state_was_missed_belong_to_the_states_around_it(witness):
    witness.see(bodies(10, 1.0))
    witness.hear(contacts(20, (3, 0, ContactKind.WALL)))
    witness.hear(contacts(30, (3, 5, ContactKind.CIRCLE)))
    assert witness.take({3}) == {}
    witness.see(bodies(30, 3.0))
    (text,) = witness.take({3})[3]
    story = json.loads(text)
    assert [row['kind'] for row in story['contacts']] == [ContactKind.WALL, ContactKind.CIRCLE]
    assert (story['before']['vx'], story['after']['vx']) == (1.0, 3.0)


def test_a_clock_that_jumps_back_stops_nothing(witness):
    said = []
    for stamp in (100, 110, 10, 20):
        witness.see(bodies(stamp, 1.0))
        witness.hear(contacts(stamp, (3, 0, ContactKind.WALL)))
        said += witness.take({3}).get(3, [])
    assert len(said) == 2


class Nowhere:
    """What the server asks of its RosLink, without ROS."""

    port = 0
    node_name, bodies_topic = '/bounce', '/bodies'

    def __init__(self):
        self.wanted = asyncio.Queue()
        self.logged = []

    def want_contacts(self, wanted):
        self.wanted.put_nowait(wanted)

    def count_publishers(self):
        return 0

    def log(self, text):
        self.logged.append(text)


def test_what_came_before_nobody_had_a_circle_selected_is_no_before():
    later = 600 * 10**9

    async def look():
        server, link = Server(), Nowhere()
        address, _ = await server.start(link)
        try:
            async with connected(address) as page:
                await page.say(type='select', circle=3)
                assert await link.wanted.get()
                server.hear('bodies', bodies(10, 1.0))
                server.hear('contacts', contacts(20, (3, 0, ContactKind.WALL)))
                await page.say(type='select', circle=-1)
                assert not await link.wanted.get()
                await page.say(type='select', circle=3)
                assert await link.wanted.get()
                for stamp, speed in ((later, 2.0), (later + 10, 3.0)):
                    server.hear('bodies', bodies(stamp, speed))
                    server.hear('contacts', contacts(stamp, (3, 0, ContactKind.WALL)))
                return await page.said(type='contacts')
        finally:
            await server.stop()

    story = run(look())
    assert (story['before']['vx'], story['after']['vx']) == (2.0, 3.0)


def test_what_ends_before_its_stamp_is_said_once_and_stops_no_page():
    async def look():
        server, link = Server(), Nowhere()
        address, _ = await server.start(link)
        try:
            async with connected(address) as page:
                for channel in ('time', 'bodies', 'bodies'):
                    server.hear(channel, bodies(10, 1.0)[:9])
                server.hear('bodies', bodies(20, 1.0))
                return (await page.frame())[-1], link.logged
        finally:
            await server.stop()

    message, logged = run(look())
    assert stamp_of(message) == 20
    assert [text.partition(':')[0] for text in logged] == ['time', 'bodies']
