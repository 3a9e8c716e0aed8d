"""
Call the services of a running node and set its parameters, where there is no ros2 command line.

    python examples/control.py reset | pause | resume | step | set NAME VALUE  [--node /bounce]

Ends with status 0 when the node said yes, and with status 1 and its reason when it said no or nothing.
"""

from __future__ import annotations

import argparse
import sys

import rclpy
import yaml
from rcl_interfaces.srv import SetParameters
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_srvs.srv import SetBool, Trigger

PATIENCE = 10.0  # s

# A whole number is a number too, and a name of a scene may look like one.
TYPES = {'rate': float, 'time_scale': float, 'scene': str}


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description='Call the services of a running node.')
    of_node = argparse.ArgumentParser(add_help=False)
    of_node.add_argument('--node', default='/bounce', help='its name (default: /bounce)')
    commands = parser.add_subparsers(dest='command', required=True)
    for name, text in (
        ('reset', 'start the scene again from its first instant'),
        ('pause', 'let the scene stand still'),
        ('resume', 'let it go on'),
        ('step', 'while paused: go on by one period'),
    ):
        commands.add_parser(name, help=text, parents=[of_node])
    setting = commands.add_parser('set', help='set a parameter', parents=[of_node])
    setting.add_argument('name')
    setting.add_argument('value')
    return parser.parse_args()


def call(node: Node, service_type: type, name: str, request: object) -> object:
    client = node.create_client(service_type, name)
    if not client.wait_for_service(PATIENCE):
        sys.exit(f'{name}: no such service after {PATIENCE:g} s, is the node running?')
    future = client.call_async(request)
    rclpy.spin_until_future_complete(node, future, timeout_sec=PATIENCE)
    if not future.done():
        sys.exit(f'{name}: no answer after {PATIENCE:g} s')
    return future.result()


def do(node: Node, options: argparse.Namespace) -> tuple[bool, str]:
    """Return whether the node said yes, and what else it said."""
    if options.command == 'set':
        value = TYPES.get(options.name, yaml.safe_load)(options.value)
        parameter = Parameter(options.name, value=value).to_parameter_msg()
        request = SetParameters.Request(parameters=[parameter])
        result = call(node, SetParameters, f'{options.node}/set_parameters', request).results[0]
        return result.successful, result.reason or f'{options.name} is {value}'
    if options.command in ('pause', 'resume'):
        request = SetBool.Request(data=options.command == 'pause')
        response = call(node, SetBool, f'{options.node}/pause', request)
    else:
        response = call(node, Trigger, f'{options.node}/{options.command}', Trigger.Request())
    return response.success, response.message


def main() -> int:
    options = parse()
    rclpy.init(args=[])
    node = rclpy.create_node('control')
    try:
        success, message = do(node, options)
    except ValueError as error:
        success, message = False, f'{options.name}: {error}'
    except KeyboardInterrupt:
        return 1
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    print(message, file=sys.stdout if success else sys.stderr)
    return 0 if success else 1


if __name__ == '__main__':
    sys.exit(main())
