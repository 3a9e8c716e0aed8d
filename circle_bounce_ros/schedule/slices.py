"""How a simulation gets to an instant in slices of work that block nobody for long."""

from __future__ import annotations

import time
from collections.abc import Callable

from circle_bounce_ros.kernel import EndlessContactsError, Simulation
from circle_bounce_ros.schedule.times import first_ns_after, kernel_time

# Steps of work in the first slice: about 10 ms of the plain engine. A slice that took less than SHORT lets the next
# one be twice as large, for a call costs as much as some twenty steps of compiled code.
FIRST_SLICE = 256
SHORT = 0.005  # s

# To end at a whole nanosecond may take so many steps more: about a second of the plain engine.
MOST_STEPS_A_NANOSECOND = 100_000


def advance(simulation: Simulation, scene_ns: int, go_on: Callable[[], bool]) -> int:
    """
    Advance a simulation to an instant that is not before its time.

    Parameters
    ----------
    simulation : Simulation
    scene_ns : int, ns
    go_on : callable
        Asked after each slice; false ends it early.

    Returns
    -------
    int, ns
        The instant reached: `scene_ns`, or less when it ended early. The state is that of this very
        instant.

    Raises
    ------
    EndlessContactsError
        For contacts without end at one instant, or so many within a nanosecond that they would block the caller.

    """
    target = kernel_time(scene_ns)
    at_most = FIRST_SLICE
    began = time.monotonic()
    while not simulation.advance_to(target, at_most=at_most):
        if not go_on():
            reached_ns = min(first_ns_after(simulation.time), scene_ns)
            most = MOST_STEPS_A_NANOSECOND + 10 * len(simulation.ids)
            if not simulation.advance_to(kernel_time(reached_ns), at_most=most):
                raise EndlessContactsError(
                    f'more than {most} steps of work within a nanosecond, at {simulation.time:.9g} s'
                )
            return reached_ns
        now = time.monotonic()
        if now - began < SHORT:
            at_most *= 2
        began = now
    return scene_ns
