"""What the numbers were measured on."""

from __future__ import annotations

import datetime
import os
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGES = ('numpy', 'numba', 'pymunk', 'box2d', 'billiards', 'ros-jazzy-rclpy')


def describe() -> dict[str, str]:
    """Return the day, the processor and the versions."""
    facts = {
        'date': datetime.date.today().isoformat(),
        'processor': processor(),
        'cores': str(os.cpu_count()),
        'system': platform.system(),
        'python': platform.python_version(),
        # Above the number of cores others were at work: CPU times are longer then, and ticks late.
        'load average': f'{os.getloadavg()[1]:.0f}',
    }
    for package in PACKAGES:
        try:
            facts[package] = version(package)
        except PackageNotFoundError:
            continue
    return facts


def processor() -> str:
    """Return what the processor calls itself."""
    for line in Path('/proc/cpuinfo').read_text().splitlines():
        if line.startswith('model name'):
            return line.partition(':')[2].strip()
    return platform.machine()
