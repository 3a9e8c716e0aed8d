"""Reset, pause, step and parameters do what they say while messages flow."""

from __future__ import annotations

import math
import time
from itertools import pairwise

import pytest
import yaml
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseArray, PoseStamped, TwistStamped
from observing import REPOSITORY, SECOND, nanoseconds, scene_times, stamps
from rcl_interfaces.msg import ParameterType
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    SetParameters,
    SetParametersAtomically,
)
from rclpy.parameter import Parameter
from sensor_msgs.msg import TimeReference
from visualization_msgs.msg import Marker, MarkerArray

from circle_bounce_ros.kernel import Simulation
from circle_bounce_ros.scene_file import load_scene


def instants(time_references):
    return [nanoseconds(message.time_ref) for message in time_references]


def test_reset_starts_the_scene_again_from_its_first_instant_and_says_what(
    start, observer, lesson, green
):
    poses, times = green
    start(scene=lesson)
    observer.collect(times, 30)
    response = observer.reset()
    assert response.success
    assert response.message == (
        "scene 'small_lesson', no seed, 2 circles: starts again from its first instant"
    )
    observer.collect(times, 10)
    scene_ns = instants(times)
    again = scene_ns.index(0, 1)
    assert scene_ns[again - 1] > 0
    # Nothing but the first instant is shown twice, and then it goes on as at the start.
    assert 0 < scene_ns[again + 1] <= SECOND // 10
    assert 0 in instants(times[again:])
    first = next(m for m in poses if nanoseconds(m.header.stamp) == stamps(times)[again])
    assert (first.pose.position.x, first.pose.position.y) == (-0.5, 0.1)


def test_a_paused_scene_stands_still_while_stamps_and_messages_go_on(
    start, observer, lesson, green
):
    poses, times = green
    twists = observer.listen(TwistStamped, 'green/twist')
    start(scene=lesson)
    observer.collect(times, 10)
    response = observer.pause()
    assert (response.success, response.message) == (True, 'paused')
    observer.collect(times, 3)  # what was under way
    still = observer.collect(times, 20)
    assert len(set(instants(still))) == 1
    assert stamps(still) == sorted(set(stamps(still)))
    known = set(stamps(still))
    assert len({str(m.pose) for m in poses if nanoseconds(m.header.stamp) in known}) == 1
    velocities = {str(m.twist) for m in twists if nanoseconds(m.header.stamp) in known}
    assert len(velocities) == 1
    assert velocities == {str(twists[-1].twist)}
    assert math.hypot(twists[-1].twist.linear.x, twists[-1].twist.linear.y) > 3.0

    assert observer.pause(False).message == 'running'
    on = observer.collect(times, 20)
    # It goes on from where it stood, a period or a late tick at a time.
    assert 0 <= instants(on)[0] - instants(still)[0] <= SECOND // 10
    assert instants(on)[-1] > instants(still)[0]


@pytest.mark.parametrize('publish_clock', ['false', 'true'])
def test_steps_are_exact_and_only_for_a_paused_scene(
    start, observer, lesson, green, publish_clock
):
    _, times = green
    start(scene=lesson, rate=60.0, publish_clock=publish_clock)
    observer.collect(times, 5)
    refused = observer.step()
    assert not refused.success
    assert refused.message == 'not paused: only a paused scene goes step by step'
    observer.pause()
    observer.reset()
    for k in range(1, 8):
        response = observer.step()
        expected = k * SECOND // 60
        assert (response.success, response.message) == (
            True,
            f'scene time {expected / SECOND:.9f} s',
        )
        observer.spin_until(lambda: instants(times)[-1] == expected, 'the step is shown')  # noqa: B023
    observer.collect(times, 10)
    assert instants(times)[-1] == 7 * SECOND // 60


def test_a_reset_keeps_a_pause_and_a_node_may_start_paused(start, observer, lesson, green):
    _, times = green
    start(scene=lesson, start_paused='true')
    assert set(instants(observer.collect(times, 10))) == {0}
    observer.step()
    observer.spin_until(lambda: instants(times)[-1] > 0, 'the step is shown')
    observer.reset()
    observer.spin_until(lambda: instants(times)[-1] == 0, 'the first instant is shown')
    assert set(instants(observer.collect(times, 10))) == {0}


def test_a_change_of_time_scale_or_rate_changes_the_speed_and_never_the_state(
    start, observer, lesson, green
):
    _, times = green
    start(scene=lesson, rate=50.0)
    for change in ({'time_scale': 20.0}, {'rate': 200.0}, {'time_scale': 0.01}, {'rate': 50.0}):
        observer.collect(times, 20)
        assert observer.set(**change).successful
    observer.collect(times, 20)
    shown = sorted(scene_times(times).items())
    fastest = 0.0
    for (stamp, scene_ns), (next_stamp, next_scene_ns) in pairwise(shown):
        speed = (next_scene_ns - scene_ns) / (next_stamp - stamp)
        assert 0.0 <= speed <= 20.0 + 1e-6  # a nanosecond of rounding in a tick of milliseconds
        fastest = max(fastest, speed)
    assert fastest == pytest.approx(20.0, rel=1e-6)
    (stamp, scene_ns), (last_stamp, last_scene_ns) = shown[-15], shown[-1]
    assert (last_scene_ns - scene_ns) / (last_stamp - stamp) == pytest.approx(0.01, rel=1e-6)


def test_scene_and_seed_are_swapped_together_while_messages_flow(
    start, observer, lesson, write_scene, green
):
    gas = {
        'groups': [
            {'count': 5, 'radius': 0.1, 'speed': 1.0, 'region': {'min': [-1, -1], 'max': [1, 1]}}
        ],
        'walls': [{'box': {'min': [-1, -1], 'max': [1, 1]}}],
        'seed': 3,
    }
    path = write_scene('gas_of_five', **gas)
    _, times = green
    arrays = observer.listen(PoseArray, 'poses')
    start(scene=lesson)
    observer.collect(times, 10)

    def starts():
        return [m for m in times if nanoseconds(m.time_ref) == 0]

    for change, scene, seed in (
        ({'scene': path, 'seed': 7}, path, 7),
        ({'seed': 8}, path, 8),
        ({'seed': -1}, path, 3),
        ({'scene': 'lesson'}, 'lesson', None),
    ):
        count = len(starts())
        assert observer.set_together(**change).successful
        first = observer.spin_until(lambda: starts()[count:], 'the new scene')[0]  # noqa: B023
        stamp = first.header.stamp
        observer.spin_until(lambda: arrays[-1].header.stamp == stamp, 'its poses')  # noqa: B023
        expected = Simulation(load_scene(scene, seed=seed))
        assert first.source == expected.scene.name
        positions = [(pose.position.x, pose.position.y) for pose in arrays[-1].poses]
        assert positions == [tuple(position) for position in expected.positions]
    assert len(starts()) <= 5  # each change loads once: at most these four, and the first start


def test_topics_of_named_circles_come_and_go_with_the_scene(start, observer, lesson, write_scene):
    other = write_scene(
        'other', circles=[{'name': 'blue', 'position': [0, 0], 'velocity': [1, 0], 'radius': 1}]
    )
    start(scene=lesson)

    def names():
        return {name for name, _ in observer.node.get_topic_names_and_types()}

    of_lesson = {'/green/pose', '/green/twist', '/red/pose'}
    observer.spin_until(lambda: of_lesson <= names(), 'topics of the first scene')
    assert '/red/twist' not in names()
    observer.set(scene=other)
    observer.spin_until(lambda: {'/blue/pose', '/blue/twist'} <= names(), 'topics of the second')
    observer.spin_until(lambda: not of_lesson & names(), 'that the first are gone')
    blue = observer.listen(PoseStamped, 'blue/pose')
    observer.set(scene=lesson)
    observer.set(scene=other)
    observer.collect(blue, 3)


def test_markers_begin_with_deleteall_after_a_change_of_scene(
    start, observer, lesson, write_scene
):
    many = write_scene(
        'many_radii',
        circles=[{'position': [k, 0], 'radius': 0.1 + 0.001 * k} for k in range(65)],
    )
    moving = observer.listen(MarkerArray, 'markers')
    static = observer.listen(MarkerArray, 'markers/static', latched=True)
    times = observer.listen(TimeReference, 'time')
    node = start(scene=lesson)
    observer.collect(moving, 5)
    assert moving[0].markers[0].action == Marker.DELETEALL
    assert all(m.markers[0].action == Marker.ADD for m in moving[1:])

    observer.set(scene='lesson')
    observer.spin_until(lambda: moving[-1].markers[0].action == Marker.DELETEALL, 'DELETEALL')
    observer.spin_until(lambda: len(static) == 2, 'new static markers')
    assert [m.markers[0].action for m in static] == [Marker.DELETEALL] * 2
    observer.collect(moving, 3)
    assert moving[-1].markers[0].action == Marker.ADD

    observer.set(scene=many)
    observer.spin_until(lambda: times and times[-1].source == 'many_radii', 'the new scene')
    observer.collect(times, 10)
    assert [marker.action for marker in moving[-1].markers] == [Marker.DELETEALL]
    assert node.log.count('markers: none for scene') == 1
    observer.set(scene=lesson)
    observer.spin_until(lambda: moving[-1].markers[0].action == Marker.ADD, 'markers again')


REFUSED = [
    ({'rate': 0.0}, 'rate: must be from 0.1 to 1000.0, got 0.0'),
    ({'rate': 1000.1}, 'rate: must be from'),
    ({'rate': 10**15}, 'rate: must be from'),
    ({'rate': math.nan}, 'rate: must be from'),
    ({'rate': '60'}, "rate: must be a number, got '60'"),
    ({'rate': True}, 'rate: must be a number'),
    ({'rate': [60.0]}, 'rate: must be a number'),
    ({'scene': 5}, 'scene: must be text'),
    ({'seed': 5.0}, 'seed: must be a whole number'),
    ({'time_scale': -1.0}, 'time_scale: must be from'),
    ({'time_scale': 0.0}, 'time_scale: must be > 0 without publish_clock, got 0.0'),
    ({'time_scale': math.inf}, 'time_scale: must be from'),
    ({'seed': -2}, 'seed: must be from -1 to'),
    ({'publish_clock': True}, 'publish_clock: can only be given at the start'),
    ({'frame_id': 'map'}, 'frame_id: can only be given at the start'),
    ({'start_paused': True}, 'start_paused: can only be given at the start'),
    ({'no_such_parameter': 1}, 'no_such_parameter'),
    ({'scene': 'no_such_scene'}, 'must be one of billiard, break, '),
    ({'scene': './no_such_file.yaml'}, './no_such_file.yaml: '),
    ({'scene': 'lesson', 'seed': -2}, 'seed: must be from -1 to'),
    ({'rate': 10.0, 'scene': 'no_such_scene'}, 'must be one of billiard, break, '),
]


def test_a_value_out_of_range_and_a_bad_scene_are_refused_and_all_goes_on(
    start, observer, lesson, write_scene
):
    bad = write_scene('bad', circles=[{'position': [0, 0], 'radius': -0.1}])
    times = observer.listen(TimeReference, 'time')
    start(scene=lesson)
    observer.collect(times, 3)
    for values, reason in (
        *REFUSED,
        ({'scene': bad}, 'circles[0].radius: must be > 0 m, got -0.1'),
    ):
        result = observer.set_together(**values)
        assert not result.successful, values
        assert reason in result.reason, values
        assert '\n' not in result.reason
    observer.collect(times, 3)
    assert {m.source for m in times} == {'small_lesson'}
    assert instants(times) == sorted(instants(times))  # it was never reset
    request = GetParameters.Request(names=['scene', 'rate', 'seed', 'time_scale'])
    scene, rate, seed, time_scale = observer.call(
        GetParameters, '/bounce/get_parameters', request
    ).values
    assert (scene.string_value, rate.double_value) == (lesson, 60.0)
    assert (seed.integer_value, time_scale.double_value) == (-1, 1.0)


def test_whole_numbers_are_numbers_at_the_start_and_later(start, observer, lesson):
    start(scene=lesson, rate=50, time_scale=2)
    request = GetParameters.Request(names=['rate', 'time_scale'])

    def values():
        got = observer.call(GetParameters, '/bounce/get_parameters', request).values
        assert [v.type for v in got] == [ParameterType.PARAMETER_DOUBLE] * 2
        return [v.double_value for v in got]

    assert values() == [50.0, 2.0]
    assert observer.set(time_scale=3).successful
    assert observer.set_together(rate=20, time_scale=4).successful
    assert values() == [20.0, 4.0]


def test_a_file_with_all_parameters_starts_the_scene_once_and_nothing_of_it_fails(start, observer):
    """As `ros2 param load` does: one call with every value of the file."""
    node = start()
    file = yaml.safe_load((REPOSITORY / 'config' / 'params.yaml').read_text())
    values = file['/**']['ros__parameters']
    assert {'scene', 'seed', 'start_paused', 'frame_id'} <= values.keys()
    messages = [Parameter(name, value=value).to_parameter_msg() for name, value in values.items()]
    response = observer.call(
        SetParameters, '/bounce/set_parameters', SetParameters.Request(parameters=messages)
    )
    assert [r.reason for r in response.results] == [''] * len(values)
    assert all(r.successful for r in response.results)
    assert observer.set_together(**values).successful
    # At the start, and once for each of the two calls.
    assert node.log.count("scene 'lesson'") == 3


def test_a_value_of_no_type_that_there_is_is_refused_and_the_node_goes_on(start, observer, lesson):
    start(scene=lesson)
    message = Parameter('rate', value=1.0).to_parameter_msg()
    message.value.type = 200
    response = observer.call(
        SetParameters, '/bounce/set_parameters', SetParameters.Request(parameters=[message])
    )
    assert not response.results[0].successful
    request = SetParametersAtomically.Request(parameters=[message])
    atomically = '/bounce/set_parameters_atomically'
    assert not observer.call(SetParametersAtomically, atomically, request).result.successful
    assert observer.reset().success


def test_every_parameter_has_a_description_with_its_unit_and_numbers_have_a_range(
    start, observer, lesson
):
    start(scene=lesson)
    names = ['scene', 'seed', 'rate', 'time_scale', 'start_paused', 'publish_clock', 'frame_id']
    request = DescribeParameters.Request(names=names)
    response = observer.call(DescribeParameters, '/bounce/describe_parameters', request)
    described = {d.name: d for d in response.descriptors}
    assert list(described) == names
    assert all(len(d.description) > 30 for d in described.values())
    assert 'Hz' in described['rate'].description
    assert 's/s' in described['time_scale'].description
    assert {n for n, d in described.items() if d.read_only} == set(names[-3:])
    ranges = {n: d.floating_point_range[0] for n, d in described.items() if d.floating_point_range}
    assert {n: (r.from_value, r.to_value) for n, r in ranges.items()} == {
        'rate': (0.1, 1000.0),
        'time_scale': (0.0, 1000.0),
    }
    assert described['seed'].integer_range[0].from_value == -1
    assert described['seed'].type == ParameterType.PARAMETER_INTEGER


def values_of(message):
    return {value.key: value.value for value in message.status[0].values}


def test_diagnostics_come_every_second_and_at_once_on_a_change(start, observer, lesson):
    diagnostics = observer.listen(DiagnosticArray, '/diagnostics')
    start(scene=lesson, rate=100.0, time_scale=2.0)
    observer.spin_until(
        lambda: diagnostics and values_of(diagnostics[-1])['real-time factor'] != 'nan',
        'a measurement',
    )
    status = diagnostics[-1].status[0]
    assert status.name == '/bounce: simulation'
    values = values_of(diagnostics[-1])
    assert float(values['real-time factor']) == pytest.approx(2.0, rel=0.02)
    assert int(values['late ticks']) >= 0
    assert float(values['contacts/s']) > 0.0
    assert abs(float(values['energy error'])) < 1e-12
    assert [values[key] for key in ('paused', 'scene', 'seed', 'time_scale')] == [
        'false',
        'small_lesson',
        'none',
        '2.0',
    ]
    first, second = diagnostics[-1], observer.collect(diagnostics, 1)[0]
    apart = nanoseconds(second.header.stamp) - nanoseconds(first.header.stamp)
    assert 0.5 * SECOND < apart < 1.5 * SECOND

    # A scene of many contacts a second gives way to one of few: what is counted must not go back.
    observer.set(scene='gas')
    observer.spin_until(
        lambda: float(values_of(diagnostics[-1])['contacts/s']) > 1_000.0, 'the contacts of a gas'
    )
    observer.set(scene=str(lesson))
    assert all(float(values_of(m)['contacts/s']) >= 0.0 for m in observer.collect(diagnostics, 4))

    for change, key, value in (
        (observer.pause, 'paused', 'true'),
        (lambda: observer.set(time_scale=3.0), 'time_scale', '3.0'),
        (lambda: observer.set_together(scene='mixed', seed=5), 'seed', '5'),
    ):
        # Right after one of those that come every second, the next of them is most of a second away.
        observer.collect(diagnostics, 1)
        before = len(diagnostics)
        change()
        asked = time.monotonic()
        observer.spin_until(
            lambda: [m for m in diagnostics[before:] if values_of(m)[key] == value],  # noqa: B023
            f'{key} {value}',
        )
        assert time.monotonic() - asked < 0.5
