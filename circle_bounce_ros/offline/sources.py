"""What a picture is made of: the states of a scene that is run now, or of a bag."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rosbags.rosbag2 import Reader, ReaderError
from rosbags.typesys import Stores, get_typestore

from circle_bounce_ros.encoding.stamps import SECOND, kernel_time
from circle_bounce_ros.kernel import Circle, Scene, SceneError, Simulation, Wall
from circle_bounce_ros.offline.bag import METADATA
from circle_bounce_ros.offline.recording import SCENE_FILE, moments
from circle_bounce_ros.offline.ticks import Ticks
from circle_bounce_ros.scene_file import load_scene

# What sensor_msgs/PointField calls them.
DATATYPES = {2: 'u1', 6: '<u4', 7: '<f4', 8: '<f8'}

# What visualization_msgs/Marker calls them.
CYLINDER, LINE_LIST, SPHERE_LIST = 3, 5, 7


class SourceError(ValueError):
    """Why a picture cannot be made of something, in one sentence."""


class Frame(NamedTuple):
    """
    One instant.

    Attributes
    ----------
    time : float, s
    positions : (n, 2) float, m
    velocities : (n, 2) float, m/s
    contacts : (k,) structured array
        Since the last frame, with at least `x`, `y` and `kind`.

    """

    time: float
    positions: NDArray[np.float64]
    velocities: NDArray[np.float64]
    contacts: NDArray[np.void]


@dataclass(frozen=True)
class Source:
    """
    What a picture is made of.

    Attributes
    ----------
    name : str
    scene : Scene
        What stands still, radii and masses. Of a bag without its scene, circles are where they were first
        seen and have 1 kg.
    frames : callable
        Returns the frames from the first on.
    digits : float
        Relative error of one number in a frame.
    masses_known : bool

    """

    name: str
    scene: Scene
    frames: Callable[[], Iterator[Frame]]
    digits: float
    masses_known: bool = True

    @property
    def moving(self) -> list[Circle]:
        """The circles that move."""
        return [circle for circle in self.scene.circles if not circle.locked]

    @property
    def masses(self) -> NDArray[np.float64]:
        """(n,), kg."""
        return np.array([circle.mass for circle in self.moving])


def open_source(text: str, duration: float, rate: float, seed: int | None) -> Source:
    """
    Return a scene as a source, or a bag if there is a folder of that name.

    Raises
    ------
    SourceError, SceneError
        For what is neither, or is broken.

    """
    if Path(text).is_dir():
        return of_bag(Path(text), duration)
    scene = load_scene(text, seed)
    try:
        ticks = Ticks(rate, duration, scene.restart_after)
    except ValueError as error:
        raise SourceError(str(error)) from None

    def frames() -> Iterator[Frame]:
        simulation = Simulation(scene, record_contacts=True)
        nothing = simulation.drain_contacts()
        yield Frame(0.0, simulation.positions, simulation.velocities, nothing)
        for moment in moments(simulation, ticks):
            state = moment.state
            time = kernel_time(moment.stamp_ns)
            yield Frame(time, state.positions, state.velocities, state.contacts)

    return Source(scene.name, scene, frames, float(np.finfo(np.float64).eps))


def of_bag(folder: Path, duration: float) -> Source:
    """Return a bag as a source, of which at most the first `duration` seconds are used."""
    if not (folder / METADATA).exists():
        raise SourceError(
            f'{folder}: has no {METADATA}; if its recording was cut short: '
            f'bounce_record --repair {folder}'
        )
    try:
        with Reader(folder) as reader:
            names = {connection.topic for connection in reader.connections}
        bodies = _topic(names, 'bodies', folder)
        contacts = next((name for name in sorted(names) if _is(name, 'contacts')), None)
        scene, known = _scene_of(folder, names, bodies)
    except ReaderError as error:
        raise SourceError(f'{folder}: {error}') from None

    def frames() -> Iterator[Frame]:
        return _frames(folder, bodies, contacts, duration)

    return Source(folder.name, scene, frames, float(np.finfo(np.float32).eps), known)


def _is(name: str, kind: str) -> bool:
    return name.rsplit('/', 1)[1] == kind


def _topic(names: set[str], kind: str, folder: Path) -> str:
    for name in sorted(names):
        if _is(name, kind):
            return name
    raise SourceError(f'{folder}: must hold the topic {kind}, got {", ".join(sorted(names))}')


def _messages(folder: Path, topics: list[str]) -> Iterator[tuple[str, int, Any]]:
    types = get_typestore(Stores.ROS2_JAZZY)
    with Reader(folder) as reader:
        wanted = [c for c in reader.connections if c.topic in topics]
        for connection, stamp, data in reader.messages(wanted):
            yield connection.topic, stamp, types.deserialize_cdr(data, connection.msgtype)


def points_of(cloud: Any) -> NDArray[np.void]:
    """Return a PointCloud2 as a structured array, by its own description of its fields."""
    point = np.dtype(
        {
            'names': [field.name for field in cloud.fields],
            'formats': [DATATYPES[field.datatype] for field in cloud.fields],
            'offsets': [field.offset for field in cloud.fields],
            'itemsize': cloud.point_step,
        }
    )
    return np.frombuffer(cloud.data.tobytes(), point)


def _stamp_ns(message: Any) -> int:
    return int(message.header.stamp.sec) * SECOND + int(message.header.stamp.nanosec)


NO_CONTACTS = np.zeros(0, [('x', '<f4'), ('y', '<f4'), ('kind', 'u1')])


def _frames(folder: Path, bodies: str, contacts: str | None, duration: float) -> Iterator[Frame]:
    topics = [bodies, contacts] if contacts else [bodies]
    first: int | None = None
    waiting: tuple[int, NDArray[np.void]] | None = None
    between: list[NDArray[np.void]] = []
    for topic, _, message in _messages(folder, topics):
        if topic == contacts:
            between.append(points_of(message))
            continue
        if waiting:
            yield _frame(waiting, first or 0, between)
            between = []
        stamp = _stamp_ns(message)
        first = stamp if first is None else first
        if stamp - first > duration * SECOND:
            return
        waiting = (stamp, points_of(message))
    if waiting:
        yield _frame(waiting, first or 0, between)


def _frame(
    waiting: tuple[int, NDArray[np.void]], first: int, between: list[NDArray[np.void]]
) -> Frame:
    stamp, points = waiting
    contacts = np.concatenate(between) if between else NO_CONTACTS
    positions = np.column_stack([points['x'], points['y']]).astype(np.float64)
    velocities = np.column_stack([points['vx'], points['vy']]).astype(np.float64)
    return Frame((stamp - first) / SECOND, positions, velocities, contacts)


def _scene_of(folder: Path, names: set[str], bodies: str) -> tuple[Scene, bool]:
    """Return the scene of a bag, and whether its masses are known."""
    if (folder / SCENE_FILE).exists():
        return load_scene(folder / SCENE_FILE), True
    points = points_of(next(_messages(folder, [bodies]))[2])
    circles = [
        Circle((p['x'], p['y']), (p['vx'], p['vy']), radius=float(p['radius'])) for p in points
    ]
    walls: list[Wall] = []
    statics = [name for name in names if name.endswith('markers/static')]
    for _, _, array in _messages(folder, statics):
        for marker in array.markers:
            spots = [(p.x, p.y) for p in marker.points]
            radius = marker.scale.x / 2.0
            if marker.type == LINE_LIST:
                walls += [Wall(*ends) for ends in zip(spots[::2], spots[1::2], strict=True)]
            elif marker.type == SPHERE_LIST:
                circles += [Circle(spot, radius=radius, locked=True) for spot in spots]
            elif marker.type == CYLINDER:
                at = marker.pose.position
                circles.append(Circle((at.x, at.y), radius=radius, locked=True))
    try:
        # Rounded to float32 they may overlap a little, which is no fault here.
        return Scene(circles, walls, moving_circles_collide=False), False
    except SceneError as error:
        raise SourceError(f'{folder}: {error}') from None
