"""`first_message.py pose|time TOPIC`: say `listening`, wait for one message, say two numbers of it, end."""

import json
import sys

import rclpy
from geometry_msgs.msg import PoseStamped
from rclpy.qos import QoSProfile
from sensor_msgs.msg import TimeReference


def pose(message):
    """Return x and y, m."""
    return message.pose.position.x, message.pose.position.y


def time(message):
    """Return the stamp and the scene time, s."""
    return tuple(t.sec + t.nanosec * 1e-9 for t in (message.header.stamp, message.time_ref))


KINDS = {'pose': (PoseStamped, pose), 'time': (TimeReference, time)}


def main():
    message_type, numbers = KINDS[sys.argv[1]]
    rclpy.init()
    node = rclpy.create_node('first_message')
    heard = []
    node.create_subscription(message_type, sys.argv[2], heard.append, QoSProfile(depth=10))
    print('listening', flush=True)
    while not heard:
        rclpy.spin_once(node)
    print(json.dumps(numbers(heard[0])), flush=True)
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
