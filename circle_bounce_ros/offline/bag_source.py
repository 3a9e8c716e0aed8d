"""A bag as what a picture is made of: from bounce_record, or from the node and `ros2 bag record`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

from circle_bounce_ros.encoding.clouds import DATATYPES
from circle_bounce_ros.encoding.topics import BODIES, CONTACTS, STATIC_MARKERS, TIME
from circle_bounce_ros.kernel import Circle, ContactKind, Scene, SceneError, Wall
from circle_bounce_ros.offline.bag import METADATA
from circle_bounce_ros.offline.parquet import CIRCLES_FILE
from circle_bounce_ros.offline.recording import SCENE_FILE
from circle_bounce_ros.offline.source import Frame, Source, SourceError, thinned
from circle_bounce_ros.scene_file import load_scene
from circle_bounce_ros.schedule.times import SECOND

DTYPES = {number: dtype for dtype, number in DATATYPES.items()}

# What visualization_msgs/Marker calls them.
CYLINDER, LINE_LIST, SPHERE_LIST = 3, 5, 7

FIELDS = ('x', 'y', 'vx', 'vy', 'radius', 'id')
NO_CONTACTS = np.zeros(0, [('x', '<f4'), ('y', '<f4'), ('kind', 'u1')])


class Message(NamedTuple):
    """A message and which of `BODIES`, `CONTACTS`, ... it is of."""

    topic: str
    content: Any


class Bag(NamedTuple):
    """
    A bag, and where in it one node speaks.

    Attributes
    ----------
    folder : Path
    namespace : str
        Ends in `/`.

    """

    folder: Path
    namespace: str

    def messages(self, *topics: str) -> Iterator[Message]:
        """
        Return all messages of some topics, in the order in which they were recorded.

        Raises
        ------
        SourceError
            For a bag that cannot be read.

        """
        types = get_typestore(Stores.ROS2_JAZZY)
        names = {self.namespace + topic: topic for topic in topics}
        try:
            with Reader(self.folder) as reader:
                wanted = [c for c in reader.connections if c.topic in names]
                if not wanted:
                    return
                for connection, _, data in reader.messages(wanted):
                    content = types.deserialize_cdr(data, connection.msgtype)
                    yield Message(names[connection.topic], content)
        except Exception as error:
            # A file of any kind may be broken in any way, and each storage says so in its own.
            raise SourceError(
                f'{self.folder}: cannot be read: {type(error).__name__}: {error}'
            ) from None


def of_bag(folder: Path, duration: float, rate: float, namespace: str | None = None) -> Source:
    """
    Return a bag as a source.

    Parameters
    ----------
    folder : Path
    duration : float, s
        At most its first so many seconds are used.
    rate : float, Hz
        At most so many instants a second are used.
    namespace : str, optional
        Of the node, where more than one was recorded.

    Raises
    ------
    SourceError
        For what is no bag of a node, or a broken one.

    """
    if (folder / CIRCLES_FILE).exists():
        raise SourceError(f'{folder}: must be a bag, got Parquet tables')
    if not (folder / METADATA).exists():
        raise SourceError(
            f'{folder}: has no {METADATA}; if its recording was cut short: '
            f'bounce_record --repair {folder}'
        )
    types = _types_in(folder)
    bag = Bag(folder, _namespace_in(folder, types, namespace))
    contacts_known = bag.namespace + CONTACTS.name in types
    scene, collide, masses_known = _scene_of(bag, contacts_known)

    def frames() -> Iterator[Frame]:
        return thinned(_frames(bag, duration), rate)

    return Source(
        folder.name,
        scene,
        frames,
        digits=float(np.finfo(np.float32).eps),
        collide=collide,
        masses_known=masses_known,
        contacts_known=contacts_known,
    )


def _types_in(folder: Path) -> dict[str, str]:
    """Return the types of all topics of which there are messages."""
    try:
        with Reader(folder) as reader:
            return {c.topic: c.msgtype for c in reader.connections if c.msgcount}
    except Exception as error:
        raise SourceError(f'{folder}: cannot be read: {type(error).__name__}: {error}') from None


def _namespace_in(folder: Path, types: dict[str, str], wanted: str | None) -> str:
    found = sorted(
        name.removesuffix(BODIES.name)
        for name, kind in types.items()
        if name.endswith(f'/{BODIES.name}') and kind == BODIES.type
    )
    if wanted is not None:
        wanted = f'/{wanted.strip("/")}/'.replace('//', '/')
        found = [name for name in found if name == wanted]
    if not found:
        raise SourceError(
            f'{folder}: must hold the topic {(wanted or "") + BODIES.name}, '
            f'got {", ".join(sorted(types)) or "none"}'
        )
    if len(found) > 1:
        raise SourceError(
            f'{folder}: namespace: must be one of {", ".join(found)}, as more than one node is in it'
        )
    return found[0]


def points_of(bag: Bag, topic: str, cloud: Any) -> NDArray[np.void]:
    """
    Return a PointCloud2 as a structured array, by its own description of its fields.

    Raises
    ------
    SourceError
        For a description that describes nothing.

    """
    order: Literal['<', '>'] = '>' if cloud.is_bigendian else '<'
    try:
        point = np.dtype(
            {
                'names': [field.name for field in cloud.fields],
                'formats': [DTYPES[field.datatype].newbyteorder(order) for field in cloud.fields],
                'offsets': [field.offset for field in cloud.fields],
                'itemsize': cloud.point_step,
            }
        )
        return np.frombuffer(cloud.data.tobytes(), point)
    except KeyError as error:
        problem = f'datatype: must be from 1 to {len(DTYPES)}, got {error}'
    except ValueError as error:
        problem = f'its fields do not describe its data: {error}'
    raise SourceError(f'{bag.folder}: {bag.namespace}{topic}: {problem}')


def _nanoseconds(time: Any) -> int:
    return int(time.sec) * SECOND + int(time.nanosec)


class _Timeline:
    """
    Seconds since the first frame, by the clock of the scene where the bag holds it, else by the stamps.

    The node's clock and that of its scene differ: when it is paused, slowed down or reset.
    """

    def __init__(self) -> None:
        self._scene_ns: dict[int, int] = {}
        self._last: tuple[int, int | None] | None = None
        self._now_ns = 0

    def learn(self, reference: Any) -> None:
        """Take note of a message on `time`."""
        self._scene_ns[_nanoseconds(reference.header.stamp)] = _nanoseconds(reference.time_ref)

    def advance(self, stamp: int) -> float:
        """Go on to a stamp, ns, and return the time there, s."""
        scene = self._scene_ns.get(stamp)
        self._scene_ns = {s: ns for s, ns in self._scene_ns.items() if s > stamp}
        if self._last is not None:
            last_stamp, last_scene = self._last
            if scene is None or last_scene is None:
                step = stamp - last_stamp
            else:
                # Below zero it has started again.
                step = scene - last_scene if scene >= last_scene else scene
            self._now_ns += max(0, step)
        self._last = (stamp, scene)
        return self._now_ns / SECOND


def _frames(bag: Bag, duration: float) -> Iterator[Frame]:
    timeline = _Timeline()
    first: NDArray[np.void] | None = None
    for bodies, contacts in _ticks(bag, timeline):
        points = _points_of_bodies(bag, bodies)
        time = timeline.advance(_nanoseconds(bodies.header.stamp))
        if time > duration:
            return
        first = points if first is None else first
        if not all(np.array_equal(points[name], first[name]) for name in ('id', 'radius')):
            raise SourceError(
                f'{bag.folder}: another scene begins at {time:.9g} s: take a shorter --duration'
            )
        positions = np.column_stack([points['x'], points['y']]).astype(np.float64)
        velocities = np.column_stack([points['vx'], points['vy']]).astype(np.float64)
        yield Frame(time, positions, velocities, np.concatenate(contacts))


def _ticks(bag: Bag, timeline: _Timeline) -> Iterator[tuple[Any, list[NDArray[np.void]]]]:
    """Return each message on `bodies` with all contacts that came until the next one."""
    bodies: Any = None
    contacts = [NO_CONTACTS]
    for topic, content in bag.messages(BODIES.name, CONTACTS.name, TIME.name):
        if topic == TIME.name:
            timeline.learn(content)
        elif topic == CONTACTS.name:
            contacts.append(_points_of_contacts(bag, content))
        else:
            if bodies is not None:
                yield bodies, contacts
                contacts = [NO_CONTACTS]
            bodies = content
    if bodies is not None:
        yield bodies, contacts


def _points_of_bodies(bag: Bag, cloud: Any) -> NDArray[np.void]:
    points = points_of(bag, BODIES.name, cloud)
    missing = [name for name in FIELDS if name not in (points.dtype.names or ())]
    if missing:
        raise SourceError(
            f'{bag.folder}: {bag.namespace}{BODIES.name}: must have the fields {", ".join(FIELDS)}, '
            f'lacks {", ".join(missing)}'
        )
    return points


def _points_of_contacts(bag: Bag, cloud: Any) -> NDArray[np.void]:
    points = points_of(bag, CONTACTS.name, cloud)
    contacts = np.zeros(len(points), NO_CONTACTS.dtype)
    for name in NO_CONTACTS.dtype.names or ():
        if name not in (points.dtype.names or ()):
            raise SourceError(
                f'{bag.folder}: {bag.namespace}{CONTACTS.name}: lacks the field {name}'
            )
        contacts[name] = points[name]
    return contacts


def _scene_of(bag: Bag, contacts_known: bool) -> tuple[Scene, bool, bool]:
    """Return the scene of a bag, whether its moving circles hit each other, and whether masses are known."""
    if (bag.folder / SCENE_FILE).exists():
        scene = load_scene(bag.folder / SCENE_FILE)
        return scene, scene.moving_circles_collide, True
    _, bodies = next(bag.messages(BODIES.name))
    circles = [
        Circle((p['x'], p['y']), (p['vx'], p['vy']), radius=float(p['radius']))
        for p in _points_of_bodies(bag, bodies)
    ]
    walls, locked = _what_stands_still(bag)
    try:
        # Rounded to float32 they may overlap a little, which is no fault here.
        scene = Scene([*circles, *locked], walls, moving_circles_collide=False)
    except SceneError as error:
        raise SourceError(f'{bag.folder}: {error}') from None
    return scene, not contacts_known or _has_pairs(bag), False


def _what_stands_still(bag: Bag) -> tuple[list[Wall], list[Circle]]:
    """Return walls and locked circles as the first message on `markers/static` shows them."""
    walls: list[Wall] = []
    locked: list[Circle] = []
    for _, array in bag.messages(STATIC_MARKERS.name):
        for marker in array.markers:
            spots = [(p.x, p.y) for p in marker.points]
            radius = marker.scale.x / 2.0
            if marker.type == LINE_LIST:
                walls += [Wall(*ends) for ends in zip(spots[::2], spots[1::2], strict=True)]
            elif marker.type == SPHERE_LIST:
                locked += [Circle(spot, radius=radius, locked=True) for spot in spots]
            elif marker.type == CYLINDER:
                at = marker.pose.position
                locked.append(Circle((at.x, at.y), radius=radius, locked=True))
        break
    return walls, locked


def _has_pairs(bag: Bag) -> bool:
    """Return whether any contact is one of two moving circles."""
    return any(
        (_points_of_contacts(bag, cloud)['kind'] == ContactKind.CIRCLE).any()
        for _, cloud in bag.messages(CONTACTS.name)
    )
