"""The node with an engine that fails while a file is there."""

import os
import sys
from pathlib import Path

from circle_bounce_ros.kernel import Simulation
from circle_bounce_ros.ros.main import main

FAULT = Path(os.environ['FAULT'])

advance_to = Simulation.advance_to


def advance_with_faults(self, until, at_most=None):
    """Fail, or advance as ever."""
    if FAULT.exists():
        raise ZeroDivisionError('a planted fault')
    return advance_to(self, until, at_most)


Simulation.advance_to = advance_with_faults

if __name__ == '__main__':
    sys.exit(main())
