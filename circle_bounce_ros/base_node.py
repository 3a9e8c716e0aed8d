"""
What our nodes have in common: parameters that are refused in words, and failures that end nothing.

For floating-point parameters whole numbers are numbers too.
"""

from __future__ import annotations

import re
import traceback
from collections.abc import Iterable, Sequence
from typing import Any

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_service import ParameterService

from circle_bounce_ros.startup import ROS_ARGS, ParameterRow

# What rclpy raises for malformed arguments, and when its context has ended.
RCL_ERRORS = (rclpy_implementation.RCLError, rclpy_implementation.UnknownROSArgsError)

# The policies of QoS that `qos_overrides` parameters can change.
OVERRIDABLE = ('.history', '.depth', '.reliability')

WORDS = {bool: 'true or false', int: 'a whole number', float: 'a number', str: 'text'}


class ParameterError(ValueError):
    """What is wrong with the value of a parameter: name, rule and value, in one sentence."""


class BaseNode(Node):
    """
    A node whose parameters are rows. A failure in one of its callbacks is logged, once, and ends nothing.

    Parameters
    ----------
    name : str
    rows : sequence of ParameterRow
    always_set : iterable of str
        Parameters that take effect even when they are set to the value that they have: the file that it names may
        have changed.
    **options
        Of `rclpy.node.Node`.

    Raises
    ------
    ParameterError
        For a value at the start that is refused.

    """

    def __init__(
        self,
        name: str,
        rows: Sequence[ParameterRow],
        always_set: Iterable[str] = (),
        **options: Any,
    ) -> None:
        super().__init__(name, start_parameter_services=False, **options)
        self._rows = {row.name: row for row in rows}
        self._always_set = set(always_set)
        self._failures: set[tuple[type, str, int]] = set()
        for row in rows:
            value = checked(row, self._override(row))
            self.declare_parameter(row.name, value, describe(row), ignore_override=True)
        # Last: a request that comes early must find the parameters declared.
        self._parameter_service = _WordyParameterService(self)

    def _override(self, row: ParameterRow) -> Any:
        """Return the value that was given at the start, of whatever type; the default if there is none."""
        anything = ParameterDescriptor(dynamic_typing=True)
        value = self.declare_parameter(row.name, row.default, anything).value
        self.undeclare_parameter(row.name)
        return value

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Set all of them or, with the reason, none; what changes nothing is passed over."""
        changes = []
        for parameter in parameter_list:
            row = self._rows.get(parameter.name)
            if row is None:
                if not self.has_parameter(parameter.name):
                    reason = f'{parameter.name}: there is no parameter of this name'
                    return SetParametersResult(successful=False, reason=reason)
                changes.append(parameter)
                continue
            try:
                value = checked(row, parameter.value)
            except ParameterError as error:
                return SetParametersResult(successful=False, reason=str(error))
            if row.name in self._always_set or value != self.get_parameter(row.name).value:
                if row.read_only:
                    reason = f'{row.name}: can only be given at the start, got {value!r}'
                    return SetParametersResult(successful=False, reason=reason)
                changes.append(Parameter(row.name, value=value))
        return super().set_parameters_atomically(changes)

    def warn_of_unknown_parameters(self) -> None:
        """Log which values were given at the start for parameters that this node does not have."""
        # rclpy passes over a misspelt name in silence, and has no public list of what was given.
        given = getattr(self, '_parameter_overrides', {})
        for name in sorted(
            set(given) - {p.name for p in self.get_parameters_by_prefix('').values()}
        ):
            if name.startswith('qos_overrides.') and name.endswith(OVERRIDABLE):
                continue  # a topic of another scene may have it
            self.get_logger().warning(
                f'parameter {name}: there is none of this name, the value has no effect'
            )

    def other_publishers(self, topic: str) -> list[str]:
        """Return the full names of other nodes that publish on a topic of this one, sorted."""
        own = self.get_fully_qualified_name()
        nodes = [
            f'{info.node_namespace.rstrip("/")}/{info.node_name}'
            for info in self.get_publishers_info_by_topic(self.resolve_topic_name(topic))
            # Discovery may hear of the publisher before it hears of its node.
            if 'UNKNOWN' not in info.node_name
        ]
        if own in nodes:
            nodes.remove(own)
        return sorted(nodes)

    def log_failure(self, error: Exception) -> None:
        """Log a failure with its traceback, each once: it may come sixty times a second."""
        place = traceback.extract_tb(error.__traceback__)[-1]
        failure = (type(error), place.filename, place.lineno or 0)
        if failure in self._failures:
            return
        self._failures.add(failure)
        text = ''.join(traceback.format_exception(error))
        self.get_logger().error(f'a fault of this program, please report it: {text}')


class BaseExecutor(SingleThreadedExecutor):
    """
    Calls the callbacks of one node; what one of them raises is logged, and the others go on.

    Parameters
    ----------
    node : BaseNode

    """

    def __init__(self, node: BaseNode) -> None:
        super().__init__(context=node.context)
        self._node = node
        self.add_node(node)

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Wait for one callback and call it."""
        try:
            super().spin_once(timeout_sec)
        except ExternalShutdownException:
            raise
        except Exception as error:
            # A signal may end the context in the middle of a callback.
            if self._node.context.ok():
                self._node.log_failure(error)


class _WordyParameterService(ParameterService):
    """Answers requests that are no parameters at all, which would end the node."""

    def _set_parameters_callback(self, request: Any, response: Any) -> Any:
        # One by one: the others of the request are set all the same.
        for parameter in request.parameters:
            response.results.append(self._set([parameter]))
        return response

    def _set_parameters_atomically_callback(self, request: Any, response: Any) -> Any:
        response.result = self._set(request.parameters)
        return response

    def _set(self, messages: Sequence[Any]) -> SetParametersResult:
        try:
            parameters = [from_message(message) for message in messages]
            result: SetParametersResult = self._get_node().set_parameters_atomically(parameters)
        except ParameterError as error:
            return SetParametersResult(successful=False, reason=str(error))
        except Exception as error:
            # Whatever is wrong with a request, it ends here. What is wrong with us is in the log.
            if not self._get_node().context.ok():
                raise
            self._get_node().log_failure(error)
            return SetParametersResult(successful=False, reason=one_line(error))
        return result


def from_message(message: Any) -> Parameter:
    """
    Return a parameter of a request.

    Raises
    ------
    ParameterError
        For a type that does not exist.

    """
    try:
        return Parameter.from_parameter_msg(message)
    except ValueError:
        most = max(kind.value for kind in Parameter.Type)
        raise ParameterError(
            f'{message.name}: type must be from 0 to {most}, got {message.value.type}'
        ) from None


def checked(row: ParameterRow, value: Any) -> Any:
    """
    Return a value as it is declared: a whole number for a number is one too.

    Raises
    ------
    ParameterError
        For a value of another type, one out of range, NaN and infinity.

    """
    wanted = type(row.default)
    if wanted is float and type(value) is int:
        value = float(value)
    if type(value) is not wanted:
        raise ParameterError(f'{row.name}: must be {WORDS[wanted]}, got {value!r}')
    if row.limits and not row.limits[0] <= value <= row.limits[1]:
        least, most = row.limits
        raise ParameterError(f'{row.name}: must be from {least} to {most}, got {value}')
    return value


def one_line(error: Exception) -> str:
    """Return what an error says, in one line, without the places in the C library."""
    if isinstance(error, rclpy_implementation.UnknownROSArgsError):
        return f'arguments behind {ROS_ARGS} that ROS does not know: {error}'
    return re.sub(r', at /\S+:\d+', '', ' '.join(str(error).split()))


def describe(row: ParameterRow) -> ParameterDescriptor:
    """Return the description of a parameter as ROS has it."""
    descriptor = ParameterDescriptor(description=row.description, read_only=row.read_only)
    if row.limits:
        least, most = row.limits
        if isinstance(row.default, int):
            descriptor.integer_range = [IntegerRange(from_value=least, to_value=most, step=1)]
        else:
            descriptor.floating_point_range = [FloatingPointRange(from_value=least, to_value=most)]
    return descriptor
