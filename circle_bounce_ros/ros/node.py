"""The node: on each tick it asks the kernel for the state at a scene time and says it on topics."""

from __future__ import annotations

import gc
import threading
import time
from collections.abc import Sequence

import rclpy
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.exceptions import InvalidTopicNameException
from rclpy.executors import ExternalShutdownException
from std_srvs.srv import SetBool, Trigger

from circle_bounce_ros.base_node import (
    RCL_ERRORS,
    BaseExecutor,
    BaseNode,
    ParameterError,
    one_line,
)
from circle_bounce_ros.encoding.topics import TIME, Moment
from circle_bounce_ros.kernel import Scene, SceneError
from circle_bounce_ros.ros.compiling import BackgroundCompiler
from circle_bounce_ros.ros.diagnostics import Diagnostics, Facts
from circle_bounce_ros.ros.main import PARAMETERS
from circle_bounce_ros.ros.parameters import Parameters
from circle_bounce_ros.ros.publishers import Publishers
from circle_bounce_ros.ros.runner import Runner
from circle_bounce_ros.ros.ticker import Ticker
from circle_bounce_ros.schedule.schedules import ClockSchedule, Tick, WallSchedule
from circle_bounce_ros.schedule.times import SECOND
from circle_bounce_ros.startup import Ending, on_signals

# However heavy the scene, a service waits about this long for a tick and no longer.
BUDGET = 0.1  # s

# How long ticks that are due together may take in a row.
CATCHING_UP = 0.02  # s

DIAGNOSTICS_PERIOD = 1.0  # s

HOW_TO_GO_ON = 'reset, or another scene, goes on'


class BounceNode(BaseNode):
    """
    A scene that moves and says so.

    Raises
    ------
    ParameterError, SceneError
        For parameters that it cannot start with.

    """

    def __init__(self) -> None:
        super().__init__('bounce', PARAMETERS, always_set=['scene'])
        # Guards the simulation and all that goes with it: ticks at a high rate come from a thread of their own.
        self._lock = threading.Lock()
        self._settings = Parameters(self, self._on_change)
        self._leads = self._settings['publish_clock']
        kind = ClockSchedule if self._leads else WallSchedule
        self._schedule: ClockSchedule | WallSchedule = kind(
            self._settings['rate'],
            self._settings['time_scale'],
            self._settings['start_paused'],
        )
        self._outputs = Publishers(self, self._settings['frame_id'], self._leads)
        self._diagnostics = Diagnostics(self, time.monotonic_ns())
        self._compiler = BackgroundCompiler()
        self._held = False  # paused by a failure, and not by the user
        self._show_scene()
        self.create_service(Trigger, '~/reset', self._reset)
        self.create_service(SetBool, '~/pause', self._pause)
        self.create_service(Trigger, '~/step', self._step)
        # ROS time would stop the timers whenever it stands or jumps back.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._ticker = Ticker(self, steady, self._on_timer, self._schedule.timer_period_ns)
        self.create_timer(DIAGNOSTICS_PERIOD, self._on_second, clock=steady)
        self._others: list[str] = []
        self.warn_of_unknown_parameters()

    def _show_scene(self, contacts_before: int = 0) -> None:
        scene = self._settings.scene
        self._runner = Runner(scene, contacts_before)
        self._release()
        self._outputs.show(scene)
        self._schedule.set_restart_after(scene.restart_after)
        self.get_logger().info(f'{describe(scene)} in frame {self._settings["frame_id"]!r}')
        if self._compiler.start():
            self.get_logger().info(
                'compiling the engine in the background, once: until the next reset it runs plain, slower'
            )
        spare_collections()

    def destroy_node(self) -> None:
        """End what the node has started."""
        self._ticker.stop()
        self._compiler.stop()
        super().destroy_node()

    def _on_timer(self) -> None:
        with self._lock:
            began = time.monotonic_ns()
            reading = self._read_clock()
            try:
                self._show_due_ticks(reading, began)
            except Exception as error:
                # A signal may end the context in the middle of a tick.
                if not self.context.ok():
                    raise
                self.log_failure(error)
                if not self._held:
                    self._hold(self._runner.fail(f'a fault of this program: {one_line(error)}'))
            progress = self._schedule.take_progress()
            self._diagnostics.add_tick(began, self._schedule.timer_period_ns, progress)
            self._report_change()

    def _show_due_ticks(self, reading: int, began: int) -> None:
        while (tick := self._schedule.begin(reading)) is not None:
            complete = self._show(tick)
            if not complete or time.monotonic_ns() - began > CATCHING_UP * SECOND:
                return

    def _read_clock(self) -> int:
        """Return what the clock that drives the scene reads, ns."""
        if isinstance(self._schedule, ClockSchedule):
            return time.monotonic_ns()
        clock = self.get_clock()
        self._schedule.follow(outside=clock.ros_time_is_active)
        return clock.now().nanoseconds

    def _show(self, tick: Tick) -> bool:
        """Publish a tick, if the simulation gets there in time or time need not be made up."""
        if tick.went_back:
            self.get_logger().warning('the clock jumped back: the scene starts again')
            self._release()
        self._runner.record_contacts(self._outputs.contacts_are_wanted)
        reached_ns = self._runner.advance_to(tick.scene_ns, BUDGET)
        if self._runner.failure and not self._held:
            self._hold(reached_ns)
        if not self._schedule.came_to(reached_ns):
            return False
        self._outputs.publish(Moment(tick.stamp_ns, reached_ns, self._runner.state))
        return True

    def _hold(self, reached_ns: int) -> None:
        """Pause where the simulation cannot go on, until the scene starts again or gives way to another one."""
        self._held = True
        self._was_paused = self._schedule.paused
        self._schedule.hold_at(reached_ns)
        self.get_logger().error(f'{self._runner.failure}; paused: {HOW_TO_GO_ON}')

    def _release(self) -> None:
        """Go on as before a failure, if there was one."""
        if self._held:
            self._held = False
            self._schedule.paused = self._was_paused
            if self._runner.failure:
                self._runner.restart()

    def _on_second(self) -> None:
        others = self.other_publishers(TIME.name)
        if others and others != self._others:
            self.get_logger().warning(
                f'{" and ".join(others)} publishes on the same topics: subscribers see two scenes in turn; '
                'use another namespace or ROS_DOMAIN_ID'
            )
        self._others = others
        with self._lock:
            self._diagnostics.end_second(time.monotonic_ns(), self._runner.contact_count)
            if self._has_started():
                self._diagnostics.report(self._now_ns(), self._facts(), self._runner)

    def _report_change(self) -> None:
        if self._has_started():
            self._diagnostics.report_change(self._now_ns(), self._facts(), self._runner)

    def _facts(self) -> Facts:
        scene = self._runner.scene
        return Facts(
            paused=self._schedule.paused,
            scene=scene.name,
            seed=scene.seed,
            time_scale=self._settings['time_scale'],
            waits_for_clock=not self._leads and self._now_ns() == 0,
            failure=self._runner.failure,
        )

    def _now_ns(self) -> int:
        if isinstance(self._schedule, ClockSchedule):
            return self._schedule.stamp_ns
        return self.get_clock().now().nanoseconds

    def _has_started(self) -> bool:
        """Return whether there is a time to report at: whoever leads says nothing at zero."""
        return not self._leads or self._now_ns() > 0

    def _on_change(self, names: set[str]) -> None:
        with self._lock:
            if names & {'scene', 'seed'}:
                self._show_scene(self._runner.contact_count)
                self._schedule.restart()
            if 'rate' in names:
                self._schedule.set_rate(self._settings['rate'])
            if 'time_scale' in names:
                self._schedule.set_time_scale(self._settings['time_scale'])
            self._ticker.set_period(self._schedule.timer_period_ns)
            self._report_change()

    def _reset(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        with self._lock:
            self._release()
            self._schedule.restart()
        response.success = True
        response.message = f'{describe(self._runner.scene)}: starts again from its first instant'
        return response

    def _pause(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        with self._lock:
            response.success = request.data or not self._held
            if response.success:
                self._schedule.paused = request.data
                response.message = 'paused' if request.data else 'running'
                if self._held:
                    self._was_paused = True
            else:
                response.message = f'{self._runner.failure}: {HOW_TO_GO_ON}'
            self._report_change()
        return response

    def _step(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        with self._lock:
            response.success = self._schedule.paused and not self._held
            if self._held:
                response.message = f'{self._runner.failure}: {HOW_TO_GO_ON}'
            elif self._schedule.paused:
                self._schedule.step()
                response.message = f'scene time {self._schedule.scene_ns / SECOND:.9f} s'
            else:
                response.message = 'not paused: only a paused scene goes step by step'
        return response


def spare_collections() -> None:
    """
    Let Python's garbage collections pass over all that there is now.

    The circles of a scene live as long as it does. To look at 100,000 of them again takes 80 ms, and somewhere a tick
    would be late for it.
    """
    gc.unfreeze()
    gc.collect()
    gc.freeze()


def describe(scene: Scene) -> str:
    """Return what a scene is called, what its random numbers came from, and how much is in it."""
    seed = 'no seed' if scene.seed is None else f'seed {scene.seed}'
    return f'scene {scene.name!r}, {seed}, {len(scene.circles)} circles'


def run(args: Sequence[str], ending: Ending) -> int:
    """
    Run the node until a signal comes.

    Parameters
    ----------
    args : sequence of str
        The command line.
    ending : Ending

    Returns
    -------
    int
        The exit status: 1 for arguments and parameters that it cannot start with.

    """
    try:
        rclpy.init(args=args)
    except RCL_ERRORS as error:
        return fail(error)
    node = None
    try:
        node = BounceNode()
        # From here on a signal ends the context, which ends the spinning.
        if not ending.is_asked:
            BaseExecutor(node).spin()
    except (ParameterError, SceneError, InvalidTopicNameException) as error:
        return fail(error)
    except ExternalShutdownException:
        pass
    except RCL_ERRORS as error:
        # A signal may end the context while the node is being made.
        if rclpy.ok():
            return fail(error)
    finally:
        # A shell and a launcher often both pass a Ctrl-C on: the second must not break the clean end.
        # Not ignored yet, because rclpy, as it shuts down, puts back the handler that it found.
        on_signals(lambda *_: None)
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
    return 0


def fail(error: Exception) -> int:
    """Log why the node cannot start, in one line, and return the exit status."""
    rclpy.logging.get_logger('bounce').fatal(one_line(error))
    return 1
