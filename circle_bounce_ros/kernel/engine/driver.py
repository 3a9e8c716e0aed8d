"""The engine as the simulation sees it: a world, a mode to run it in, and what to do when something is full."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.kernel.engine import build, modes
from circle_bounce_ros.kernel.engine.loop import BUDGET_SPENT, DONE, ENDLESS, LIST_FULL, LOG_FULL
from circle_bounce_ros.kernel.engine.records import NOTE, World
from circle_bounce_ros.kernel.scene import Scene

Array = NDArray[Any]

WITHOUT_END = 2**62


class Driver:
    """
    A world and how it is run.

    Parameters
    ----------
    scene : Scene
    keep_log : bool
    compiled : bool or None
        None: whichever is faster and there.

    """

    def __init__(self, scene: Scene, keep_log: bool, compiled: bool | None) -> None:
        self._scene = scene
        arrays = build.build(scene, keep_log)
        self._collide = scene.moving_circles_collide
        self._mode = modes.choose(len(arrays.moving), compiled)
        # This tells the types of the arrays when a world of objects has to become one again.
        self._types = arrays
        self._enter(arrays)
        self._notes: list[Array] = []
        self._reached_alone = 0.0
        self.crowded = -1  # the id of the circle whose contacts had no end

    def _enter(self, arrays: World) -> None:
        """Take a world of arrays for its own."""
        self.world = arrays if self._mode.takes_arrays else modes.to_objects(arrays)
        # Fields of all records at once, each an array that shows what compiled code writes.
        self._state = modes.columns(arrays.state)
        self._moving = modes.columns(arrays.moving)

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

    @property
    def reached(self) -> float:
        """The time up to which everything has been done, s."""
        if self._collide:
            return float(self.get('epoch') + self.get('time'))
        return self._reached_alone

    def run(self, time: float, at_most: int | None) -> int:
        """Carry out all events up to a time, or about `at_most`; return DONE, BUDGET_SPENT or ENDLESS."""
        if self._collide:
            return self._run_together(time, at_most)
        return self._run_alone(time, at_most)

    def _run_together(self, time: float, at_most: int | None) -> int:
        budget = WITHOUT_END if at_most is None else at_most
        # Asked for only if it matters: among few circles the asking would be half of the work.
        last = 0 if at_most is None else self.get('events') + at_most
        while True:
            why = self._mode.run(self.world, time, budget)
            if why == LOG_FULL:
                self._empty_log()
            elif why == LIST_FULL:
                self._make_room()
            else:
                if why == ENDLESS:
                    self._note_crowded()
                return why
            if at_most is not None:
                budget = last - self.get('events')

    def _run_alone(self, time: float, at_most: int | None) -> int:
        """Run circle by circle, where steps of work are in no order of time: to do fewer is to go less far."""
        until = time
        if at_most is not None:
            # A circle that travels a radius seldom has more than one contact.
            radii = max(1.0, at_most / len(self.world.moving))
            until = min(time, self._reached_alone + radii * self.world.span / build.RADII_PER_SPAN)
        while (why := self._mode.run_alone(self.world, until)) == LOG_FULL:
            self._empty_log()
        if why == ENDLESS:
            self._note_crowded()
            self._go_back_to(self._reached_alone)
            return ENDLESS
        self._reached_alone = until
        return DONE if until == time else BUDGET_SPENT

    def _note_crowded(self) -> None:
        """Remember whose turn it was."""
        circle = self.world.moving[self.world.tree_who[1]]
        self.crowded = int(circle['id'] if self._mode.takes_arrays else circle.id)

    def _go_back_to(self, time: float) -> None:
        """Undo what single circles have done beyond a time, by going there once more from the start."""
        notes = self.drain()
        self._notes = [notes[notes['time'] <= time]]
        keep_log = self.get('keep_log')
        self._enter(build.build(self._scene, keep_log=False))
        self._mode.run_alone(self.world, time)
        self.set('keep_log', keep_log)

    def _make_room(self) -> None:
        arrays = self.world
        if not self._mode.takes_arrays:
            arrays = modes.to_arrays(self.world, self._types)
        self._enter(build.with_more_room(arrays))

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
        if not self._collide:  # circle by circle, so far
            notes = notes[np.lexsort((notes['a'], notes['time']))]
        return notes

    def positions(self, time: float) -> NDArray[np.float64]:
        """Return where the moving circles are at a time that has been reached, (n, 2), m."""
        moving = self.world.moving
        rows = np.empty((len(moving), 2))
        self._mode.read_positions(moving, time - self.get('epoch'), rows)
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
