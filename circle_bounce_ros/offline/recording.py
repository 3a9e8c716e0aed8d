"""A scene, run as fast as it goes, tick by tick."""

from __future__ import annotations

import fcntl
import json
import math
import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, Protocol

from circle_bounce_ros.encoding.topics import Moment, State
from circle_bounce_ros.kernel import Circle, Scene, SceneError, Simulation
from circle_bounce_ros.scene_file.reading import LARGEST_FILE
from circle_bounce_ros.schedule.schedules import Tick
from circle_bounce_ros.schedule.slices import advance
from circle_bounce_ros.schedule.times import kernel_time

# Beside the recording in its folder: the scene with every circle in it, as a scene file.
SCENE_FILE = 'scene.yaml'


class Sink(Protocol):
    """Where a recording goes."""

    @property
    def wants_contacts(self) -> bool:
        """Whether contacts are to be recorded."""

    def write(self, moment: Moment) -> None:
        """Write a tick."""

    def close(self) -> None:
        """Finish what was written."""

    def abort(self) -> None:
        """Let go of it as it stands, after an error."""


def moments(
    simulation: Simulation, ticks: Iterable[Tick], stop: Callable[[], bool] = lambda: False
) -> Iterator[Moment]:
    """
    Return what each tick shows. Each is to be used before the next one.

    Parameters
    ----------
    simulation : Simulation
        At its first instant.
    ticks : iterable of Tick
    stop : callable
        Asked every now and then; true ends it after the last complete tick.

    Raises
    ------
    EndlessContactsError
        For contacts without end at one instant.

    """
    for tick in ticks:
        if kernel_time(tick.scene_ns) < simulation.time:
            simulation.reset()
        advance(simulation, tick.scene_ns, lambda: not stop())
        if stop():
            return
        yield Moment(tick.stamp_ns, tick.scene_ns, State(simulation))


def scene_text(scene: Scene) -> str:
    """
    Return a scene with its groups filled as a scene file, which gives the same scene to the last bit.

    Raises
    ------
    SceneError
        For so many circles and walls that it could not be read again.

    """
    text = json.dumps(describe(scene)) + '\n'
    if len(text) > LARGEST_FILE:
        rule = f'must be at most {LARGEST_FILE / 1e6:g} MB when written out'
        raise SceneError('', f'{rule}, got {len(text) / 1e6:.1f} MB')
    return text


def describe(scene: Scene) -> dict[str, Any]:
    """Return a scene as a scene file says it."""
    seed = 'none' if scene.seed is None else scene.seed
    data: dict[str, Any] = {
        'description': f'Scene {scene.name}, seed {seed}, as it was recorded.',
        'moving_circles_collide': scene.moving_circles_collide,
        'circles': [_circle(circle) for circle in scene.circles],
    }
    if scene.walls:
        data['walls'] = [{'start': list(w.start), 'end': list(w.end)} for w in scene.walls]
    if math.isfinite(scene.restart_after):
        data['restart_after'] = scene.restart_after
    return data


def _circle(circle: Circle) -> dict[str, Any]:
    data: dict[str, Any] = {'position': list(circle.position), 'radius': circle.radius}
    if circle.locked:
        data['locked'] = True
    else:
        data |= {'velocity': list(circle.velocity), 'mass': circle.mass}
    if circle.name:
        data['name'] = circle.name
    return data


def lock(folder: Path) -> int:
    """
    Make a folder this process's own until what is returned is closed, or the process ends in whatever way.

    Raises
    ------
    BlockingIOError
        When it is somebody else's.

    """
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        raise
    except OSError:
        # Some network file systems know no locks: then nobody is kept out.
        pass
    return descriptor
