"""The node as a process: how it starts, how it refuses to, how it ends, and what it leaves alone."""

from __future__ import annotations

import contextlib
import re
import signal
import subprocess
import sys
from itertools import pairwise

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped
from observing import REPOSITORY, nanoseconds, scene_times, stamps
from rclpy.exceptions import InvalidTopicNameException
from rclpy.qos import ReliabilityPolicy
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_topic_name import validate_topic_name
from sensor_msgs.msg import PointCloud2, TimeReference

from circle_bounce_ros.installation import child_environment
from circle_bounce_ros.kernel.scene import is_legal_name

LOG_LINE = re.compile(r'\[(\w+)\] \[[\d.]+\] \[[\w.]+\]: (.*)')


@pytest.mark.parametrize('how', [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_and_sigterm_end_it_with_status_0_and_no_traceback(
    start, observer, lesson, green, how
):
    node = start(scene=lesson, rate=1000.0)
    observer.collect(green[1], 10)
    assert node.end(how) == 0
    assert 'Traceback' not in node.log
    assert 'rror' not in node.log


@pytest.mark.parametrize('how', [signal.SIGINT, signal.SIGTERM])
def test_a_second_signal_does_not_disturb_the_end(start, observer, lesson, green, how):
    node = start(scene=lesson, rate=1000.0)
    observer.collect(green[1], 10)
    while node.process.poll() is None:
        node.process.send_signal(how)
        with contextlib.suppress(subprocess.TimeoutExpired):
            node.process.wait(timeout=0.001)
    assert node.wait() == 0
    assert 'Traceback' not in node.log


@pytest.mark.parametrize(
    ('arguments', 'sentence'),
    [
        (['-p', 'scene:=./nothing.yaml'], './nothing.yaml: '),
        (['-p', 'scene:=nothing'], 'scene: must be one of billiard, '),
        (['-p', 'rate:=0.05'], 'rate: must be from 0.1 to 1000.0, got 0.05'),
        (['-p', 'rate:=sixty'], "rate: must be a number, got 'sixty'"),
        (['-p', 'rate:=.nan'], 'rate: must be from 0.1 to 1000.0, got nan'),
        (['-p', 'seed:=5.0'], 'seed: must be a whole number, got 5.0'),
        (['-p', 'qos_overrides./time.publisher.depth:=-1'], 'depth: must be from 0 to'),
        (['-p', 'scene:='], "parameter override rule: '-p scene:='"),
        (['-p', 'time_scale:=0.0'], 'time_scale: must be > 0 without publish_clock, got 0.0'),
        (['-p', "frame_id:=''"], "frame_id: must not be empty, got ''"),
        (
            ['-p', 'publish_clock:=true', '-p', 'use_sim_time:=true'],
            'publish_clock and use_sim_time: must not both be true',
        ),
        (['-p', 'qos_overrides./time.publisher.reliability:=some'], 'qos_overrides of time: '),
        (['-p', 'rate'], "parameter override rule: '-p rate'"),
        (['stray'], "that ROS does not know: ['stray']"),
    ],
    ids=str,
)
def test_what_it_cannot_start_with_is_one_sentence_and_a_status(launch, arguments, sentence):
    node = launch(*arguments)
    assert node.wait() == 1
    lines = [LOG_LINE.fullmatch(line) for line in node.log.splitlines()]
    assert all(lines), node.log  # no traceback, and no block of lines of the C library
    fatal = [line[2] for line in lines if line[1] == 'FATAL']
    assert len(fatal) == 1
    assert sentence in fatal[0]


def test_two_nodes_in_two_namespaces_do_not_disturb_each_other(start, observer, lesson):
    times = {ns: observer.listen(TimeReference, f'{ns}/time') for ns in ('/one', '/two')}
    poses = {ns: observer.listen(PoseStamped, f'{ns}/green/pose') for ns in ('/one', '/two')}
    diagnostics = observer.listen(DiagnosticArray, '/diagnostics')
    start(namespace='/one', scene=lesson)
    start(namespace='/two', scene=lesson)
    for ns in ('/one', '/two'):
        observer.collect(times[ns], 10)
    assert observer.pause(node='/two/bounce').success
    assert observer.reset(node='/two/bounce').success
    assert observer.set(node='/two/bounce', time_scale=7.0).successful
    before = len(times['/one'])
    observer.collect(times['/two'], 20)
    assert {nanoseconds(m.time_ref) for m in times['/two'][-15:]} == {0}
    # The one beside it went on as if it were alone: by what passed on the wall, from its own start.
    one = sorted(scene_times(times['/one']).items())
    assert len(times['/one']) > before
    assert all(0 < b[1] - a[1] == b[0] - a[0] for a, b in pairwise(one) if b[0] - a[0] < 10**8)
    assert all(poses.values())
    observer.spin_until(
        lambda: (
            {m.status[0].name for m in diagnostics}
            == {'/one/bounce: simulation', '/two/bounce: simulation'}
        ),
        'a status of each',
    )


def test_qos_may_be_overridden_for_every_topic(start, observer, lesson):
    topics = ['time', 'poses', 'bodies', 'contacts', 'green/pose', 'green/twist', 'markers']
    override = [
        part
        for topic in topics
        for part in ('-p', f'qos_overrides./{topic}.publisher.reliability:=best_effort')
    ]
    start(scene=lesson, arguments=override)

    def reliability(topic):
        info = observer.spin_until(
            lambda: observer.node.get_publishers_info_by_topic(f'/{topic}'), topic
        )
        return info[0].qos_profile.reliability

    assert {reliability(topic) for topic in topics} == {ReliabilityPolicy.BEST_EFFORT}
    for topic in ('markers/static', 'red/pose', 'diagnostics'):
        assert reliability(topic) == ReliabilityPolicy.RELIABLE


def test_the_parameter_file_that_is_installed_says_the_defaults(start, observer):
    times = observer.listen(TimeReference, 'time')
    file = REPOSITORY / 'config' / 'params.yaml'
    start(namespace='/anywhere', arguments=['--params-file', str(file)])
    times = observer.listen(TimeReference, '/anywhere/time')
    observer.collect(times, 3)
    assert times[0].source == 'lesson'
    assert times[0].header.frame_id == 'world'


def test_contacts_are_recorded_only_while_somebody_subscribes(start, observer, lesson):
    times = observer.listen(TimeReference, 'time')
    start(scene=lesson, time_scale=10.0, rate=100.0)
    observer.collect(times, 100)
    contacts = observer.listen(PointCloud2, 'contacts')
    observer.spin_until(lambda: sum(m.width for m in contacts) > 3, 'contacts')
    known = scene_times(times)
    first = stamps(contacts)[0]
    assert known[first] * 1e-9 > 5.0
    # A tick is 0.1 s of the scene, and in 5 s there have been a dozen contacts.
    assert contacts[0].width < 5


def test_a_restart_is_shown_as_the_last_instant_and_then_the_first(start, observer, write_scene):
    path = write_scene(
        'short',
        circles=[{'position': [0, 0], 'velocity': [1, 0], 'radius': 1}],
        restart_after=0.25,
    )
    times = observer.listen(TimeReference, 'time')
    start(scene=path)
    observer.spin_until(lambda: [nanoseconds(m.time_ref) for m in times].count(0) > 3, 'restarts')
    instants = [nanoseconds(m.time_ref) for m in times]
    for before, after in pairwise(instants):
        assert after > before or (before, after) == (250_000_000, 0)
    assert max(instants) == 250_000_000


NAMES = ['a', 'A', 'a1', 'a_b', 'a_', 'green', 'a_1_b', 'B2', '', '1a', '_a', 'a__b', 'a-b', 'a b']
NAMES += ['ä', 'a.b', 'a/b', '~', 'a{b}', 'a\n', '²', 'a²', 'é', '٣', 'a٣']


@pytest.mark.parametrize('name', NAMES)
def test_a_legal_circle_name_is_a_legal_topic_name(name):
    def is_topic():
        try:
            return validate_topic_name(f'{name}/pose') and validate_full_topic_name(
                f'/{name}/pose'
            )
        except InvalidTopicNameException:
            return False

    if is_legal_name(name):
        assert is_topic()
    elif is_topic():
        # ROS lets these pass, although its rules for names frown on some; we do not.
        assert name in ('_a', 'a__b', 'a/b', '~', 'a{b}')


IN_ITS_PROCESS = """
import gc, rclpy
from circle_bounce_ros.ros.node import BounceNode
rclpy.init(args=['--ros-args', '-p', 'scene:=gas'])
node = BounceNode()
print('frozen', gc.get_freeze_count())
node.destroy_node()
rclpy.try_shutdown()
"""


def test_garbage_collections_pass_over_the_circles_of_the_scene(domain):
    command = [sys.executable, '-c', IN_ITS_PROCESS]
    said = subprocess.check_output(command, env=child_environment(), text=True, timeout=60)
    # Each of the 1,000 circles is an object.
    assert int(re.search(r'frozen (\d+)', said)[1]) > 1_000
