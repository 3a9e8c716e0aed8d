"""The real viewer, fed by the real node over DDS, and what a test needs to look at it."""

import sys
from pathlib import Path

import pytest

# The observer of the node's tests serves here too.
sys.path.insert(0, str(Path(__file__).parents[1] / 'ros'))

from observing import NodeProcess, Observer
from viewing import VIEWER, Stage, address_of, end_all


@pytest.fixture(scope='module')
def stage(domain, tmp_path_factory):
    stage = Stage(tmp_path_factory.mktemp('stage'))
    stage.start_node()
    stage.start_viewer()
    yield stage
    stage.end()


@pytest.fixture(scope='module')
def lone_viewer(domain, tmp_path_factory):
    """Return the address of a viewer in a namespace where there is no node."""
    log = tmp_path_factory.mktemp('lone') / 'log'
    viewer = NodeProcess(log, '-p', 'port:=0', '-r', '__ns:=/alone', program=VIEWER)
    try:
        yield address_of(viewer)
    finally:
        end_all([viewer])


@pytest.fixture(scope='module')
def shared_observer(domain):
    observer = Observer(domain)
    yield observer
    observer.close()


@pytest.fixture
def observer(shared_observer):
    """Return an observer that knows the services already, and that hears nothing yet."""
    yield shared_observer
    for subscription in list(shared_observer.node.subscriptions):
        shared_observer.node.destroy_subscription(subscription)


@pytest.fixture
def play(stage, observer):
    """Return a function that makes the shared node show a scene from its first instant."""

    def play(scene='lesson', paused=False):
        observer.wait_for_node()
        assert observer.set_together(scene=str(scene), seed=-1).successful
        assert observer.set(time_scale=1.0).successful
        observer.pause(paused)
        observer.reset()

    return play


@pytest.fixture
def many(tmp_path):
    """Return the path of a scene of 10,000 circles that pass through each other: cheap for any engine."""
    path = tmp_path / 'many.yaml'
    path.write_text(
        'moving_circles_collide: false\n'
        'groups:\n'
        '  - {count: 10000, radius: 0.01, speed: {maxwell: 0.02}, region: {min: [-3, -2], max: [3, 2]}}\n'
        'walls:\n  - box: {min: [-3, -2], max: [3, 2]}\n'
    )
    return path
