"""The engine as the simulation calls it: a world, a backend to run it in, and what to do when something is full."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.kernel.engine import backends, build, compilation, grid_layout
from circle_bounce_ros.kernel.engine.loop import DONE, ENDLESS, LIST_FULL, LOG_FULL
from circle_bounce_ros.kernel.engine.records import LOG_ENTRY, World, aligned_copy
from circle_bounce_ros.kernel.scene import Scene

Array = NDArray[Any]

WITHOUT_END = 2**62


def make_engine(scene: Scene, keep_log: bool, compiled: bool | None) -> Engine:
    """
    Return the engine of a scene at its first instant.

    Parameters
    ----------
    scene : Scene
    keep_log : bool
    compiled : bool or None
        None: whichever is faster and there.

    """
    moving = sum(not circle.locked for circle in scene.circles)
    kind = Interacting if scene.moving_circles_collide and moving > 1 else Independent
    return kind(scene, keep_log, backends.choose(moving, compiled))


def _copied(part: Any) -> Any:
    return aligned_copy(part) if isinstance(part, np.ndarray) else part


class Engine(ABC):
    """
    A world and the backend that runs it.

    Attributes
    ----------
    world : World
    endless_circle : int
        The id of the circle whose contacts had no end, -1 if there is none.

    """

    def __init__(self, scene: Scene, keep_log: bool, backend: backends.Backend) -> None:
        self._scene = scene
        self._backend = backend
        # This tells the types of the arrays when a world of objects has to become one again.
        self._types = build.build(scene, keep_log)
        self._enter(self._types)
        self._log: list[Array] = []
        self.endless_circle = -1

    def _enter(self, arrays: World) -> None:
        """Take a world of arrays for its own."""
        self.world = arrays if self._backend.takes_arrays else backends.to_objects(arrays)
        # Fields of all records at once, each an array that shows what compiled code writes.
        self._state = backends.columns(arrays.state)
        self._moving = backends.columns(arrays.moving)

    def _arrays(self) -> World:
        """Return the world in arrays, in either backend."""
        if self._backend.takes_arrays:
            return self.world
        return backends.to_arrays(self.world, self._types)

    def __getstate__(self) -> dict[str, Any]:
        """Return what a copy or a pickle is made of: the world in arrays, which a world of objects is made from."""
        state = self.__dict__.copy()
        for derived in ('_backend', '_types', '_state', '_moving'):
            del state[derived]
        return state | {
            'world': self._arrays(),
            'compiled': self._backend.takes_arrays,
            '_log': list(self._log),
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Become a copy that shares nothing; where numba is missing it goes on in plain Python, to the same bits."""
        world = state.pop('world')
        compiled = state.pop('compiled') and compilation.is_available()
        self.__dict__.update(state)
        self._backend = backends.compiled() if compiled else backends.PLAIN
        self._types = World(*(_copied(part) for part in world))
        self._enter(self._types)

    @abstractmethod
    def run(self, time: float, at_most: int | None) -> int:
        """Carry out all events up to a time, or about `at_most`; return DONE, BUDGET_SPENT or ENDLESS."""

    @property
    def reached(self) -> float:
        """The time up to which everything has been done where it was less than what was wanted, s."""
        return float(self.get('epoch') + self.get('time'))

    def _run_in_order(self, entry: backends.Entry, time: float, at_most: int | None) -> int:
        """Run event by event, and make room for what is full."""
        budget = WITHOUT_END if at_most is None else int(min(at_most, WITHOUT_END))
        # Asked for only if it matters: among few circles the asking would be half of the work.
        last = 0 if at_most is None else self.get('events') + budget
        while (why := entry(self.world, time, budget)) in (LOG_FULL, LIST_FULL):
            if why == LOG_FULL:
                self._move_log()
            else:
                self._make_room()
            if at_most is not None:
                budget = last - self.get('events')
        if why == ENDLESS:
            self._remember_endless_circle()
        return why

    def _make_room(self) -> None:
        self._enter(grid_layout.with_more_room(self._arrays()))

    def get(self, name: str) -> Any:
        """Return a number of the world's state."""
        if self._backend.takes_arrays:
            return getattr(self._state, name).item()
        return getattr(self.world.state[0], name)

    def set(self, name: str, value: float) -> None:
        """Set a number of the world's state."""
        if self._backend.takes_arrays:
            getattr(self._state, name)[0] = value
        else:
            setattr(self.world.state[0], name, value)

    def _remember_endless_circle(self) -> None:
        """Remember whose turn it was."""
        circle = self.world.moving[self.world.tree_who[1]]
        self.endless_circle = int(circle['id'] if self._backend.takes_arrays else circle.id)

    def _move_log(self) -> None:
        count = self.get('logged')
        if count == 0:
            return
        log = self.world.log[:count]
        if self._backend.takes_arrays:
            self._log.append(log.copy())
        else:
            rows = [
                tuple(getattr(log_contact, name) for name in LOG_ENTRY.names or ())
                for log_contact in log
            ]
            self._log.append(np.array(rows, LOG_ENTRY))
        self.set('logged', 0)

    def drain(self) -> Array:
        """Return the contacts logged since the last call, (k,) of dtype NOTE, in order of time."""
        self._move_log()
        logged = np.concatenate([np.zeros(0, LOG_ENTRY), *self._log])
        self._log = []
        return logged

    def positions(self, time: float) -> NDArray[np.float64]:
        """Return where the moving circles are at a time that has been reached, (n, 2), m."""
        world = self.world
        rows = np.empty((len(world.moving), 2))
        self._backend.read_positions(world.moving, world.state, time, rows)
        return rows

    def velocities(self) -> NDArray[np.float64]:
        """Return the velocities of the moving circles, (n, 2), m/s."""
        rows = np.empty((len(self.world.moving), 2))
        if self._backend.takes_arrays:
            rows[self._moving.moving_index, 0] = self._moving.vx
            rows[self._moving.moving_index, 1] = self._moving.vy
        else:
            for circle in self.world.moving:
                rows[circle.moving_index] = circle.vx, circle.vy
        return rows


class Interacting(Engine):
    """Interacting circles: event by event, in order of time."""

    def run(self, time: float, at_most: int | None) -> int:
        return self._run_in_order(self._backend.run, time, at_most)


class Independent(Engine):
    """Circles that hit no other moving circle: each on its own, in order of time only where the work is cut."""

    def __init__(self, scene: Scene, keep_log: bool, backend: backends.Backend) -> None:
        super().__init__(scene, keep_log, backend)
        self._done = 0.0

    def run(self, time: float, at_most: int | None) -> int:
        if at_most is not None:
            why = self._run_in_order(self._backend.run_independent_in_order, time, at_most)
            self._done = time if why == DONE else max(self._done, self.reached)
            return why
        while (why := self._backend.run_independent(self.world, time)) == LOG_FULL:
            self._move_log()
        if why == ENDLESS:
            self._go_back()
            return self._run_in_order(self._backend.run_independent_in_order, time, None)
        self._done = time
        return why

    def _go_back(self) -> None:
        """Undo what single circles have done beyond the time that all have reached, by going there from the start."""
        logged = self.drain()
        self._log = [logged[logged['time'] <= self._done]]
        keep_log = self.get('keep_log')
        self._enter(build.build(self._scene, keep_log=False))
        self._backend.run_independent(self.world, self._done)
        self.set('keep_log', keep_log)

    def drain(self) -> Array:
        logged = super().drain()
        return logged[np.lexsort((logged['a'], logged['time']))]
