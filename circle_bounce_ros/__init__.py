"""Circles that bounce, exactly, and say so on ROS 2 topics."""
