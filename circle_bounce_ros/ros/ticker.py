"""What calls the node at its rate: a timer of the executor, or at high rates a thread of its own."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from rclpy.clock import Clock
from rclpy.node import Node

from circle_bounce_ros.schedule.schedules import MOST_MADE_UP
from circle_bounce_ros.schedule.times import SECOND

# Shorter periods than this are for the thread: at 1,000 Hz the executor loses ticks, and takes half a core for it.
SHORT = SECOND // 200  # ns


class Ticker:
    """
    Calls a function again and again.

    The function must guard what it shares with the node's callbacks by itself.

    Parameters
    ----------
    node : Node
    clock : Clock
        A steady one.
    call : callable
    period_ns : int, ns
        0 for as often as possible.

    """

    def __init__(self, node: Node, clock: Clock, call: Callable[[], None], period_ns: int) -> None:
        self._node = node
        self._call = call
        self._thread: threading.Thread | None = None
        self._period_ns = period_ns
        self._timer = node.create_timer(period_ns / SECOND, call, clock=clock)
        self._divide_work()

    @property
    def period_ns(self) -> int:
        """How often it calls, ns."""
        return self._period_ns

    def set_period(self, period_ns: int) -> None:
        """Change how often, from the next call on."""
        if period_ns == self._period_ns:
            return
        self._period_ns = period_ns
        self._timer.timer_period_ns = period_ns
        self._divide_work()

    def stop(self) -> None:
        """Call no more; not to be called by who holds what the function waits for."""
        thread, self._thread = self._thread, None
        if thread is not None:
            thread.join()

    def _divide_work(self) -> None:
        if not 0 < self._period_ns < SHORT:
            self._thread = None
            self._timer.reset()
            return
        self._timer.cancel()
        if self._thread is None:
            self._thread = threading.Thread(target=self._call_at_deadlines, daemon=True)
            self._thread.start()

    def _call_at_deadlines(self) -> None:
        due = time.monotonic_ns()
        # Whoever is not wanted any more ends by itself.
        while self._thread is threading.current_thread():
            due += self._period_ns
            wait = due - time.monotonic_ns()
            if wait > 0:
                time.sleep(wait / SECOND)
            elif wait < -MOST_MADE_UP:
                due -= wait
            try:
                self._call()
            except Exception:
                # A signal may end the context in the middle of a call.
                if self._node.context.ok():
                    raise
                return
