"""Run what was installed, in child processes that know nothing of this one."""

import json
import subprocess
import sys
from pathlib import Path

from circle_bounce_ros.installation import child_environment

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = 'circle_bounce_ros'
PATIENCE = 60.0  # s; only a fault takes that long


def run(*command, cwd=None, status=0, **environment):
    """Run a command to its end and return what it said; its exit status must be this one."""
    done = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        env=child_environment(**environment),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=PATIENCE,
    )
    assert done.returncode == status, f'{command} ended with {done.returncode}:\n{done.stdout}'
    return done.stdout


def first_message(listener):
    """Return the two numbers of the first message that a listener hears."""
    output, _ = listener.communicate(timeout=PATIENCE)
    assert listener.returncode == 0
    return json.loads(output)


def packages_here():
    """Return the folders that this Python has its packages in."""
    folders = [Path(folder) for folder in sys.path]
    return [folder for folder in folders if folder.name in ('site-packages', 'dist-packages')]
