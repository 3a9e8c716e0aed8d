"""
Print where a circle is and how fast it goes, as the node says it.

    python examples/listen.py [CIRCLE] [--namespace NAMESPACE] [--count COUNT]
"""

from __future__ import annotations

import argparse
import signal
import sys

import rclpy
from geometry_msgs.msg import PoseStamped, TwistStamped
from rclpy.executors import ExternalShutdownException


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description='Print the pose and twist of a circle.')
    parser.add_argument('circle', nargs='?', default='green', help='its name (default: green)')
    parser.add_argument(
        '--namespace', default='', help='the namespace of the node (default: none)'
    )
    parser.add_argument('--count', type=int, help='end after so many poses (default: never)')
    return parser.parse_args()


def main() -> int:
    options = parse()
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # `| head` ends it without a traceback
    poses = 0

    def print_pose(message: PoseStamped) -> None:
        nonlocal poses
        poses += 1
        stamp, position = message.header.stamp, message.pose.position
        print(
            f'{stamp.sec}.{stamp.nanosec:09d}  x {position.x:+.6f} m  y {position.y:+.6f} m',
            flush=True,
        )

    def print_twist(message: TwistStamped) -> None:
        stamp, linear = message.header.stamp, message.twist.linear
        print(
            f'{stamp.sec}.{stamp.nanosec:09d}  vx {linear.x:+.6f} m/s  vy {linear.y:+.6f} m/s',
            flush=True,
        )

    rclpy.init(args=[])
    node = rclpy.create_node('listen', namespace=options.namespace)
    node.create_subscription(PoseStamped, f'{options.circle}/pose', print_pose, 10)
    node.create_subscription(TwistStamped, f'{options.circle}/twist', print_twist, 10)
    try:
        while options.count is None or poses < options.count:
            rclpy.spin_once(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    return 0


if __name__ == '__main__':
    sys.exit(main())
