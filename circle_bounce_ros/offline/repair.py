"""How to make a bag whole that was cut short, as by kill -9 or a full disk."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from mcap.records import Channel, Chunk, DataEnd, Message, Schema
from mcap.stream_reader import StreamReader
from rosbags.interfaces import Connection
from rosbags.rosbag2 import Writer
from rosbags.rosbag2.metadata import parse_qos
from rosbags.typesys import Stores, get_typestore

from circle_bounce_ros.offline.bag import HASH_KEY, METADATA, QOS_KEY, let_go, open_writer
from circle_bounce_ros.offline.files import remove_begun
from circle_bounce_ros.offline.parquet import CIRCLES_FILE
from circle_bounce_ros.offline.recording import lock

REPAIRING = '.repairing'
ENCODINGS = ('ros2msg', 'ros2idl')


class RepairError(ValueError):
    """Why a recording cannot be repaired, in one sentence."""


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """
    Make a folder this process's own for a while.

    Raises
    ------
    RepairError
        When a recording is still at work there.

    """
    try:
        descriptor = lock(folder)
    except BlockingIOError:
        raise RepairError(f'{folder}: is still being recorded, nothing was touched') from None
    try:
        yield
    finally:
        os.close(descriptor)


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
        When there is nothing to repair, or somebody is still at work there.
    OSError
        When there is no room, which leaves the bag as it was.

    """
    files = sorted(folder.glob('*.mcap'))
    if len(files) != 1:
        raise RepairError(f'{folder}: must hold one .mcap file, got {len(files)}')
    new = folder / REPAIRING / files[0].stem
    with locked(folder):
        if not needs_repair(folder):
            raise RepairError(f'{folder}: has its {METADATA}, there is nothing to repair')
        shutil.rmtree(new.parent, ignore_errors=True)
        try:
            repaired = _copy(files[0], new, report)
            (new / files[0].name).replace(files[0])
            (new / METADATA).replace(folder / METADATA)
        finally:
            shutil.rmtree(new.parent, ignore_errors=True)
    return repaired


def clean(folder: Path) -> None:
    """
    Remove the part of a table that kill -9 or a full disk has left unfinished; all others are whole.

    Raises
    ------
    RepairError
        When somebody is still at work there.

    """
    with locked(folder):
        remove_begun(folder)


def is_of_tables(folder: Path) -> bool:
    """Return whether a folder is a recording as Parquet tables."""
    return (folder / CIRCLES_FILE).exists()


def _copy(old: Path, new: Path, report: Callable[[int], None]) -> Repaired:
    writer = open_writer(new, compress=_is_compressed(old))
    connections: dict[tuple[str, ...], Connection] = {}
    count, last = 0, 0
    try:
        for schema, channel, message, place in _readable(old):
            key = (
                channel.topic,
                schema.name,
                channel.message_encoding,
                *channel.metadata.values(),
            )
            if key not in connections:
                try:
                    connections[key] = _add(writer, schema, channel)
                except Exception as error:
                    # What is wrong there has the error of whichever library meets it first.
                    reason = ' '.join(str(error).split())
                    raise RepairError(f'{old}: the topic {channel.topic}: {reason}') from None
            writer.write(connections[key], message.log_time, message.data)
            count, last = count + 1, message.log_time
            report(place)
        if not count:
            raise RepairError(f'{old}: no message in it can be read')
        writer.close()
    except BaseException:
        let_go(writer)
        raise
    return Repaired(count, last / 1e9)


def _add(writer: Writer, schema: Schema, channel: Channel) -> Connection:
    """Add a topic as it is in the old file, of whatever type."""
    if schema.encoding not in ENCODINGS:
        raise ValueError(f'must be defined as {" or ".join(ENCODINGS)}, got {schema.encoding}')
    known = channel.metadata.get(HASH_KEY)
    types = get_typestore(Stores.ROS2_JAZZY)
    if not known and schema.name not in types.types:
        # So recorders wrote until 2023, and ours until 0.1.0.
        raise ValueError(f'must have the hash of its type, got none for {schema.name}')
    return writer.add_connection(
        channel.topic,
        schema.name,
        msgdef=schema.data.decode(),
        rihs01=known or types.hash_rihs01(schema.name),
        serialization_format=channel.message_encoding,
        offered_qos_profiles=parse_qos(channel.metadata.get(QOS_KEY, '')),
    )


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
            elif isinstance(record, Message) and record.channel_id in channels:
                channel = channels[record.channel_id]
                if channel.schema_id in schemas:
                    yield schemas[channel.schema_id], channel, record, file.tell()


def _records(reader: StreamReader) -> Iterator[object]:
    """Return all records up to where the file is cut."""
    try:
        for record in reader.records:
            if isinstance(record, DataEnd):
                return  # what follows is index
            yield record
    except OSError:
        raise
    except Exception:
        # A record that is too short, or one of nothing, has the error of whichever library meets it first.
        return
