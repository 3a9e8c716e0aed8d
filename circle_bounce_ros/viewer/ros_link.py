"""The ROS side: a node in a thread of its own, which hands on what it hears and asks what it is told to."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.client import Client
from rclpy.context import Context
from rclpy.exceptions import InvalidServiceNameException
from rclpy.executors import ExternalShutdownException
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.signals import SignalHandlerOptions
from rclpy.subscription import Subscription
from sensor_msgs.msg import PointCloud2, TimeReference
from std_srvs.srv import SetBool, Trigger
from visualization_msgs.msg import MarkerArray

from circle_bounce_ros.base_node import BaseExecutor, BaseNode, ParameterError
from circle_bounce_ros.viewer.main import PARAMETERS

# Every contact is part of the story, and so is the state before it. Pages get the newest state only.
FEW = QoSProfile(depth=5)
ALL = QoSProfile(depth=100)
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)

# A scene is loaded while it is being checked, and a large one takes its time.
PATIENCE = {'scene': 60.0}  # s
USUAL_PATIENCE = 5.0  # s

Hear = Callable[[str, Any], None]


class Refusal(Exception):
    """Why the node did not do what it was asked to, in words."""


class RosLink:
    """
    Subscriptions and clients.

    Parameters
    ----------
    args : sequence of str, optional
        The command line.
    hear : callable
        Called on the event loop with the name of a channel and what came: serialized messages for
        `bodies`, `time`, `static` and `contacts`, a dict for `diagnostics`.

    """

    def __init__(self, args: Sequence[str] | None, hear: Hear) -> None:
        self._loop = asyncio.get_running_loop()
        self._hear = hear
        self._context = Context()
        # The event loop owns the signals.
        rclpy.init(
            args=args, context=self._context, signal_handler_options=SignalHandlerOptions.NO
        )
        self._node = BaseNode('bounce_viewer', PARAMETERS, context=self._context)
        self._executor = BaseExecutor(self._node)
        name = self._node.get_parameter('node').value
        self._contacts: Subscription | None = None
        self._contacts_wanted = False
        # The time of a tick is published first and taken first.
        self._listen('time', TimeReference, 'time', ALL)
        self._listen('bodies', PointCloud2, 'bodies', FEW)
        self._listen('static', MarkerArray, 'markers/static', LATCHED)
        self._node.create_subscription(
            DiagnosticArray, '/diagnostics', self._on_diagnostics, QoSProfile(depth=10)
        )
        self._clients = self._create_clients(name)
        self.node_name = self._clients['reset'].service_name.rpartition('/')[0]
        self._thread = threading.Thread(target=self._spin, name='rclpy')
        self._thread.start()

    def _create_clients(self, name: str) -> dict[str, Client]:
        types = {
            'reset': Trigger,
            'pause': SetBool,
            'step': Trigger,
            'set_parameters_atomically': SetParametersAtomically,
        }
        try:
            return {
                service: self._node.create_client(kind, f'{name}/{service}')
                for service, kind in types.items()
            }
        except InvalidServiceNameException:
            raise ParameterError(f'node: must be the name of a node, got {name!r}') from None

    @property
    def port(self) -> int:
        """The port that the user wants."""
        return int(self._node.get_parameter('port').value)

    @property
    def bodies_topic(self) -> str:
        """The full name of the topic that has to be published for anything to be seen."""
        return str(self._node.resolve_topic_name('bodies'))

    def log(self, text: str) -> None:
        """Say something in the log of the node."""
        self._node.get_logger().info(text)

    def publishers(self) -> list[str]:
        """Return the full names of the nodes that publish `bodies`, sorted; more than one are a mistake."""
        return self._node.other_publishers('bodies')

    def want_contacts(self, wanted: bool) -> None:
        """Subscribe to `contacts`, or no longer: the node records them for subscribers only."""
        # The executor takes waiting tasks last first: each of them does what is wanted by then.
        self._contacts_wanted = wanted
        self._executor.create_task(self._set_contacts)

    def _set_contacts(self) -> None:
        wanted = self._contacts_wanted
        if wanted and self._contacts is None:
            self._contacts = self._listen('contacts', PointCloud2, 'contacts', ALL)
        elif not wanted and self._contacts is not None:
            self._node.destroy_subscription(self._contacts)
            self._contacts = None

    async def ask(self, request: dict[str, Any]) -> str:
        """
        Do what a page has asked for and return the node's answer in words.

        Parameters
        ----------
        request : dict
            One of `reset`, `pause`, `step`, `time_scale`, `scene` as `messages.read` returns it.

        Raises
        ------
        Refusal
            When the node refuses or does not answer.

        """
        kind = request['type']
        client, message = self._request(request)
        if not client.service_is_ready():
            raise Refusal(f'{self.node_name} does not answer: is the node running?')
        answer: asyncio.Future[Any] = self._loop.create_future()
        self._executor.create_task(self._call, client, message, answer)
        try:
            result = await asyncio.wait_for(answer, PATIENCE.get(kind, USUAL_PATIENCE))
        except asyncio.TimeoutError:
            raise Refusal(f'{self.node_name} has not answered in time') from None
        return _words(kind, request, result)

    def _request(self, request: dict[str, Any]) -> tuple[Client, Any]:
        kind = request['type']
        if kind == 'pause':
            return self._clients['pause'], SetBool.Request(data=request['paused'])
        if kind in ('reset', 'step'):
            return self._clients[kind], Trigger.Request()
        values: dict[str, Any] = (
            {'time_scale': float(request['value'])}
            if kind == 'time_scale'
            else {
                'scene': request['scene'],
                'seed': request['seed'],
            }
        )
        parameters = [
            Parameter(name, value=value).to_parameter_msg() for name, value in values.items()
        ]
        return self._clients['set_parameters_atomically'], SetParametersAtomically.Request(
            parameters=parameters
        )

    def _call(self, client: Client, message: Any, answer: asyncio.Future[Any]) -> None:
        def hand_over(future: Any) -> None:
            self._on_loop(_settle, answer, future)

        client.call_async(message).add_done_callback(hand_over)

    def _listen(self, channel: str, kind: type, topic: str, qos: QoSProfile) -> Subscription:
        def on_message(message: bytes) -> None:
            self._on_loop(self._hear, channel, message)

        return self._node.create_subscription(kind, topic, on_message, qos, raw=True)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name == f'{self.node_name}: simulation':
                report = {
                    'message': status.message,
                    'warns': status.level != b'\0',
                    'values': {item.key: item.value for item in status.values},
                }
                self._on_loop(self._hear, 'diagnostics', report)

    def _on_loop(self, function: Callable[..., None], *arguments: Any) -> None:
        # While it ends, the loop may close before the last message has come.
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(function, *arguments)

    def _spin(self) -> None:
        with suppress(ExternalShutdownException):
            self._executor.spin()

    def close(self) -> None:
        """End the thread and the node."""
        self._executor.shutdown()
        self._thread.join()
        self._node.destroy_node()
        self._context.try_shutdown()


def _settle(answer: asyncio.Future[Any], future: Any) -> None:
    if answer.done():
        return
    if future.exception() is not None:
        answer.set_exception(Refusal(str(future.exception())))
    else:
        answer.set_result(future.result())


def _words(kind: str, request: dict[str, Any], result: Any) -> str:
    if kind in ('time_scale', 'scene'):
        if not result.result.successful:
            raise Refusal(result.result.reason)
        if kind == 'scene':
            return f'scene {request["scene"]}'
        return f'{request["value"]:g} seconds of the scene per second'
    if not result.success:
        raise Refusal(result.message)
    return str(result.message)
