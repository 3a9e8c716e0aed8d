"""The node: asks the kernel for the state at a time and says it on ROS 2 topics."""
