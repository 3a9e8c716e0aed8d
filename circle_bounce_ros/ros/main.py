"""The command bounce_node."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from circle_bounce_ros.startup import ParameterRow, Program, start

# The seed that stands for the one in the scene file.
SEED_OF_FILE = -1

LARGEST_SEED = 2**63 - 1  # what an integer parameter can hold

PARAMETERS = [
    ParameterRow(
        'scene',
        'lesson',
        'The scene to show: the name of a packaged one, or with a / or .yaml in it the path of a file, from the '
        'working directory. No unit.',
    ),
    ParameterRow(
        'seed',
        SEED_OF_FILE,
        'Random seed of the groups of the scene; -1: the seed in the file. No unit.',
        (SEED_OF_FILE, LARGEST_SEED),
    ),
    ParameterRow(
        'rate',
        60.0,
        'Ticks per second, in Hz: of wall time, with publish_clock of scene time.',
        (0.1, 1000.0),
    ),
    ParameterRow(
        'time_scale',
        1.0,
        'Seconds of scene time per second of the clock (s/s), greater than 0; with publish_clock 0 means as fast as '
        'possible.',
        (0.0, 1000.0),
    ),
    ParameterRow(
        'start_paused',
        False,
        'Whether the scene stands still at the start. True or false.',
        read_only=True,
    ),
    ParameterRow(
        'publish_clock',
        False,
        'Whether the node is the time source: it publishes /clock, and stamps are simulated time. Not together with '
        'use_sim_time. True or false.',
        read_only=True,
    ),
    ParameterRow(
        'frame_id', 'world', 'The frame of all positions and velocities. No unit.', read_only=True
    ),
]

PROGRAM = Program(
    'bounce_node',
    'Publish a scene of bouncing circles on ROS 2 topics.',
    PARAMETERS,
    'circle_bounce_ros.ros.node',
)


def main(args: Sequence[str] | None = None) -> int:
    """
    Run the node until Ctrl-C or SIGTERM.

    Returns
    -------
    int
        The exit status: 1 for parameters that it cannot start with and where ROS is missing, 2 for arguments that
        are for nobody.

    """
    return start(PROGRAM, args)


if __name__ == '__main__':
    sys.exit(main())
