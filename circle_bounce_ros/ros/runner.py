"""The simulation on its way from instant to instant of scene time, in slices that block nobody for long."""

from __future__ import annotations

import time

from circle_bounce_ros.encoding.topics import State
from circle_bounce_ros.kernel import (
    EndlessContactsError,
    Scene,
    Simulation,
    compiled_code_is_ready,
    kinetic_energy,
)
from circle_bounce_ros.schedule.slices import advance
from circle_bounce_ros.schedule.times import kernel_time, last_ns_before


def start(scene: Scene) -> Simulation:
    """Return a scene at its first instant, compiled where nobody has to wait for that; the bits are the same."""
    return Simulation(scene, compiled=None if compiled_code_is_ready() else False)


class Runner:
    """
    A scene in motion.

    Parameters
    ----------
    scene : Scene
    contacts_before : int
        How many there have been in earlier scenes.

    """

    def __init__(self, scene: Scene, contacts_before: int = 0) -> None:
        self._simulation = start(scene)
        self._failed_ns: int | None = None  # where it cannot go on
        self._failure = ''
        self._energy = kinetic_energy(self._simulation)
        self._contacts_before = contacts_before

    @property
    def scene(self) -> Scene:
        """The scene that it started from."""
        return self._simulation.scene

    @property
    def state(self) -> State:
        """The state at the instant that was reached, to be used before the next one."""
        return State(self._simulation)

    @property
    def failure(self) -> str:
        """Why the simulation cannot go on, such as contacts without end; empty when it can."""
        return self._failure

    @property
    def contact_count(self) -> int:
        """How many contacts there have been, restarts and earlier scenes included."""
        return self._contacts_before + self._simulation.contact_count

    @property
    def energy_error(self) -> float:
        """How far the kinetic energy is from that of the first instant, relative to it."""
        return kinetic_energy(self._simulation) / self._energy - 1.0 if self._energy else 0.0

    def record_contacts(self, wanted: bool) -> None:
        """Log contacts from here on, or forget them."""
        if wanted != self._simulation.record_contacts:
            self._simulation.record_contacts = wanted
            self._simulation.drain_contacts()

    def advance_to(self, scene_ns: int, seconds: float) -> int:
        """
        Go to an instant of scene time; for an earlier one the scene starts again.

        Parameters
        ----------
        scene_ns : int, ns
        seconds : float, s
            How long it may take, give or take one slice.

        Returns
        -------
        int, ns
            The instant reached: `scene_ns`, or less when time was up or the simulation cannot go on. The
            state is that of this very instant.

        """
        if self._failed_ns is not None and scene_ns >= self._failed_ns:
            return self._failed_ns
        if kernel_time(scene_ns) < self._simulation.time:
            self.restart()
        deadline = time.monotonic() + seconds
        try:
            return advance(self._simulation, scene_ns, lambda: time.monotonic() < deadline)
        except EndlessContactsError as error:
            return self.fail(str(error))

    def fail(self, reason: str) -> int:
        """Go no further than the instant that was reached, until the scene starts again; return that instant, ns."""
        self._failure = reason
        # The state stays that of the very instant, less than a nanosecond later.
        self._failed_ns = last_ns_before(self._simulation.time)
        return self._failed_ns

    def restart(self) -> None:
        """Start the scene again."""
        self._contacts_before += self._simulation.contact_count
        wanted = self._simulation.record_contacts
        self._simulation = start(self.scene)
        self._simulation.record_contacts = wanted
        self._failure, self._failed_ns = '', None
