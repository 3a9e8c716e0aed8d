"""What the publishers build for whom, seen from inside."""

from __future__ import annotations

import pytest

from circle_bounce_ros.encoding.topics import Moment, State
from circle_bounce_ros.kernel import Simulation
from circle_bounce_ros.ros.publishers import Publishers
from circle_bounce_ros.scene_file import load_scene


class FakePublisher:
    """A publisher with so many subscribers."""

    def __init__(self, subscribers):
        self.subscribers = subscribers
        self.published = []

    def get_subscription_count(self):
        return self.subscribers

    def publish(self, message):
        self.published.append(message)


class FakeNode:
    """As much of a node as publishers need."""

    def __init__(self):
        self.publishers = {}
        self.listeners = set()

    def create_publisher(self, kind, name, qos, **options):
        self.publishers[name] = FakePublisher(name in self.listeners)
        return self.publishers[name]

    def destroy_publisher(self, publisher):
        name = next(name for name, p in self.publishers.items() if p is publisher)
        del self.publishers[name]


class UnreadableState:
    """A state that nobody may ask for."""

    def __getattr__(self, name):
        pytest.fail(f'{name} was read from the kernel')


class CountingSimulation:
    """A simulation that counts how often its state is read."""

    def __init__(self, scene):
        self._simulation = Simulation(scene)
        self.reads = []

    def __getattr__(self, name):
        self.reads.append(name)
        return getattr(self._simulation, name)


def test_for_a_topic_without_subscribers_nothing_is_read_and_nothing_is_built():
    node = FakeNode()
    publishers = Publishers(node, 'world', publish_clock=True)
    publishers.show(load_scene('lesson'))
    for stamp_ns in range(1, 10):
        publishers.publish(Moment(stamp_ns, 0, UnreadableState()))
    said = {name: len(p.published) for name, p in node.publishers.items() if p.published}
    assert said == {'markers/static': 1, 'red/pose': 1}  # for those who come late


def test_the_state_is_read_once_a_tick_for_all_topics_together():
    node = FakeNode()
    scene = load_scene('gas')
    node.listeners = {'poses', 'bodies', 'markers', 'contacts', 'time'}
    publishers = Publishers(node, 'world', publish_clock=False)
    publishers.show(scene)
    simulation = CountingSimulation(scene)
    publishers.publish(Moment(1, 0, State(simulation)))
    assert sorted(simulation.reads) == ['drain_contacts', 'positions', 'velocities']
    assert {n for n, p in node.publishers.items() if p.published} >= node.listeners


def test_topics_that_two_scenes_share_keep_their_publishers():
    node = FakeNode()
    publishers = Publishers(node, 'world', publish_clock=False)
    publishers.show(load_scene('lesson'))
    before = dict(node.publishers)
    publishers.show(load_scene('lesson'))
    assert node.publishers == before
    publishers.show(load_scene('billiard'))
    assert {'green/pose', 'green/twist', 'red/pose'}.isdisjoint(node.publishers)
    assert all(node.publishers[name] is before[name] for name in ('poses', 'markers/static'))
