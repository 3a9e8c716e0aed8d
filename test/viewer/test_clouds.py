"""Clouds as the viewer reads them."""

import asyncio

import numpy as np
import pytest
from viewing import connected, run

from circle_bounce_ros.encoding import BodiesEncoder, ContactsEncoder
from circle_bounce_ros.kernel import CONTACT, Circle, ContactKind, Scene, Simulation
from circle_bounce_ros.viewer.cloud import read_cloud, stamp_of
from circle_bounce_ros.viewer.contacts import Contacts
from circle_bounce_ros.viewer.server import Server

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


def test_a_cloud_that_claims_more_points_than_can_be_counted_is_refused():
    message = bytearray(bodies(1, 1.0))
    # Height and width, behind the header of CDR, the stamp and the frame's name.
    message[24:32] = b'\xff' * 8
    with pytest.raises(ValueError, match='cloud: not readable'):
        read_cloud(bytes(message))


def test_a_cloud_without_the_fields_of_a_contact_is_refused_by_name():
    with pytest.raises(ValueError, match=r'fields a, ax0, .* time$'):
        Contacts(bodies(10, 1.0))


def test_contacts_that_are_not_finite_are_refused():
    log = np.zeros(2, CONTACT)
    log['by1'][1] = np.nan
    with pytest.raises(ValueError, match='by1 must be finite'):
        Contacts(CONTACTS.encode(10, log))


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
