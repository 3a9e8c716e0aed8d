"""What every folder of tests may use; the kernel's environment has pytest and the standard library only."""

import fcntl
import os
import random
import tempfile
from pathlib import Path

import pytest


@pytest.fixture(scope='session')
def domain():
    """Return a ROS domain that no other test run on this machine uses, set for all child processes."""
    numbers = list(range(1, 102))
    random.Random(os.getpid()).shuffle(numbers)
    for number in numbers:
        path = Path(tempfile.gettempdir()) / f'circle_bounce_ros_domain_{number}.lock'
        with path.open('a') as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            with pytest.MonkeyPatch.context() as patch:
                patch.setenv('ROS_DOMAIN_ID', str(number))
                patch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
                yield number
            return
    pytest.fail('all ROS domains from 1 to 101 are in use by other test runs')
