"""What every folder of tests may use; the kernel's environment has pytest and the standard library only."""

import fcntl
import os
import random
import tempfile
from importlib.util import find_spec
from pathlib import Path

import pytest

# What folders of tests need and the package itself does not. Not `importorskip` in their conftest.py: that would
# skip every test there is.
NEEDS = {
    'offline': ('rosbags', 'mcap', 'pyarrow', 'tqdm', 'distributed', 'matplotlib', 'PIL'),
    'ros': ('rclpy',),
    'viewer': ('rclpy', 'aiohttp'),
}


class SkippedModule(pytest.Module):
    """A module of tests that is not imported."""

    missing = ''

    def collect(self):
        pytest.skip(f'needs {self.missing}, which is not installed', allow_module_level=True)


def pytest_pycollect_makemodule(module_path, parent):
    folder = module_path.relative_to(Path(__file__).parent).parts[0]
    missing = [name for name in NEEDS.get(folder, ()) if find_spec(name) is None]
    if not missing:
        return None
    module = SkippedModule.from_parent(parent, path=module_path)
    module.missing = ', '.join(missing)
    return module


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
