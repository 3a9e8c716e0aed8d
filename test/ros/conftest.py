"""The node in a process of its own, and an observer of what it says over real DDS."""

from __future__ import annotations

import json

import pytest
from geometry_msgs.msg import PoseStamped
from observing import NodeProcess, Observer
from sensor_msgs.msg import TimeReference


@pytest.fixture
def observer(domain):
    observer = Observer(domain)
    yield observer
    observer.close()


@pytest.fixture
def launch(domain, tmp_path):
    """Return a function that starts a process of the node; it need not get far."""
    nodes = []

    def launch(*arguments, **options):
        nodes.append(NodeProcess(tmp_path / f'node{len(nodes)}.log', *arguments, **options))
        return nodes[-1]

    yield launch
    for node in nodes:
        if node.process.poll() is None:
            node.process.kill()
            node.wait()
        print(node.log)


@pytest.fixture
def start(launch, observer):
    """Return a function that starts the node and waits until it answers; it must end well, too."""
    nodes = []

    def start(namespace='', arguments=(), program=None, node='/bounce', **parameters):
        options = [
            part for name, value in parameters.items() for part in ('-p', f'{name}:={value}')
        ]
        if namespace:
            options += ['-r', f'__ns:={namespace}']
        choice = {'program': program} if program else {}
        nodes.append(launch(*options, *arguments, **choice))
        observer.wait_for_node(f'{namespace}{node}')
        return nodes[-1]

    yield start
    for node in nodes:
        if node.process.poll() is None:
            assert node.end() == 0
            assert 'Traceback' not in node.log


@pytest.fixture
def write_scene(tmp_path):
    """Return a function that writes a scene file and returns its path."""

    def write_scene(name='own', **content):
        path = tmp_path / f'{name}.yaml'
        path.write_text(json.dumps(content))  # which is YAML as well
        return str(path)

    return write_scene


@pytest.fixture
def lesson(write_scene):
    """Return the path of a scene like the lesson's: green bounces off red in a box."""
    return write_scene(
        'small_lesson',
        circles=[
            {'name': 'green', 'position': [-0.5, 0.1], 'velocity': [3.0, 0.7], 'radius': 0.2},
            {'name': 'red', 'position': [0.4, 0.0], 'radius': 0.3, 'locked': True},
        ],
        walls=[{'box': {'min': [-1.0, -1.0], 'max': [1.0, 1.0]}}],
    )


@pytest.fixture
def green(observer):
    """Return the messages of /green/pose and of /time."""
    return observer.listen(PoseStamped, 'green/pose'), observer.listen(TimeReference, 'time')
