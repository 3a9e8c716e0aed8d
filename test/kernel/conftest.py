"""The kernel's tests run with the engine of the user's choice: `--engine plain`, `compiled` or the default."""

import pytest

from circle_bounce_ros.kernel.engine import backends, compilation


def pytest_addoption(parser):
    parser.addoption('--engine', choices=['default', 'plain', 'compiled'], default='default')


@pytest.fixture(autouse=True, scope='session')
def engine(request):
    """Make one mode the default for all simulations, however few circles they have."""
    wanted = request.config.getoption('--engine')
    patch = pytest.MonkeyPatch()
    if wanted == 'plain':
        patch.setattr(compilation, 'is_available', lambda: False)
    elif wanted == 'compiled':
        patch.setattr(backends, 'PLAIN_UP_TO', 0)
        assert compilation.is_available(), 'numba is not installed'
    yield wanted
    patch.undo()
