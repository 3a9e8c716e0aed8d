"""What a test needs to watch the node from outside."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import rclpy
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import PointField
from std_srvs.srv import SetBool, Trigger

REPOSITORY = Path(__file__).parents[2]
SECOND = 10**9  # ns
PATIENCE = 20.0  # s; only a fault takes that long

# The ROS wheels import lark, whose warning about Python's sre_* modules is none of ours.
with warnings.catch_warnings():
    warnings.simplefilter('ignore', DeprecationWarning)
    import rosidl_generator_py  # noqa: F401

NOT_OURS = ("module 'sre_parse' is deprecated", "module 'sre_constants' is deprecated")
WARNINGS = ['-W', 'error', *(f'-Wignore:{text}:DeprecationWarning' for text in NOT_OURS)]

DTYPES = {
    PointField.UINT8: np.uint8,
    PointField.UINT32: np.uint32,
    PointField.FLOAT32: np.float32,
    PointField.FLOAT64: np.float64,
}


def nanoseconds(stamp):
    return stamp.sec * SECOND + stamp.nanosec


def stamps(messages):
    return [nanoseconds(message.header.stamp) for message in messages]


def scene_times(time_references):
    """Return the scene time of each stamp, ns: ns."""
    return {nanoseconds(m.header.stamp): nanoseconds(m.time_ref) for m in time_references}


def read_points(cloud):
    """Return a PointCloud2 as a structured array, by its own description of its fields."""
    point = np.dtype(
        {
            'names': [field.name for field in cloud.fields],
            'formats': [DTYPES[field.datatype] for field in cloud.fields],
            'offsets': [field.offset for field in cloud.fields],
            'itemsize': cloud.point_step,
        }
    )
    return np.frombuffer(bytes(cloud.data), point)


class NodeProcess:
    """The node, started as a user starts it."""

    def __init__(self, log, *arguments, program=('-m', 'circle_bounce_ros.ros.main')):
        self._log = log
        with log.open('w') as output:
            self.process = subprocess.Popen(
                [sys.executable, *WARNINGS, *program, '--ros-args', *arguments],
                cwd=REPOSITORY,
                stdout=output,
                stderr=subprocess.STDOUT,
            )

    @property
    def log(self):
        return self._log.read_text()

    def wait(self):
        """Return the exit status."""
        return self.process.wait(timeout=PATIENCE)

    def end(self, by=signal.SIGINT):
        """End the node and return its exit status."""
        self.process.send_signal(by)
        return self.wait()


class Observer:
    """A subscriber and client; what it gets is collected while it spins."""

    def __init__(self, domain):
        self._context = Context()
        rclpy.init(context=self._context, domain_id=domain)
        self.node = rclpy.create_node('observer', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._clients = {}

    def close(self):
        self._executor.shutdown()
        self.node.destroy_node()
        self._context.try_shutdown()

    def spin_until(self, condition, what='the condition', within=PATIENCE):
        """Receive until a condition holds, and return what it returned."""
        deadline = time.monotonic() + within
        while not (result := condition()):
            assert time.monotonic() < deadline, f'not within {within} s: {what}'
            self._executor.spin_once(timeout_sec=0.1)
        return result

    def spin_for(self, seconds):
        """Receive for a time, where the promise is that something does not happen meanwhile."""
        deadline = time.monotonic() + seconds
        while (left := deadline - time.monotonic()) > 0:
            self._executor.spin_once(timeout_sec=left)

    def listen(self, message_type, topic, latched=False, depth=1000):
        """Return the list that all messages of a topic are going to be in."""
        messages = []
        durability = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
        qos = QoSProfile(depth=depth, durability=durability)
        self.node.create_subscription(message_type, topic, messages.append, qos)
        return messages

    def collect(self, messages, count):
        """Receive until so many more messages are there, and return those."""
        before = len(messages)
        self.spin_until(lambda: len(messages) >= before + count, f'{count} messages')
        return messages[before:]

    def wait_for_node(self, name='/bounce'):
        self.client(Trigger, f'{name}/reset')
        self.client(SetParameters, f'{name}/set_parameters')

    def client(self, service_type, name):
        if name not in self._clients:
            self._clients[name] = self.node.create_client(service_type, name)
        client = self._clients[name]
        # The node may have been started again meanwhile.
        self.spin_until(client.service_is_ready, f'service {name}')
        return client

    def call(self, service_type, name, request=None, within=PATIENCE):
        """Call a service and return the response."""
        client = self.client(service_type, name)
        future = client.call_async(request or service_type.Request())
        self.spin_until(future.done, f'a response of {name}', within)
        return future.result()

    def reset(self, node='/bounce'):
        return self.call(Trigger, f'{node}/reset')

    def step(self, node='/bounce'):
        return self.call(Trigger, f'{node}/step')

    def pause(self, paused=True, node='/bounce'):
        return self.call(SetBool, f'{node}/pause', SetBool.Request(data=paused))

    def set(self, node='/bounce', **values):
        """Set one parameter and return the result."""
        ((name, value),) = values.items()
        message = Parameter(name, value=value).to_parameter_msg()
        request = SetParameters.Request(parameters=[message])
        return self.call(SetParameters, f'{node}/set_parameters', request).results[0]

    def set_together(self, node='/bounce', within=PATIENCE, **values):
        """Set several parameters at once and return the result."""
        messages = [
            Parameter(name, value=value).to_parameter_msg() for name, value in values.items()
        ]
        request = SetParametersAtomically.Request(parameters=messages)
        return self.call(
            SetParametersAtomically, f'{node}/set_parameters_atomically', request, within
        ).result
