"""A recording as a rosbag2 of MCAP, and how to make one whole that was cut short."""

from __future__ import annotations

import shutil
import struct
from collections.abc import Callable, Collection, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Literal, NamedTuple

from mcap.exceptions import McapError
from mcap.records import Channel, Chunk, DataEnd, Message, Schema
from mcap.stream_reader import StreamReader
from rosbags.interfaces import (
    Connection,
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.metadata import parse_qos
from rosbags.typesys import Stores, get_typestore

from circle_bounce_ros.encoding.topics import (
    CONTACTS,
    Encode,
    Moment,
    Topic,
    feeds_of_a_scene,
    feeds_of_each_tick,
)
from circle_bounce_ros.kernel import Scene
from circle_bounce_ros.offline.recording import write_scene

VERSION: Literal[9] = 9  # of rosbag2's metadata, that of ROS 2 Jazzy
METADATA = 'metadata.yaml'
REPAIRING = '.repairing'
QOS_KEY = 'offered_qos_profiles'

# What ROS 2 calls a time without end: no deadline, no end of life.
FOR_EVER = QosTime(sec=9223372036, nsec=854775807)


class RepairError(ValueError):
    """Why a recording cannot be repaired, in one sentence."""


def topics_of(scene: Scene) -> list[Topic]:
    """Return all topics of a scene, as the node in clock mode has them."""
    feeds = (*feeds_of_each_tick(scene, 'world', True), *feeds_of_a_scene(scene, 'world'))
    return [topic for topic, _ in feeds]


def absolute(name: str) -> str:
    """Return the name of a topic as a node without a namespace has it."""
    return '/' + name.lstrip('/')


def qos(topic: Topic) -> Qos:
    """Return the quality of service that the node offers for a topic."""
    return Qos(
        history=QosHistory.KEEP_LAST,
        depth=topic.depth,
        reliability=QosReliability.RELIABLE,
        durability=QosDurability.TRANSIENT_LOCAL if topic.latched else QosDurability.VOLATILE,
        deadline=FOR_EVER,
        lifespan=FOR_EVER,
        liveliness=QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=FOR_EVER,
        avoid_ros_namespace_conventions=False,
    )


class Bag:
    """
    A new rosbag2.

    Parameters
    ----------
    folder : Path
        Must not exist.
    scene : Scene
    frame_id : str
    topics : collection of str, optional
        Names of those to record; by default all.
    compress : bool
        Compress chunks with zstd.

    Raises
    ------
    OSError
        When the folder cannot be made.

    """

    def __init__(
        self,
        folder: Path,
        scene: Scene,
        frame_id: str = 'world',
        topics: Collection[str] | None = None,
        compress: bool = False,
    ) -> None:
        def wanted(topic: Topic) -> bool:
            return topics is None or topic.name in topics

        self._writer = _open(folder, compress)
        write_scene(scene, folder)
        self._types = get_typestore(Stores.ROS2_JAZZY)
        self._each_tick = [
            (self._add(topic), encode)
            for topic, encode in feeds_of_each_tick(scene, frame_id, True)
            if wanted(topic)
        ]
        self._once = [
            (self._add(topic), encode)
            for topic, encode in feeds_of_a_scene(scene, frame_id)
            if wanted(topic)
        ]
        self.wants_contacts = wanted(CONTACTS)

    def _add(self, topic: Topic) -> Connection:
        return self._writer.add_connection(
            absolute(topic.name),
            topic.type,
            typestore=self._types,
            offered_qos_profiles=[qos(topic)],
        )

    def write(self, moment: Moment) -> None:
        """Write all messages of a tick; their time is their stamp."""
        self._write(self._each_tick, moment)
        once, self._once = self._once, []
        self._write(once, moment)

    def _write(self, feeds: list[tuple[Connection, Encode]], moment: Moment) -> None:
        for connection, encode in feeds:
            self._writer.write(connection, moment.stamp_ns, encode(moment))

    def close(self) -> None:
        """Write index and metadata."""
        self._writer.close()

    def abort(self) -> None:
        """Let go of the file; what is on the disk stays, for `repair`."""
        _let_go(self._writer)


def _open(folder: Path, compress: bool) -> Writer:
    writer = Writer(folder, version=VERSION, storage_plugin=StoragePlugin.MCAP)
    if compress:
        writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    writer.open()
    return writer


def _let_go(writer: Writer) -> None:
    # What is left in a buffer may have no room: that is the error already being reported.
    with suppress(OSError):
        writer.abort()


class Repaired(NamedTuple):
    """
    What a repair saved.

    Attributes
    ----------
    messages : int
    end : float, s
        Stamp of the last one.

    """

    messages: int
    end: float


def needs_repair(folder: Path) -> bool:
    """Return whether a recording was cut short: its metadata is what is written last."""
    return not (folder / METADATA).exists()


def repair(folder: Path, report: Callable[[int], None] = lambda _: None) -> Repaired:
    """
    Make a bag whole that was cut short, as by kill -9 or a full disk.

    All that can be read goes into a new file, which takes the place of the old one when it is complete.

    Parameters
    ----------
    folder : Path
    report : callable
        Told after each message how many bytes of the old file have been read.

    Raises
    ------
    RepairError
        When there is nothing to repair.
    OSError
        When there is no room, which leaves the bag as it was.

    """
    files = sorted(folder.glob('*.mcap'))
    if len(files) != 1:
        raise RepairError(f'{folder}: must hold one .mcap file, got {len(files)}')
    if not needs_repair(folder):
        raise RepairError(f'{folder}: has its {METADATA}, there is nothing to repair')
    new = folder / REPAIRING / files[0].stem
    shutil.rmtree(new.parent, ignore_errors=True)
    try:
        repaired = _copy(files[0], new, report)
        (new / files[0].name).replace(files[0])
        (new / METADATA).replace(folder / METADATA)
    finally:
        shutil.rmtree(new.parent, ignore_errors=True)
    return repaired


def _copy(old: Path, new: Path, report: Callable[[int], None]) -> Repaired:
    writer = _open(new, compress=_is_compressed(old))
    connections: dict[int, Connection] = {}
    count, last = 0, 0
    types = get_typestore(Stores.ROS2_JAZZY)
    try:
        for schema, channel, message, place in _readable(old):
            if channel.id not in connections:
                connections[channel.id] = writer.add_connection(
                    channel.topic,
                    schema.name,
                    typestore=types,
                    offered_qos_profiles=parse_qos(channel.metadata.get(QOS_KEY, '')),
                )
            writer.write(connections[channel.id], message.log_time, message.data)
            count, last = count + 1, message.log_time
            report(place)
        if not count:
            raise RepairError(f'{old}: no message in it can be read')
        writer.close()
    except BaseException:
        _let_go(writer)
        raise
    return Repaired(count, last / 1e9)


def _is_compressed(path: Path) -> bool:
    with path.open('rb') as file:
        for record in _records(StreamReader(file, emit_chunks=True)):
            if isinstance(record, Chunk):
                return bool(record.compression)
    return False


def _readable(path: Path) -> Iterator[tuple[Schema, Channel, Message, int]]:
    """Return all messages up to where the file is cut."""
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    with path.open('rb') as file:
        for record in _records(StreamReader(file)):
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Message):
                channel = channels[record.channel_id]
                yield schemas[channel.schema_id], channel, record, file.tell()


def _records(reader: StreamReader) -> Iterator[object]:
    # Up to where it was cut, however the library says so: a record that is too short, or one of nothing.
    with suppress(McapError, EOFError, struct.error, ValueError):
        for record in reader.records:
            if isinstance(record, DataEnd):
                return  # what follows is index
            yield record
