"""Say `listening`, wait for a PoseStamped on the topic named, say its x and y, end."""

import json
import sys

import rclpy
from geometry_msgs.msg import PoseStamped
from rclpy.qos import QoSProfile


def main():
    rclpy.init()
    node = rclpy.create_node('first_pose')
    heard = []
    node.create_subscription(PoseStamped, sys.argv[1], heard.append, QoSProfile(depth=10))
    print('listening', flush=True)
    while not heard:
        rclpy.spin_once(node)
    print(json.dumps([heard[0].pose.position.x, heard[0].pose.position.y]), flush=True)
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
