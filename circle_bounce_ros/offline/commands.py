"""The commands. Their libraries are an extra: who has not installed it gets a sentence, not a traceback."""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module

from circle_bounce_ros.installation import missing_package

PACKAGE = 'circle_bounce_ros'


def record_main() -> int:
    """Run bounce_record."""
    return _run('bounce_record', f'{PACKAGE}.offline.record')


def plot_main() -> int:
    """Run bounce_plot."""
    return _run('bounce_plot', f'{PACKAGE}.offline.plot')


def sweep_main() -> int:
    """Run bounce_sweep."""
    return _run('bounce_sweep', f'{PACKAGE}.offline.sweep')


def _run(command: str, module: str) -> int:
    try:
        main: Callable[[], int] = import_module(module).main
    except ModuleNotFoundError as error:
        print(f'{command}: {missing_package(error, "offline")}', file=sys.stderr)
        return 1
    return main()
