"""The engine as the simulation sees it: a world, a mode to run it in, and what to do when something is full."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.kernel.engine import build, cells, compilation, modes
from circle_bounce_ros.kernel.engine.loop import DONE, ENDLESS, LIST_FULL, LOG_FULL
from circle_bounce_ros.kernel.engine.records import NOTE, World, aligned_copy
from circle_bounce_ros.kernel.scene import Scene

Array = NDArray[Any]

WITHOUT_END = 2**62


def drive(scene: Scene, keep_log: bool, compiled: bool | None) -> Driver:
    """
    Return the driver of a scene at its first instant.

    Parameters
    ----------
    scene : Scene
    keep_log : bool
    compiled : bool or None
        None: whichever is faster and there.

    """
    moving = sum(not circle.locked for circle in scene.circles)
    kind = Together if scene.moving_circles_collide and moving > 1 else Alone
    return kind(scene, keep_log, modes.choose(moving, compiled))


def _copied(part: Any) -> Any:
    return aligned_copy(part) if isinstance(part, np.ndarray) else part


class Driver(ABC):
    """
    A world and how it is run.

    Attributes
    ----------
    world : World
    crowded : int
        The id of the circle whose contacts had no end, -1 if there is none.

    """

    def __init__(self, scene: Scene, keep_log: bool, mode: modes.Mode) -> None:
        self._scene = scene
        self._mode = mode
        # This tells the types of the arrays when a world of objects has to become one again.
        self._types = build.build(scene, keep_log)
        self._enter(self._types)
        self._notes: list[Array] = []
        self.crowded = -1

    def _enter(self, arrays: World) -> None:
        """Take a world of arrays for its own."""
        self.world = arrays if self._mode.takes_arrays else modes.to_objects(arrays)
        # Fields of all records at once, each an array that shows what compiled code writes.
        self._state = modes.columns(arrays.state)
        self._moving = modes.columns(arrays.moving)

    def _arrays(self) -> World:
        """Return the world in arrays, in either mode."""
        if self._mode.takes_arrays:
            return self.world
        return modes.to_arrays(self.world, self._types)

    def __getstate__(self) -> dict[str, Any]:
        """Return what a copy or a pickle is made of: the world in arrays, which a world of objects is made from."""
        state = self.__dict__.copy()
        for derived in ('_mode', '_types', '_state', '_moving'):
            del state[derived]
        return state | {
            'world': self._arrays(),
            'compiled': self._mode.takes_arrays,
            '_notes': list(self._notes),
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Become a copy that shares nothing; where numba is missing it goes on in plain Python, to the same bits."""
        world = state.pop('world')
        compiled = state.pop('compiled') and compilation.is_available()
        self.__dict__.update(state)
        self._mode = modes.compiled() if compiled else modes.PLAIN
        self._types = World(*(_copied(part) for part in world))
        self._enter(self._types)

    @abstractmethod
    def run(self, time: float, at_most: int | None) -> int:
        """Carry out all events up to a time, or about `at_most`; return DONE, BUDGET_SPENT or ENDLESS."""

    @property
    def reached(self) -> float:
        """The time up to which everything has been done where it was less than what was wanted, s."""
        return float(self.get('epoch') + self.get('time'))

    def _run_in_order(self, entry: modes.Entry, time: float, at_most: int | None) -> int:
        """Run event by event, and make room for what is full."""
        budget = WITHOUT_END if at_most is None else int(min(at_most, WITHOUT_END))
        # Asked for only if it matters: among few circles the asking would be half of the work.
        last = 0 if at_most is None else self.get('events') + budget
        while (why := entry(self.world, time, budget)) in (LOG_FULL, LIST_FULL):
            if why == LOG_FULL:
                self._empty_log()
            else:
                self._make_room()
            if at_most is not None:
                budget = last - self.get('events')
        if why == ENDLESS:
            self._note_crowded()
        return why

    def _make_room(self) -> None:
        self._enter(cells.with_more_room(self._arrays()))

    def get(self, name: str) -> Any:
        """Return a number of the world's state."""
        if self._mode.takes_arrays:
            return getattr(self._state, name).item()
        return getattr(self.world.state[0], name)

    def set(self, name: str, value: float) -> None:
        """Set a number of the world's state."""
        if self._mode.takes_arrays:
            getattr(self._state, name)[0] = value
        else:
            setattr(self.world.state[0], name, value)

    def _note_crowded(self) -> None:
        """Remember whose turn it was."""
        circle = self.world.moving[self.world.tree_who[1]]
        self.crowded = int(circle['id'] if self._mode.takes_arrays else circle.id)

    def _empty_log(self) -> None:
        count = self.get('notes')
        if count == 0:
            return
        log = self.world.log[:count]
        if self._mode.takes_arrays:
            self._notes.append(log.copy())
        else:
            rows = [tuple(getattr(note, name) for name in NOTE.names or ()) for note in log]
            self._notes.append(np.array(rows, NOTE))
        self.set('notes', 0)

    def drain(self) -> Array:
        """Return the contacts logged since the last call, (k,) of dtype NOTE, in order of time."""
        self._empty_log()
        notes = np.concatenate([np.zeros(0, NOTE), *self._notes])
        self._notes = []
        return notes

    def positions(self, time: float) -> NDArray[np.float64]:
        """Return where the moving circles are at a time that has been reached, (n, 2), m."""
        world = self.world
        rows = np.empty((len(world.moving), 2))
        self._mode.read_positions(world.moving, world.state, time, rows)
        return rows

    def velocities(self) -> NDArray[np.float64]:
        """Return the velocities of the moving circles, (n, 2), m/s."""
        rows = np.empty((len(self.world.moving), 2))
        if self._mode.takes_arrays:
            rows[self._moving.rank, 0] = self._moving.vx
            rows[self._moving.rank, 1] = self._moving.vy
        else:
            for circle in self.world.moving:
                rows[circle.rank] = circle.vx, circle.vy
        return rows


class Together(Driver):
    """Circles that hit each other: event by event, in order of time."""

    def run(self, time: float, at_most: int | None) -> int:
        return self._run_in_order(self._mode.run, time, at_most)


class Alone(Driver):
    """Circles that hit nobody who moves: each followed on its own, in order of time only where the work is cut."""

    def __init__(self, scene: Scene, keep_log: bool, mode: modes.Mode) -> None:
        super().__init__(scene, keep_log, mode)
        self._done = 0.0

    def run(self, time: float, at_most: int | None) -> int:
        if at_most is not None:
            why = self._run_in_order(self._mode.run_alone_in_order, time, at_most)
            self._done = time if why == DONE else max(self._done, self.reached)
            return why
        while (why := self._mode.run_alone(self.world, time)) == LOG_FULL:
            self._empty_log()
        if why == ENDLESS:
            self._go_back()
            return self._run_in_order(self._mode.run_alone_in_order, time, None)
        self._done = time
        return why

    def _go_back(self) -> None:
        """Undo what single circles have done beyond the time that all have reached, by going there from the start."""
        notes = self.drain()
        self._notes = [notes[notes['time'] <= self._done]]
        keep_log = self.get('keep_log')
        self._enter(build.build(self._scene, keep_log=False))
        self._mode.run_alone(self.world, self._done)
        self.set('keep_log', keep_log)

    def drain(self) -> Array:
        notes = super().drain()
        return notes[np.lexsort((notes['a'], notes['time']))]
