"""A scene in motion: where everything is at any time, and which contacts brought it there."""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.kernel.engine import records
from circle_bounce_ros.kernel.engine.build import build
from circle_bounce_ros.kernel.engine.grid import place_at
from circle_bounce_ros.kernel.engine.loop import BUDGET_SPENT, DONE, ENDLESS, run, set_clock_back
from circle_bounce_ros.kernel.scene import Scene

Floats = NDArray[np.float64]


class ContactKind(IntEnum):
    """What a moving circle has touched."""

    CIRCLE = records.CIRCLE  # another moving circle
    LOCKED = records.LOCKED
    WALL = records.WALL
    WALL_END = records.WALL_END


# One row a contact. Circle a has touched b: the circle of that id, or for the last two kinds the wall of that
# number (the lowest, for an end that walls share). The normal is the unit vector from a to b, the impulse
# what b receives along it. Of two moving circles a is the one of lower id.
CONTACT = np.dtype(
    [
        ('time', np.float64),  # s
        ('a', np.int64),
        ('b', np.int64),
        ('kind', np.uint8),  # ContactKind
        ('x', np.float64),  # m, the contact point
        ('y', np.float64),
        ('nx', np.float64),
        ('ny', np.float64),
        ('impulse', np.float64),  # N s
    ]
)


class EndlessContactsError(RuntimeError):
    """A scene whose contacts at one instant have no end, such as a circle in a slot that fits exactly."""


class Simulation:
    """
    A scene in motion, exact at any time.

    The same bits however the way to a time is cut: `advance_to(a); advance_to(b)` is `advance_to(b)`.

    Parameters
    ----------
    scene : Scene
    record_contacts : bool
        Keep a log of contacts for `drain_contacts`; may be switched at any time.

    """

    def __init__(self, scene: Scene, record_contacts: bool = False) -> None:
        self._scene = scene
        self._ids = np.array([i for i, c in enumerate(scene.circles) if not c.locked], np.int64)
        self._radii = np.array([c.radius for c in scene.circles if not c.locked], np.float64)
        self._masses = np.array([c.mass for c in scene.circles if not c.locked], np.float64)
        for array in (self._ids, self._radii, self._masses):
            array.flags.writeable = False
        self._start(record_contacts)

    def _start(self, record_contacts: bool) -> None:
        self._world = build(self._scene, record_contacts)
        self._time = 0.0

    def reset(self) -> None:
        """Go back to the scene's first instant; contacts not drained are forgotten."""
        self._start(self.record_contacts)

    def advance_to(self, time: float, at_most: int | None = None) -> bool:
        """
        Carry out all contacts up to a time.

        Parameters
        ----------
        time : float, s
            Not earlier than `.time`.
        at_most : int, optional
            Stop early after so many steps of work (contacts and changes of cell), so that nobody waits
            longer than they want to; call again to go on.

        Returns
        -------
        bool
            Whether `time` was reached. If not, `.time` says how far it came.

        Raises
        ------
        ValueError
            For a time before `.time`, NaN or infinite.
        EndlessContactsError
            For contacts without end at one instant; `.time` stands at it and the state can be read.

        """
        time = float(time)
        if not math.isfinite(time):
            raise ValueError(f'time: must be finite, got {time}')
        if time < self._time:
            raise ValueError(f'time: must not be before {self._time} s, got {time}')
        budget = math.inf if at_most is None else at_most
        while True:
            before = self._world.events
            why = run(self._world, time - self._world.epoch, budget)
            budget -= self._world.events - before
            if why == DONE:
                self._time = time
                return True
            if why == BUDGET_SPENT:
                self._stop_at_last_event()
                return False
            if why == ENDLESS:
                self._stop_at_last_event()
                raise EndlessContactsError(self._describe_crowd())
            set_clock_back(self._world)

    def _stop_at_last_event(self) -> None:
        self._time = max(self._time, self._world.epoch + self._world.time)

    def _describe_crowd(self) -> str:
        circle = self._world.moving[self._world.tree_who[1]]
        return (
            f'{self._scene.label(circle.id)}: contacts without end at {self._time:.9g} s, more than '
            f'{self._world.patience} of them within {self._world.crowd_span:.3g} s'
        )

    @property
    def scene(self) -> Scene:
        """The scene that it started from."""
        return self._scene

    @property
    def time(self) -> float:
        """The time of the state, s."""
        return self._time

    @property
    def ids(self) -> NDArray[np.int64]:
        """The ids of the n moving circles, (n,): their indices in `scene.circles`."""
        return self._ids

    @property
    def radii(self) -> Floats:
        """The radii of the moving circles, (n,), m."""
        return self._radii

    @property
    def masses(self) -> Floats:
        """The masses of the moving circles, (n,), kg."""
        return self._masses

    @property
    def positions(self) -> Floats:
        """The centres of the moving circles at `.time`, (n, 2), m."""
        now = self._time - self._world.epoch
        return np.array([place_at(circle, now) for circle in self._world.moving], np.float64)

    @property
    def velocities(self) -> Floats:
        """The velocities of the moving circles at `.time`, (n, 2), m/s."""
        return np.array([(circle.vx, circle.vy) for circle in self._world.moving], np.float64)

    @property
    def contact_count(self) -> int:
        """How many contacts there have been since the first instant."""
        return self._world.contacts

    @property
    def record_contacts(self) -> bool:
        """Whether contacts are logged from here on."""
        return self._world.keep_log

    @record_contacts.setter
    def record_contacts(self, wanted: bool) -> None:
        self._world.keep_log = wanted

    def drain_contacts(self) -> NDArray[np.void]:
        """
        Return the contacts logged since the last call, in order of time, and forget them.

        Returns
        -------
        (k,) structured array of dtype `CONTACT`

        """
        contacts = np.array(self._world.log, CONTACT)
        self._world.log = []
        return contacts
