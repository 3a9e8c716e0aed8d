"""Exact event-driven simulation of bouncing circles for ROS 2."""
