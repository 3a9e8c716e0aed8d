"""How to make a bag whole that was cut short, as by kill -9 or a full disk."""

from __future__ import annotations

import os
import shutil
import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

from mcap.exceptions import McapError
from mcap.records import Channel, Chunk, DataEnd, Message, Schema
from mcap.stream_reader import StreamReader
from rosbags.interfaces import Connection
from rosbags.rosbag2.metadata import parse_qos
from rosbags.typesys import Stores, get_typestore

from circle_bounce_ros.offline.bag import METADATA, let_go, lock, open_writer

REPAIRING = '.repairing'
QOS_KEY = 'offered_qos_profiles'


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


def _copy(old: Path, new: Path, report: Callable[[int], None]) -> Repaired:
    writer = open_writer(new, compress=_is_compressed(old))
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
        let_go(writer)
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
