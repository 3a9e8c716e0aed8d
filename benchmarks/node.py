"""
The node over real DDS, with a subscriber in another process: `python -m benchmarks.node [--short] [--soak SECONDS]`.

Numbers go into node.json (and soak.json) of docs/benchmarks.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from benchmarks import machine, results
from benchmarks.rows import row
from circle_bounce_ros.kernel import compile_ahead
from tools.run import PROGRAMS

Row = dict[str, Any]

# The density of the packaged gas: 1,000 disks in 10 m x 10 m.
AREA = 0.1  # m^2 a disk

GAS = """\
groups:
  - count: {count}
    packing: 0.3
    speed: {{maxwell: 1.0}}
    region: {{min: [-{half}, -{half}], max: [{half}, {half}]}}
walls:
  - box: {{min: [-{half}, -{half}], max: [{half}, {half}]}}
"""

NAMED = """\
circles:
  - {name: ball, position: [-0.5, 0.1], velocity: [1.3, 0.7], radius: 0.1}
  - {name: post, position: [0.5, 0.0], radius: 0.3, locked: true}
walls:
  - box: {min: [-1.0, -1.0], max: [1.0, 1.0]}
"""

DISCOVERY = 60.0  # s
PAUSE = 1.0  # s, many times what fills the queue of a subscriber that does not listen


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        '--short', action='store_true', help='small and quick, to see that it runs'
    )
    parser.add_argument('--seconds', type=float, default=60.0, help='how long to watch a load')
    parser.add_argument('--soak', type=float, default=0.0, help='only the memory, so many seconds')
    parser.add_argument('--into', type=Path, default=results.FOLDER)
    arguments = parser.parse_args()
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
    os.environ.setdefault('ROS_DOMAIN_ID', str(1 + os.getpid() % 100))
    compile_ahead()
    if arguments.soak:
        rows = soak(200 if arguments.short else 10_000, arguments.soak)
    else:
        rows = loads(1.0 if arguments.short else arguments.seconds, short=arguments.short)
    part = 'soak' if arguments.soak else 'node'
    path = results.save(part, {'machine': machine.describe(), 'rows': rows}, arguments.into)
    print(f'written to {path}')


# ------------------------------------------------------------------ loads


def loads(seconds: float, short: bool) -> list[Row]:
    """Return the lines of the table."""
    small, large, huge = (50, 100, 200) if short else (1_000, 10_000, 100_000)
    scene_time = {'time': 'TimeReference'}
    both = {'poses': 'PoseArray', 'bodies': 'PointCloud2', **scene_time}
    rows = []
    for count, least, aim in ((small, 10, 5), (large, 35, 15)):
        seen = watch(gas(count), 60.0, both, seconds)
        name = f'{count:,} disks, poses and bodies at 60 Hz'
        rows.append(share_of_a_core(name, seen, least, aim))
        rows.append(lateness(name, seen))
    seen = watch(gas(huge), 30.0, {'bodies': 'PointCloud2', **scene_time}, seconds)
    name = f'{huge:,} disks, bodies at 30 Hz'
    rows.append(share_of_a_core(name, seen, 100, 60))
    rows.append(row(name, 'scene time by real time', [seen['real_time_factor']], '', 0.99))
    seen = watch(gas(large), 60.0, {}, seconds / 4.0)
    rows.append(share_of_a_core(f'{large:,} disks, nobody listens', seen, None, None))
    rows.append(encoding(10 if short else 10_000, 3 if short else 20))
    seen = watch(NAMED, 1_000.0, {'ball/pose': 'PoseStamped', **scene_time}, seconds / 3.0)
    name = 'one named circle at 1,000 Hz'
    rows.append(row(name, 'messages that came', [100.0 * seen['arrived']], '%', 99.9))
    rows.append(
        row(name, 'largest error of a position', [seen['error']], 'm', 0.0, more_is_better=False)
    )
    rows.append(share_of_a_core(name, seen, None, None))
    return rows


def gas(count: int) -> str:
    """Return the scene file of a gas like the packaged one, of another size."""
    return GAS.format(count=count, half=math.sqrt(count * AREA) / 2.0)


def share_of_a_core(
    name: str, seen: dict[str, Any], least: float | None, aim: float | None
) -> Row:
    """Return the line of what the node costs; what it could not do in time is added."""
    percent = [share / seen['real_time_factor'] for share in seen['cpu_percent']]
    note = f'{100.0 * seen["arrived"]:.2f} % of the messages came' if seen['subscribed'] else ''
    return row(name, 'CPU', percent, '% of a core', least, aim, False, note)


def lateness(name: str, seen: dict[str, Any]) -> Row:
    """Return the line of ticks that came more than a period late."""
    note = f'longest gap {seen["longest_gap_ms"]:.1f} ms, real-time factor {seen["real_time_factor"]:.4f}'
    return row(
        name, 'ticks late by a period', [seen['late']], 'ticks', 0, more_is_better=False, note=note
    )


def watch(scene: str, rate: float, topics: dict[str, str], seconds: float) -> dict[str, Any]:
    """
    Run the node with a subscriber in another process.

    Returns
    -------
    dict
        `cpu_percent`, of a core, of each tenth of the time; what `benchmarks.subscriber` has found.

    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / 'scene.yaml'
        path.write_text(scene)
        with running_node(path, rate) as node, subscriber(path, rate, topics, seconds) as listener:
            assert listener.stdout is not None
            listener.stdout.readline()  # it hears the node
            cpu = []
            for _ in range(10):
                before, began = cpu_time(node.pid), time.monotonic()
                time.sleep(seconds / 10.0)
                passed = time.monotonic() - began
                cpu.append(100.0 * (cpu_time(node.pid) - before) / passed)
            found: dict[str, Any] = json.loads(listener.stdout.readline())
    return {'cpu_percent': cpu, 'subscribed': bool(topics), **found}


@contextmanager
def running_node(scene: Path, rate: float) -> Iterator[subprocess.Popen[bytes]]:
    """Run the node; it must end well, too."""
    options = ['-p', f'scene:={scene}', '-p', f'rate:={rate}', '--log-level', 'warn']
    command = [sys.executable, '-m', 'circle_bounce_ros.ros.main', '--ros-args', *options]
    node = subprocess.Popen(command, env={**PROGRAMS['bounce_node'], **os.environ})
    try:
        yield node
    finally:
        end(node)


@contextmanager
def subscriber(
    scene: Path, rate: float, topics: dict[str, str], seconds: float
) -> Iterator[subprocess.Popen[str]]:
    """Run benchmarks.subscriber."""
    wanted = {'scene': str(scene), 'rate': rate, 'topics': topics, 'seconds': seconds}
    command = [sys.executable, '-m', 'benchmarks.subscriber', json.dumps(wanted)]
    listener = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        yield listener
    finally:
        listener.kill()
        listener.wait()
        assert listener.stdout is not None
        listener.stdout.close()


def end(process: subprocess.Popen[bytes]) -> None:
    """Ask a process to end, and make sure."""
    process.send_signal(signal.SIGINT)
    try:
        process.wait(10.0)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def cpu_time(pid: int) -> float:
    """Return the CPU time that a process has had, s."""
    # Of each thread, to the nanosecond; threads that have ended since do not count, the node has none.
    threads = Path(f'/proc/{pid}/task').glob('*/schedstat')
    return sum(int(thread.read_text().split()[0]) for thread in threads) * 1e-9


def resident(pid: int) -> int:
    """Return the memory that a process holds, bytes."""
    pages = int(Path(f'/proc/{pid}/statm').read_text().split()[1])
    return pages * os.sysconf('SC_PAGE_SIZE')


# ------------------------------------------------------------------ the cost of a message


def encoding(count: int, rounds: int) -> Row:
    """Return the line of `poses`: build and publish, the ordinary way and ours, with somebody listening."""
    import numpy as np
    import rclpy
    from geometry_msgs.msg import Point, Pose, PoseArray

    from circle_bounce_ros.encoding import PoseArrayEncoder

    positions = np.random.default_rng(1).random((count, 2))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / 'scene.yaml'
        path.write_text(NAMED)
        rclpy.init(args=[])
        node = rclpy.create_node('bounce')
        publisher = node.create_publisher(PoseArray, 'poses', 10)
        with subscriber(path, 1.0, {'poses': 'PoseArray'}, 1e9):
            deadline = time.monotonic() + DISCOVERY
            while publisher.get_subscription_count() == 0:
                if time.monotonic() > deadline:
                    raise TimeoutError('nobody subscribed')
                time.sleep(0.01)
            encoder = PoseArrayEncoder('world', count)
            pairs = []
            for _ in range(rounds):
                began = time.process_time()
                message = PoseArray()
                message.header.frame_id = 'world'
                message.poses = [Pose(position=Point(x=x, y=y)) for x, y in positions.tolist()]
                publisher.publish(message)
                built = time.process_time() - began
                began = time.process_time()
                for number in range(100):
                    publisher.publish(encoder.encode(number, positions))
                pairs.append((built, (time.process_time() - began) / 100.0))
        node.destroy_node()
        rclpy.try_shutdown()
    ordinary, ours = (1e3 * statistics.median(costs) for costs in zip(*pairs, strict=True))
    note = f'{ours:.3g} against {ordinary:.3g} ms'
    return row(
        f'poses of {count:,}: build and publish',
        'rclpy, message by message',
        [a / b for a, b in pairs],
        'x cheaper',
        300,
        1_000,
        note=note,
    )


# ------------------------------------------------------------------ memory


def soak(count: int, seconds: float) -> list[Row]:
    """
    Return the line of the memory's growth under load; the first tenth of the time is for settling down.

    The middleware keeps up to ten messages of each topic for a subscriber that is slow, and the room for them
    once it has had it: 8 MB here. So the subscriber is slow for a moment first; else the day's first pause of the
    machine would count as growth.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / 'scene.yaml'
        path.write_text(gas(count))
        topics = {'poses': 'PoseArray', 'bodies': 'PointCloud2'}
        with running_node(path, 60.0) as node, subscriber(path, 60.0, topics, 1e9) as listener:
            assert listener.stdout is not None
            listener.stdout.readline()
            listener.send_signal(signal.SIGSTOP)
            time.sleep(PAUSE)
            listener.send_signal(signal.SIGCONT)
            memory = []
            for _ in range(100):
                time.sleep(seconds / 100.0)
                memory.append(resident(node.pid) / 2**20)
    start, finish = statistics.median(memory[10:20]), statistics.median(memory[-10:])
    name = f'{count:,} disks, poses and bodies at 60 Hz, {seconds / 60.0:.0f} minutes'
    note = f'{start:.1f} MiB at first, {finish:.1f} MiB in the end'
    return [row(name, 'growth of memory', [finish - start], 'MiB', 1, None, False, note)]


if __name__ == '__main__':
    main()
