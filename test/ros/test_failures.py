"""What ends a node and what does not: contacts without end, failures, signals at the start, wrong arguments."""

from __future__ import annotations

import math
import signal
import subprocess
import sys
from contextlib import suppress
from importlib import import_module
from pathlib import Path

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from observing import PATIENCE, SECOND, nanoseconds
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import TimeReference

from circle_bounce_ros.base_node import BaseExecutor, BaseNode
from circle_bounce_ros.installation import child_environment

# A ball rests in a slot that fits it exactly. Another one hits it, off its middle: from then on it is thrown from
# wall to wall without end.
HIT = {
    'circles': [
        {'position': [-3.0, 0.1], 'velocity': [2.0, 0], 'radius': 0.3},
        {'name': 'stuck', 'position': [0, 0], 'radius': 0.5},
    ],
    'walls': [{'start': [-5, -0.5], 'end': [5, -0.5]}, {'start': [-5, 0.5], 'end': [5, 0.5]}],
}
HIT_AT = (3.0 - math.sqrt(0.8**2 - 0.1**2)) / 2.0  # s
FAULTY_NODE = (str(Path(__file__).with_name('faulty_node.py')),)

AT_ONCE = {
    'circles': [{'name': 'stuck', 'position': [0, 0], 'velocity': [0, 1], 'radius': 1}],
    'walls': [{'start': [-5, -1], 'end': [5, -1]}, {'start': [-5, 1], 'end': [5, 1]}],
}


def instants(times):
    return [nanoseconds(m.time_ref) for m in times]


@pytest.fixture
def reports(observer):
    return observer.listen(DiagnosticArray, '/diagnostics')


def wait_for_error(observer, reports):
    """Wait for the report of an error that is newer than the last report; return its status."""
    before = len(reports)
    return observer.spin_until(
        lambda: [
            m.status[0] for m in reports[before:] if m.status[0].level == DiagnosticStatus.ERROR
        ],
        'a report of the failure',
    )[-1]


@pytest.mark.parametrize('publish_clock', [False, True])
def test_contacts_without_end_pause_the_node_until_a_reset_or_another_scene(
    start, observer, reports, write_scene, lesson, publish_clock
):
    times = observer.listen(TimeReference, 'time')
    node = start(scene=write_scene('slot', **AT_ONCE), publish_clock=publish_clock)
    status = wait_for_error(observer, reports)
    assert status.message.startswith('circles[0] (stuck): contacts without end')
    assert {v.value for v in status.values if v.key == 'paused'} == {'true'}
    # Stamps go on, scene time does not; nothing but a way out is accepted.
    shown = observer.collect(times, 5)
    assert set(instants(shown)) == {0}
    assert len({nanoseconds(m.header.stamp) for m in shown}) == 5
    for answer in (observer.step(), observer.pause(False)):
        assert not answer.success
        assert 'contacts without end' in answer.message
    assert observer.pause(True).success
    assert observer.reset().success
    assert wait_for_error(observer, reports).message.startswith('circles[0] (stuck)')
    assert observer.set(scene=lesson).successful
    assert observer.pause(False).success
    observer.spin_until(lambda: instants(times)[-1] > SECOND // 2, 'the other scene going on')
    assert node.log.count('contacts without end') == 2
    assert 'Traceback' not in node.log


def test_a_failure_on_the_way_stands_at_its_instant_and_after_a_reset_comes_again(
    start, observer, reports, write_scene
):
    times = observer.listen(TimeReference, 'time')
    start(scene=write_scene('hit', **HIT), time_scale=4)
    for _ in range(2):
        assert wait_for_error(observer, reports).message.startswith('circles[1] (stuck)')
        shown = observer.collect(times, 3)[1:]
        # Contacts without end are told a few roundings after the instant of the first.
        assert [abs(instant - HIT_AT * SECOND) < 10 for instant in instants(shown)] == [True] * 2
        before = len(times)
        assert observer.reset().success
        observer.spin_until(
            lambda before=before: 0 in instants(times[before:]), 'the first instant'
        )


@pytest.mark.parametrize(('rate', 'publish_clock'), [(60.0, False), (1000.0, False), (60.0, True)])
def test_a_fault_in_a_tick_pauses_the_node_which_goes_on_after_a_reset(
    start, observer, reports, lesson, tmp_path, monkeypatch, rate, publish_clock
):
    """Ticks at 1,000 Hz come from a thread of their own."""
    fault = tmp_path / 'fault'
    monkeypatch.setenv('FAULT', str(fault))
    times = observer.listen(TimeReference, 'time')
    node = start(program=FAULTY_NODE, scene=lesson, rate=rate, publish_clock=publish_clock)
    observer.collect(times, 3)
    fault.touch()
    assert 'a planted fault' in wait_for_error(observer, reports).message
    # Ticks go on, at the instant that was reached.
    observer.collect(times, 3)
    assert len(set(instants(observer.collect(times, 3)))) == 1
    for answer in (observer.step(), observer.pause(False)):
        assert not answer.success
        assert 'a planted fault' in answer.message
    fault.unlink()
    assert observer.reset().success
    before = len(times)
    observer.spin_until(
        lambda: max(instants(times[before:]), default=0) > 0 and instants(times)[-1] > 0,
        'the scene going on',
    )
    assert node.log.count('Traceback') == 1
    assert node.end() == 0


def block_signals():
    signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGTERM))


@pytest.mark.parametrize('by', [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize('program', ['ros', 'viewer'])
def test_a_signal_that_came_before_the_program_had_begun_ends_it_as_always(domain, program, by):
    """As `make run` starts them: blocked, so that nothing is lost while Python itself starts."""
    process = subprocess.Popen(
        [sys.executable, '-m', f'circle_bounce_ros.{program}.main'],
        preexec_fn=block_signals,
        env=child_environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    process.send_signal(by)
    said, _ = process.communicate(timeout=PATIENCE)
    assert (process.returncode, said) == (0, '')


@pytest.mark.parametrize('program', ['ros', 'viewer'])
def test_arguments_for_nobody_are_refused_and_help_lists_the_parameters(program):
    def run(*arguments):
        command = [sys.executable, '-m', f'circle_bounce_ros.{program}.main', *arguments]
        return subprocess.run(command, env=child_environment(), capture_output=True, text=True)

    refused = run('-p', 'port:=9000')
    assert refused.returncode == 2
    assert refused.stderr.endswith('unrecognized arguments: -p port:=9000\n')
    told = run('--help')
    assert told.returncode == 0
    rows = import_module(f'circle_bounce_ros.{program}.main').PARAMETERS
    assert rows
    for row in rows:
        assert f'{row.name} (default ' in told.stdout
        assert row.description in told.stdout


def test_what_a_callback_raises_is_logged_once_and_the_others_go_on(domain, capfd):
    context = Context()
    rclpy.init(context=context, domain_id=domain)
    node = BaseNode('raiser', [], context=context)
    calls = []

    def raise_and_count():
        calls.append(None)
        if len(calls) == 5:
            context.try_shutdown()
            return
        raise KeyError('a fault')

    node.create_timer(0.001, raise_and_count)
    with suppress(ExternalShutdownException):
        BaseExecutor(node).spin()
    assert len(calls) == 5
    assert capfd.readouterr().err.count('a fault of this program') == 1


def test_another_node_on_the_same_topics_is_named_by_both(start, observer, lesson):
    first = start(scene=lesson)
    observer.spin_for(0.0)
    second = start(scene=lesson, arguments=['-r', '__node:=second'], node='/second')
    observer.spin_until(lambda: '/second publishes on the same topics' in first.log, 'a warning')
    observer.spin_until(lambda: '/bounce publishes on the same topics' in second.log, 'a warning')


def test_a_parameter_that_does_not_exist_is_named(start, lesson, observer):
    override = 'qos_overrides./time.publisher.durability:=transient_local'
    node = start(scene=lesson, arguments=['-p', 'sceen:=gas', '-p', override])
    for name in ('sceen', 'qos_overrides./time.publisher.durability'):
        observer.spin_until(
            lambda name=name: f'parameter {name}: there is none of this name' in node.log, name
        )
