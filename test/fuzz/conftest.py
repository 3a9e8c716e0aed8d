"""The fuzz tests use what the tests of the node and of the viewer have to watch them with."""

import sys
from pathlib import Path

for folder in ('ros', 'viewer'):
    sys.path.insert(0, str(Path(__file__).parents[1] / folder))
