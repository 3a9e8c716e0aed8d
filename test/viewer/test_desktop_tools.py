"""RViz's layout and what the documents say of other tools fit what the node really publishes."""

import ast
import re

import pytest
import yaml
from observing import REPOSITORY
from rclpy.qos import (
    DurabilityPolicy,
    LivelinessPolicy,
    QoSCompatibility,
    QoSProfile,
    ReliabilityPolicy,
    qos_check_compatible,
)
from visualization_msgs.msg import Marker, MarkerArray

LAYOUT = yaml.safe_load((REPOSITORY / 'config/bounce.rviz').read_text())['Visualization Manager']
DISPLAYS = {display['Name']: display for display in LAYOUT['Displays'] if 'Topic' in display}
TYPES = {
    'rviz_default_plugins/MarkerArray': 'visualization_msgs/msg/MarkerArray',
    'rviz_default_plugins/PointCloud2': 'sensor_msgs/msg/PointCloud2',
}


@pytest.mark.parametrize('name', DISPLAYS)
def test_a_display_of_the_rviz_layout_gets_what_the_node_publishes(stage, observer, name):
    display = DISPLAYS[name]
    topic = display['Topic']
    # Relative, so that it follows the namespace that RViz is started in.
    assert not topic['Value'].startswith('/')
    full = f'/{topic["Value"]}'
    observer.spin_until(lambda: observer.node.get_publishers_info_by_topic(full), full)
    (publisher,) = observer.node.get_publishers_info_by_topic(full)
    assert publisher.topic_type == TYPES[display['Class']]
    wanted = QoSProfile(
        depth=topic['Depth'],
        reliability=ReliabilityPolicy[topic['Reliability Policy'].upper().replace(' ', '_')],
        durability=DurabilityPolicy[topic['Durability Policy'].upper().replace(' ', '_')],
        liveliness=LivelinessPolicy.AUTOMATIC,
    )
    verdict, why = qos_check_compatible(publisher.qos_profile, wanted)
    assert verdict == QoSCompatibility.OK, why
    # What was said before RViz started is heard by a display that asks for it.
    assert wanted.durability == publisher.qos_profile.durability


def test_the_rviz_layouts_frame_is_that_of_the_messages(play, stage, observer):
    play()
    heard = observer.listen(MarkerArray, 'markers/static', latched=True)
    (message,) = observer.collect(heard, 1)
    assert {marker.header.frame_id for marker in message.markers} == {
        LAYOUT['Global Options']['Fixed Frame']
    }


def test_the_markers_of_10_000_equal_circles_are_one_list_marker(play, stage, observer, many):
    play(many)
    heard = observer.listen(MarkerArray, 'markers')

    def lists():
        drawn = [m for m in heard[-1].markers if m.action == Marker.ADD] if heard else []
        return drawn if sum(len(marker.points) for marker in drawn) == 10000 else None

    (marker,) = observer.spin_until(lists, 'markers of 10,000 circles')
    assert marker.type == Marker.SPHERE_LIST


def test_the_readme_lists_the_arguments_of_the_launch_file():
    launch = ast.parse((REPOSITORY / 'launch/bounce.launch.py').read_text())
    declared = {
        call.args[0].value
        for call in ast.walk(launch)
        if isinstance(call, ast.Call) and getattr(call.func, 'id', '') == 'argument'
    }
    readme = (REPOSITORY / 'README.md').read_text()
    (row,) = re.findall(r'^\| arguments of the launch file \|(.*)\|$', readme, re.MULTILINE)
    assert set(re.findall(r'`(\w+)`', row)) == declared


@pytest.mark.parametrize('document', ['README.md', 'docs/viewer.md'])
def test_topics_named_for_foxglove_and_plotjuggler_are_published(play, observer, document):
    play()
    text = (REPOSITORY / document).read_text()
    sections = re.findall(
        r'^(?:\| |\*\*)(?:Foxglove|PlotJuggler).*?(?=\n\n|\n\| |\Z)',
        text,
        re.MULTILINE | re.DOTALL,
    )
    assert len(sections) == 2
    # A topic, or with dots or behind it a field of its messages.
    words = re.findall(r'`(/[\w/]+|markers\S*|contacts)[\w.]*`', ' '.join(sections))
    named = {'/' + word.strip('/') for word in words}
    assert len(named) >= 5

    def missing():
        return named - {name for name, _ in observer.node.get_topic_names_and_types()}

    observer.spin_until(lambda: not missing(), f'all of {named}')
