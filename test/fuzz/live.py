"""Odd input for the node and the viewer in processes of their own, over real DDS and a real web socket."""

import asyncio
import os

import aiohttp
from diagnostic_msgs.msg import DiagnosticArray
from inputs import GOOD_SCENE, PIECES, damage, socket_message, yaml_file
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from sensor_msgs.msg import PointCloud2, TimeReference
from std_srvs.srv import SetBool, Trigger
from targets import good_messages
from viewing import connected
from visualization_msgs.msg import MarkerArray

NAMES = ['scene', 'seed', 'rate', 'time_scale', 'start_paused', 'publish_clock', 'frame_id']
NAMES += ['use_sim_time', 'nosuch', '', 'a' * 1000, 'ü', 'qos_overrides./time.publisher.depth']
NUMBERS = [0, 1, -1, 2, 60, 2**63 - 1, -(2**63), 10**6]
FLOATS = [0.0, 1.0, 0.1, 1000.0, 1e-300, 1e308, -1.0, float('inf'), float('nan'), 33.3]
TEXTS = ['lesson', 'gas', 'pegboard', 'nosuch', '', '.', '/', '/dev/zero', '/dev/stdin', 'x.yaml']
TEXTS += ['a' * 5000 + '/', '/proc/self/mem', '~/x.yaml', 'a\nb/', 'ü/\U0001f534', *PIECES]


def value(rng, texts):
    """Return the value of a parameter, of any type there is or none, and of any size."""
    return ParameterValue(
        type=rng.choice([1, 2, 3, 4, 4, 4, *range(12), 255]),
        bool_value=rng.random() < 0.5,
        integer_value=rng.choice(NUMBERS),
        double_value=rng.choice(FLOATS),
        string_value=rng.choice(texts).replace('\0', ''),
        byte_array_value=[b'\0'] * rng.choice([0, 3]),
        integer_array_value=[1] * rng.choice([0, 10_000]),
        double_array_value=[0.5] * rng.choice([0, 2]),
        string_array_value=['x'] * rng.choice([0, 2]),
    )


def requests(rng, texts, count):
    """Yield service types, names and requests."""
    for _ in range(count):
        names = rng.choices(NAMES, k=rng.choice([0, 1, 1, 1, 2, 5]))
        parameters = [Parameter(name=name, value=value(rng, texts)) for name in names]
        yield rng.choice(
            [
                (SetParameters, 'set_parameters', SetParameters.Request(parameters=parameters)),
                (
                    SetParametersAtomically,
                    'set_parameters_atomically',
                    SetParametersAtomically.Request(parameters=parameters),
                ),
                (GetParameters, 'get_parameters', GetParameters.Request(names=names)),
                (
                    DescribeParameters,
                    'describe_parameters',
                    DescribeParameters.Request(names=names),
                ),
                (
                    ListParameters,
                    'list_parameters',
                    ListParameters.Request(prefixes=names, depth=rng.choice([0, 1, 2**63])),
                ),
                (Trigger, rng.choice(['reset', 'step']), Trigger.Request()),
                (SetBool, 'pause', SetBool.Request(data=rng.random() < 0.5)),
            ]
        )


def scene_files(rng, folder):
    """Return the paths of odd scene files, and of what is no file."""
    paths = [folder / f'scene{number}.yaml' for number in range(8)]
    for path in paths[2:]:
        path.write_bytes(yaml_file(GOOD_SCENE, rng))
    paths[0].write_text('circles: [{name: "\\U00110000", position: [0, 0], radius: 0.1}]\n')
    os.mkfifo(paths[1])
    return [str(path) for path in [*paths, folder]]


def node(rng, folder, observer, process, count):
    """Check that the node answers every request, and logs no fault of its own."""
    texts = TEXTS + 2 * scene_files(rng, folder)
    for kind, name, request in requests(rng, texts, count):
        (folder / 'request').write_text(f'{name} {request}')
        observer.call(kind, f'/bounce/{name}', request)
        assert process.process.poll() is None, process.log
    assert observer.reset().success
    assert 'Traceback' not in process.log, process.log


def odd_publishers(observer):
    """Return a publisher for each topic that the viewer reads, and a good message for it."""
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    types = {'bodies': PointCloud2, 'contacts': PointCloud2, 'time': TimeReference}
    found = {
        channel: (observer.node.create_publisher(kind, channel, 10), good_messages()[channel])
        for channel, kind in types.items()
    }
    static = observer.node.create_publisher(MarkerArray, 'markers/static', latched)
    found['static'] = static, good_messages()['static']
    diagnostics = observer.node.create_publisher(DiagnosticArray, '/diagnostics', 10)
    found['diagnostics'] = diagnostics, bytes(serialize_message(DiagnosticArray()))
    return found


def viewer(rng, folder, observer, address, process, count):
    """Check that the viewer takes any bytes on topics and sockets, and greets the next page as ever."""
    publishers = odd_publishers(observer)
    observer.spin_until(
        lambda: all(
            publisher.get_subscription_count()
            for channel, (publisher, _) in publishers.items()
            if channel != 'contacts'
        ),
        'the viewer listens',
    )
    for _ in range(count):
        for publisher, good in publishers.values():
            publisher.publish(damage(good, rng))
    asyncio.run(visit(rng, folder, address, count))
    for publisher, _ in publishers.values():
        observer.node.destroy_publisher(publisher)
    assert process.process.poll() is None, process.log
    assert 'Traceback' not in process.log, process.log


async def visit(rng, folder, address, count):
    """Say odd things on sockets, each until the viewer closes it, and be greeted after all of them."""
    for _ in range(count):
        async with connected(address) as page:
            await page.say(type='select', circle=0)
            for _ in range(5):
                message = socket_message(rng)
                (folder / 'message').write_text(repr(message))
                try:
                    if isinstance(message, bytes):
                        await page.socket.send_bytes(message)
                    else:
                        await page.socket.send_str(message)
                except (ConnectionError, aiohttp.ClientError):
                    break
    async with connected(address) as page:
        await page.said(type='hello')
