"""The node with an engine made artificially slow: each step of its way takes so many seconds."""

import os
import sys
import time

from circle_bounce_ros.kernel import Simulation
from circle_bounce_ros.ros.main import main
from circle_bounce_ros.schedule.slices import FIRST_SLICE

SECONDS = float(os.environ['SECONDS_PER_SLICE'])

advance_to = Simulation.advance_to


def advance_slowly(self, until, at_most=None):
    """Take as long for each step of a slice as the engine of an overburdened machine."""
    end = time.monotonic() + SECONDS
    while time.monotonic() < end:
        pass
    return advance_to(self, until, at_most=1 if at_most == FIRST_SLICE else at_most)


Simulation.advance_to = advance_slowly

if __name__ == '__main__':
    sys.exit(main())
