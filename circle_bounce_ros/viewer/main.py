"""The process: the event loop here, ROS in a thread beside it."""

from __future__ import annotations

import asyncio
import signal
import sys
from collections.abc import Sequence

from rclpy.impl.implementation_singleton import rclpy_implementation

from circle_bounce_ros.viewer.ros_link import RosLink
from circle_bounce_ros.viewer.server import Server

# What rclpy raises for malformed arguments.
RCL_ERRORS = (rclpy_implementation.RCLError, rclpy_implementation.UnknownROSArgsError)


def main(args: Sequence[str] | None = None) -> int:
    """
    Serve the page until Ctrl-C or SIGTERM.

    Returns
    -------
    int
        The exit status: 1 for arguments that it cannot start with and when no port is free.

    """
    try:
        return asyncio.run(run(args))
    except KeyboardInterrupt:
        return 0
    except (OSError, *RCL_ERRORS) as error:
        print(f'bounce_viewer: {error}', file=sys.stderr)
        return 1


async def run(args: Sequence[str] | None) -> int:
    ended = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, ended.set)
    server = Server()
    link = RosLink(args, server.hear)
    try:
        address, in_use = await server.start(link)
        if in_use:
            print(
                f'In use: port {", ".join(map(str, in_use))}. So it is the next one.', flush=True
            )
        print(f'See it in the browser: {address}', flush=True)
        await ended.wait()
        await server.stop()
    finally:
        link.close()
    return 0


if __name__ == '__main__':
    sys.exit(main())
