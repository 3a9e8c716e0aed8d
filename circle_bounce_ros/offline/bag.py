"""A recording as a rosbag2 of MCAP."""

from __future__ import annotations

import os
from collections.abc import Collection
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from types import MappingProxyType
from typing import Literal

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
from rosbags.rosbag2.storage_mcap import McapWriter, write_channel, write_string
from rosbags.typesys import Stores, get_typestore

from circle_bounce_ros.encoding.topics import (
    CONTACTS,
    Encode,
    Moment,
    Topic,
    feeds_of_a_scene,
    feeds_of_each_tick,
)
from circle_bounce_ros.kernel import Scene, SceneError
from circle_bounce_ros.offline.recording import SCENE_FILE, lock, scene_text

VERSION: Literal[9] = 9  # of rosbag2's metadata, that of ROS 2 Jazzy
METADATA = 'metadata.yaml'

# What rosbag2 writes about a channel.
QOS_KEY, HASH_KEY = 'offered_qos_profiles', 'topic_type_hash'

# MCAP has 65,535 channels, and rosbags looks for each of them among all.
MOST_TOPICS = 10_000

# What ROS 2 calls a time without end: no deadline, no end of life.
FOR_EVER = QosTime(sec=9223372036, nsec=854775807)


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
    SceneError
        When the scene is too large to be written beside it, or has too many named circles.

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

        text = scene_text(scene)
        count = sum(map(wanted, topics_of(scene)))
        if count > MOST_TOPICS:
            raise SceneError('topics', f'must be at most {MOST_TOPICS} in a bag, got {count}')
        self._writer = open_writer(folder, compress)
        self._lock = lock(folder)
        (folder / SCENE_FILE).write_text(text)
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
        os.close(self._lock)

    def abort(self) -> None:
        """Let go of the file; what is on the disk stays, for `repair`."""
        let_go(self._writer)
        os.close(self._lock)


class _McapWriter(McapWriter):
    """That of rosbags, with what rosbag2 writes more: the hash of a channel's type."""

    def add_connection(self, connection: Connection, offered_qos_profiles: str) -> None:
        begin = self.chunk.bio.tell()
        super().add_connection(connection, offered_qos_profiles)
        more = BytesIO()
        for text in (HASH_KEY, connection.digest):
            write_string(more, text)
        channel = self.channels[-1]
        self.channels[-1] = channel._replace(metadata=channel.metadata + more.getvalue())
        self.chunk.bio.seek(begin)
        write_channel(self.chunk.bio, self.channels[-1], self.schemas)


class _Writer(Writer):
    STORAGE_PLUGINS = MappingProxyType({StoragePlugin.MCAP: _McapWriter})


def open_writer(folder: Path, compress: bool) -> Writer:
    """Return the writer of a new bag, which may compress its chunks with zstd."""
    writer = _Writer(folder, version=VERSION, storage_plugin=StoragePlugin.MCAP)
    if compress:
        writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    writer.open()
    return writer


def let_go(writer: Writer) -> None:
    """Close the file of a bag as it stands."""
    # What is left in a buffer may have no room: that is the error already being reported.
    with suppress(OSError):
        writer.abort()
