"""The README says what the node is like, and its subscriber works as written."""

from __future__ import annotations

import doctest
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from observing import PATIENCE, REPOSITORY
from rclpy.node import NodeNameNonExistentError

from circle_bounce_ros.ros.parameters import PARAMETERS
from circle_bounce_ros.scene_file import load_scene, scene_names

README = (REPOSITORY / 'README.md').read_text()


def section(title):
    return re.search(rf'^## {title}\n(.*?)(?=^## |\Z)', README, re.MULTILINE | re.DOTALL)[1]


def blocks(language):
    return re.findall(rf'^```{language}\n(.*?)^```$', README, re.MULTILINE | re.DOTALL)


def first_columns(title):
    """Return the first two cells of each row of the first table of a section."""
    return re.findall(r'^\| `([^|]*)`[^|]* \| ([^|]*) \|', section(title), re.MULTILINE)


def test_the_subscriber_of_the_readme_sees_the_green_circle(start, tmp_path):
    (source,) = blocks('python')
    script = tmp_path / 'listener.py'
    script.write_text(source)
    start()
    command = [sys.executable, '-u', str(script)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as listener:
        lines = [listener.stdout.readline() for _ in range(30)]
        listener.kill()
        listener.wait(PATIENCE)
    places = [tuple(map(float, line.split())) for line in lines]
    # The lesson's box, less the radius of 0.2 m; three digits are printed.
    assert all(abs(x) <= 1.8005 and abs(y) <= 1.3005 for x, y in places)
    assert len(set(places)) > 20


def test_the_table_of_parameters_is_the_nodes():
    documented = {
        name: yaml.safe_load(default.strip('` ')) for name, default in first_columns('Parameters')
    }
    declared = {row.name: row.default for row in PARAMETERS}
    assert documented == declared | {'use_sim_time': False}
    for name, limits in ((row.name, row.limits) for row in PARAMETERS if row.limits):
        (line,) = re.findall(rf'^\| `{name}` \|.*', section('Parameters'), re.MULTILINE)
        least, most = f'{limits[0]:g}', f'{limits[1]:g}' if limits[1] < 1e6 else '2^63 - 1'
        assert f'| {least} to {most} |' in line


def test_the_table_of_topics_and_services_is_the_nodes(start, observer, domain):
    start(publish_clock=True)
    topics = dict(first_columns('Topics'))
    services = dict(first_columns('Services'))

    def offered(what, least):
        """Return what the node offers once that much of it has been discovered."""
        try:
            names = dict(what('bounce', '/'))
        except NodeNameNonExistentError:
            return None
        return names if len(names) >= least else None

    own = {'/rosout', '/parameter_events'}
    expected = {}
    for name, kind in topics.items():
        package, message = kind.split('/')
        for circle in ('green', 'red') if '<circle>' in name else ('',):
            if (circle, name) != ('red', '<circle>/twist'):
                topic = '/' + name.replace('<circle>', circle).lstrip('/')
                expected[topic] = [f'{package}/msg/{message}']
    publishers = observer.node.get_publisher_names_and_types_by_node
    there = observer.spin_until(
        lambda: offered(publishers, len(expected) + len(own)), 'all topics of the table'
    )
    assert {name: kinds for name, kinds in there.items() if name not in own} == expected
    servers = observer.node.get_service_names_and_types_by_node
    # Those of its parameters come on top.
    offered_services = observer.spin_until(
        lambda: offered(servers, len(services) + 6), 'all services of the table'
    )
    for name, kind in services.items():
        package, service = kind.split('/')
        assert offered_services[name] == [f'{package}/srv/{service}']


def test_the_table_of_scenes_is_whole():
    assert {name for name, _ in first_columns('Scenes')} >= set(scene_names())


@pytest.mark.parametrize('text', blocks('yaml'))
def test_the_scene_of_the_readme_is_one(text, tmp_path):
    path = tmp_path / 'readme.yaml'
    path.write_text(text)
    assert len(load_scene(str(path)).circles) > 2


def test_the_session_of_the_readme_gives_what_it_says():
    (session,) = blocks('pycon')
    example = doctest.DocTestParser().get_doctest(session, {}, 'README', 'README.md', 0)
    assert doctest.DocTestRunner(verbose=False).run(example) == (0, len(example.examples))


def test_the_make_commands_of_the_readme_exist():
    makefile = (REPOSITORY / 'Makefile').read_text()
    rules = re.findall(r'^([a-z][a-z -]*):', makefile, re.MULTILINE)
    targets = {target for rule in rules for target in rule.split()}
    wanted = set(re.findall(r'(?:^    |`)make ([a-z][a-z-]*)', README, re.MULTILINE))
    assert wanted >= {'run', 'test', 'listen', 'reset'}
    assert wanted <= targets


def test_the_files_that_the_readme_links_exist():
    links = re.findall(r'\]\(([^)#]+)\)', README)
    assert len(links) > 5
    for link in links:
        assert link.startswith('http') or (REPOSITORY / link).exists(), link
    for name in re.findall(r'`(test_\w+\.py|test/[\w/.]+)`', README):
        found = list(Path(REPOSITORY / 'test').rglob(Path(name).name))
        assert found, name
