"""The parameters seen from inside: what is loaded when."""

from __future__ import annotations

import pytest
import rclpy
from rclpy.context import Context
from rclpy.parameter import Parameter

from circle_bounce_ros.base_node import BaseNode
from circle_bounce_ros.kernel import SceneError
from circle_bounce_ros.ros import parameters
from circle_bounce_ros.ros.main import PARAMETERS


@pytest.fixture
def loads(monkeypatch):
    """Return the list of what has been loaded."""
    loads = []
    load_scene = parameters.load_scene

    def load(scene, seed=None):
        loads.append((scene, seed))
        return load_scene(scene, seed)

    monkeypatch.setattr(parameters, 'load_scene', load)
    return loads


@pytest.fixture
def make_node(domain):
    """Return a function that makes a node with the parameters, of which some are given at the start."""
    context = Context()
    rclpy.init(context=context, domain_id=domain)
    nodes = []

    def make_node(**given):
        overrides = [Parameter(name, value=value) for name, value in given.items()]
        options = {'always_set': ['scene'], 'context': context, 'parameter_overrides': overrides}
        nodes.append(BaseNode('holder', PARAMETERS, **options))
        return nodes[-1]

    yield make_node
    for node in nodes:
        node.destroy_node()
    context.try_shutdown()


@pytest.fixture
def node(make_node):
    return make_node()


def test_scene_and_seed_together_are_loaded_once_and_told_once(node, loads):
    changes = []
    holder = parameters.Parameters(node, changes.append)
    assert (loads, changes) == ([('lesson', None)], [])
    both = [Parameter('scene', value='mixed'), Parameter('seed', value=5)]
    assert node.set_parameters_atomically(both).successful
    assert loads[1:] == [('mixed', 5)]
    assert changes == [{'scene', 'seed'}]
    assert (holder.scene.name, holder.scene.seed) == ('mixed', 5)


def test_a_check_changes_nothing(node, loads):
    changes = []
    holder = parameters.Parameters(node, changes.append)
    refuse = [Parameter('scene', value='gas'), Parameter('time_scale', value=0.0)]
    assert not node.set_parameters_atomically(refuse).successful
    # Refused by somebody else, after our own check has loaded it.
    no = rclpy.node.SetParametersResult(successful=False, reason='no')
    node._on_set_parameters_callbacks.append(lambda _: no)
    assert not node.set_parameters_atomically([Parameter('scene', value='gas')]).successful
    assert changes == []
    assert (holder.scene.name, holder['scene']) == ('lesson', 'lesson')


def test_a_bad_scene_at_the_start_is_an_error(make_node):
    node = make_node(scene='nothing')
    with pytest.raises(SceneError, match='scene: must be one of billiard, '):
        parameters.Parameters(node, lambda _: None)
