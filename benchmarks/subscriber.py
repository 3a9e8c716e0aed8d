"""
What a subscriber sees of the node, in a process of its own: `python -m benchmarks.subscriber JSON`.

It takes messages as bytes, as they come. The first line that it prints says that it hears the node, the second
what it has found.
"""

from __future__ import annotations

import json
import math
import struct
import sys
import time
from functools import partial
from itertools import pairwise
from typing import Any

import rclpy
from geometry_msgs.msg import PoseArray, PoseStamped
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import QoSProfile
from sensor_msgs.msg import PointCloud2, TimeReference

from circle_bounce_ros.kernel import Simulation
from circle_bounce_ros.scene_file import load_scene

TYPES = {kind.__name__: kind for kind in (PoseArray, PoseStamped, PointCloud2, TimeReference)}

# Where everything is in the bytes of a message whose frame is called 'world'.
STAMP = struct.Struct('<iI')
STAMP_AT = 4
POSITION = struct.Struct('<2d')
POSITION_AT = 4 + 24
TIME_REFERENCE_AT = 4 + 20

DISCOVERY = 60.0  # s
QUEUE = 1_000  # messages: a pause of this process loses none


def main() -> None:
    wanted = json.loads(sys.argv[1])
    rclpy.init(args=[])
    node = rclpy.create_node('listener')
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    heard: dict[str, list[bytes]] = {}
    for topic, kind in wanted['topics'].items():
        messages: list[bytes] = []
        heard[topic] = messages
        node.create_subscription(
            TYPES[kind],
            topic,
            partial(keep, messages),
            QoSProfile(depth=QUEUE if kind in ('PoseStamped', 'TimeReference') else 10),
            raw=True,
        )
    try:
        listen(node, executor, heard, wanted)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


def keep(messages: list[bytes], data: bytes) -> None:
    """Keep what is looked at later: a gas of 100,000 is 3 MB a message."""
    messages.append(data[:80])


def listen(node: Any, executor: Any, heard: dict[str, list[bytes]], wanted: Any) -> None:
    deadline = time.monotonic() + DISCOVERY
    while not is_heard(node, heard) and time.monotonic() < deadline:
        executor.spin_once(timeout_sec=0.1)
    settled = time.monotonic() + min(2.0, wanted['seconds'])
    while time.monotonic() < settled:
        executor.spin_once(timeout_sec=0.1)
    for messages in heard.values():
        messages.clear()
    print('listening', flush=True)
    finish = time.monotonic() + wanted['seconds']
    while time.monotonic() < finish:
        executor.spin_once(timeout_sec=0.1)
        if wanted['seconds'] > 1e6:
            for messages in heard.values():
                messages.clear()
    print(json.dumps(judge(heard, wanted)), flush=True)


def is_heard(node: Any, heard: dict[str, list[bytes]]) -> bool:
    """Return whether every topic has said something; without topics, whether the node is there."""
    if heard:
        return all(heard.values())
    return 'bounce' in node.get_node_names()


def judge(heard: dict[str, list[bytes]], wanted: Any) -> dict[str, Any]:
    """Return what the messages tell."""
    found = {
        'late': 0,
        'longest_gap_ms': 0.0,
        'arrived': 1.0,
        'real_time_factor': 1.0,
        'error': 0.0,
    }
    period = 1e9 / wanted['rate']
    for messages in heard.values():
        came = len(messages) / (wanted['seconds'] * wanted['rate'])
        found['arrived'] = min(found['arrived'], came)
    if 'time' in heard:
        # Each tick says it, and so small a message is not lost as a large one may be.
        gaps = [b - a for a, b in pairwise(map(stamp_of, heard['time']))]
        # A gap of two periods and more: a tick was late by a period.
        found['late'] = sum(gap > 2.0 * period for gap in gaps)
        found['longest_gap_ms'] = 1e-6 * max(gaps)
        first, last = heard['time'][0], heard['time'][-1]
        passed = stamp_of(last) - stamp_of(first)
        found['real_time_factor'] = (scene_time_of(last) - scene_time_of(first)) / passed
    if 'ball/pose' in heard:
        found['error'] = largest_error(heard['ball/pose'], heard['time'], wanted['scene'])
    return found


def scene_time_of(data: bytes) -> int:
    """Return the scene time that a TimeReference says, ns."""
    seconds, nanoseconds = STAMP.unpack_from(data, TIME_REFERENCE_AT)
    return int(seconds * 10**9 + nanoseconds)


def stamp_of(data: bytes) -> int:
    """Return the stamp of a message, ns."""
    seconds, nanoseconds = STAMP.unpack_from(data, STAMP_AT)
    return int(seconds * 10**9 + nanoseconds)


def largest_error(poses: list[bytes], times: list[bytes], scene: str) -> float:
    """Return how far a pose is from where the kernel has the circle at the scene time of its stamp, m."""
    scene_times = {stamp_of(data): scene_time_of(data) * 1e-9 for data in times}
    simulation = Simulation(load_scene(scene))
    error = 0.0
    compared = 0
    for data in poses:
        when = scene_times.get(stamp_of(data))
        if when is not None:
            simulation.advance_to(when)
            x, y = POSITION.unpack_from(data, POSITION_AT)
            truth = simulation.positions[0]
            error = max(error, abs(x - truth[0]), abs(y - truth[1]))
            compared += 1
    # One topic may begin or end a message before the other.
    return error if compared > 0.9 * len(poses) else math.inf


if __name__ == '__main__':
    main()
