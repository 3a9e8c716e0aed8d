"""A scene in motion: where everything is at any time, and which contacts brought it there."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.kernel.contact_record import CONTACT
from circle_bounce_ros.kernel.engine.engines import make_engine
from circle_bounce_ros.kernel.engine.loop import DONE, ENDLESS
from circle_bounce_ros.kernel.scene import Scene

Floats = NDArray[np.float64]


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
    compiled : bool, optional
        Run the engine compiled by numba, or as plain Python: the same bits. By default whichever is
        faster and there; compiling takes some seconds once, and is kept on disk.

    Raises
    ------
    ImportError
        For `compiled=True` where numba is not installed.

    """

    def __init__(
        self, scene: Scene, record_contacts: bool = False, *, compiled: bool | None = None
    ) -> None:
        self._scene = scene
        self._compiled = compiled
        self._ids = np.array([i for i, c in enumerate(scene.circles) if not c.locked], np.int64)
        self._radii = np.array([c.radius for c in scene.circles if not c.locked], np.float64)
        self._masses = np.array([c.mass for c in scene.circles if not c.locked], np.float64)
        self._make_read_only()
        self._start(record_contacts)

    def _make_read_only(self) -> None:
        for array in (self._ids, self._radii, self._masses):
            array.flags.writeable = False

    def __copy__(self) -> Simulation:
        """Return an independent simulation of the same bits, which goes on as this one would."""
        twin: Simulation = object.__new__(type(self))
        twin.__dict__.update(self.__dict__)
        # What does not change is shared.
        twin._engine = copy.copy(self._engine)
        return twin

    def __deepcopy__(self, memo: dict[int, Any]) -> Simulation:
        return copy.copy(self)

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Restore what a pickle holds."""
        self.__dict__.update(state)
        self._make_read_only()

    def _start(self, record_contacts: bool) -> None:
        self._engine = make_engine(self._scene, record_contacts, self._compiled)
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
            At least 1. Stop early after so many steps of work (contacts, predictions and changes of cell), so that
            nobody waits longer than they want to; call again to go on. The last step may be one of many cells:
            up to 8,192 more.

        Returns
        -------
        bool
            Whether `time` was reached. If not, `.time` says how far it came.

        Raises
        ------
        ValueError
            For a time before `.time`, NaN or infinite, or `at_most` below 1.
        EndlessContactsError
            For contacts without end at one instant; `.time` stands at it and the state can be read.

        """
        time = float(time)
        if not self._time <= time < math.inf:
            if not math.isfinite(time):
                raise ValueError(f'time: must be finite, got {time}')
            raise ValueError(f'time: must not be before {self._time} s, got {time}')
        if at_most is not None and not at_most >= 1:
            raise ValueError(f'at_most: must be at least 1, got {at_most}')
        why = self._engine.run(time, at_most)
        if why == DONE:
            self._time = time
            return True
        # Never beyond what was asked for, by a rounding either.
        self._time = min(max(self._time, self._engine.reached), time)
        if why == ENDLESS:
            raise EndlessContactsError(self._describe_cascade())
        return False

    def _describe_cascade(self) -> str:
        world = self._engine.world
        return (
            f'{self._scene.label(self._engine.endless_circle)}: contacts without end at {self._time:.9g} s, more than '
            f'{world.burst_limit} of them within {world.cascade_span:.3g} s'
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
        return self._engine.positions(self._time)

    @property
    def velocities(self) -> Floats:
        """The velocities of the moving circles at `.time`, (n, 2), m/s."""
        return self._engine.velocities()

    @property
    def contact_count(self) -> int:
        """How many contacts there have been since the first instant."""
        return int(self._engine.get('contacts'))

    @property
    def record_contacts(self) -> bool:
        """Whether contacts are logged from here on."""
        return bool(self._engine.get('keep_log'))

    @record_contacts.setter
    def record_contacts(self, wanted: bool) -> None:
        self._engine.set('keep_log', int(wanted))

    def drain_contacts(self) -> NDArray[np.void]:
        """
        Return the contacts logged since the last call, in order of time, and forget them.

        Returns
        -------
        (k,) structured array of dtype `CONTACT`

        """
        return self._engine.drain().astype(CONTACT)
