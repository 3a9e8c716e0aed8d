"""Recordings, made and read: by readers that are not ours."""

from __future__ import annotations

import numpy as np
import pytest
from mcap.reader import make_reader
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

from circle_bounce_ros.offline.record import main

SECOND = 10**9

DTYPES = {2: 'u1', 6: '<u4', 7: '<f4', 8: '<f8'}


def read_with_rosbags(folder):
    """Return (topic, time, message) of all messages."""
    types = get_typestore(Stores.ROS2_JAZZY)
    with Reader(folder) as reader:
        return [
            (connection.topic, time, types.deserialize_cdr(data, connection.msgtype))
            for connection, time, data in reader.messages()
        ]


def read_with_mcap(folder):
    """Return the same, read by the library of the format with the definitions that are in the file."""
    decoder_of = pytest.importorskip('mcap_ros2.decoder').DecoderFactory
    (path,) = folder.glob('*.mcap')
    with path.open('rb') as file:
        reader = make_reader(file, decoder_factories=[decoder_of()])
        return [
            (channel.topic, message.log_time, decoded)
            for _, channel, message, decoded in reader.iter_decoded_messages()
        ]


def raw_with_mcap(folder):
    """Return (topic, time, bytes) of all messages in their order in the file."""
    (path,) = folder.glob('*.mcap')
    with path.open('rb') as file:
        reader = make_reader(file)
        return [
            (channel.topic, message.log_time, message.data)
            for _, channel, message in reader.iter_messages()
        ]


def nanoseconds(time):
    """Return a time, which both readers call differently, ns."""
    return time.sec * SECOND + (time.nanosec if hasattr(time, 'nanosec') else time.nsec)


def stamp_of(message):
    return nanoseconds(message.header.stamp)


def points_of(cloud):
    point = np.dtype(
        {
            'names': [field.name for field in cloud.fields],
            'formats': [DTYPES[field.datatype] for field in cloud.fields],
            'offsets': [field.offset for field in cloud.fields],
            'itemsize': cloud.point_step,
        }
    )
    return np.frombuffer(bytes(cloud.data), point)


def record(*arguments):
    assert main([str(argument) for argument in arguments]) == 0
