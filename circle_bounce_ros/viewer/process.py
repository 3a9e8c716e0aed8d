"""The viewer as a process: the event loop here, ROS in a thread beside it."""

from __future__ import annotations

import asyncio
import signal
import sys
from collections.abc import Sequence

from circle_bounce_ros.base_node import RCL_ERRORS, ParameterError, one_line
from circle_bounce_ros.startup import Ending
from circle_bounce_ros.viewer.ros_link import RosLink
from circle_bounce_ros.viewer.server import Server


def run(args: Sequence[str], ending: Ending) -> int:
    """
    Serve the page until a signal comes.

    Parameters
    ----------
    args : sequence of str
        The command line.
    ending : Ending

    Returns
    -------
    int
        The exit status: 1 for parameters that it cannot start with and when no port is free.

    """
    try:
        return asyncio.run(serve(args, ending))
    except (OSError, ParameterError, *RCL_ERRORS) as error:
        print(f'bounce_viewer: {one_line(error)}', file=sys.stderr)
        return 1


async def serve(args: Sequence[str], ending: Ending) -> int:
    ended = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, ended.set)
    if ending.is_asked:  # in the moment before
        return 0
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
