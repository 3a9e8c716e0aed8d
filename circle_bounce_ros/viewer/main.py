"""The command bounce_viewer."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from circle_bounce_ros.startup import ParameterRow, Program, start

FIRST_PORT = 8080

PARAMETERS = [
    ParameterRow(
        'node', 'bounce', 'The node whose services the buttons call. No unit.', read_only=True
    ),
    ParameterRow(
        'port',
        FIRST_PORT,
        'Where on 127.0.0.1 the page is; in use: the next free one of nine; 0: any free one. No unit.',
        (0, 65535),
        read_only=True,
    ),
]

PROGRAM = Program(
    'bounce_viewer',
    'Serve a live page that shows what bounce_node publishes.',
    PARAMETERS,
    'circle_bounce_ros.viewer.process',
)


def main(args: Sequence[str] | None = None) -> int:
    """
    Serve the page until Ctrl-C or SIGTERM.

    Returns
    -------
    int
        The exit status: 1 for parameters that it cannot start with, when no port is free and where ROS is missing,
        2 for arguments that are for nobody.

    """
    return start(PROGRAM, args)


if __name__ == '__main__':
    sys.exit(main())
