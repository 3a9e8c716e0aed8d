"""
Start bounce_node and bounce_viewer with the same arguments; Ctrl-C, or the end of one, ends both.

Standard library only: run with -S it does not wait for ROS to be found.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

CONFIG = Path(__file__).resolve().parents[1] / 'config'

# With what each has in its environment, unless the user's says otherwise: room for messages of many circles.
PROGRAMS = {
    'bounce_node': {'FASTRTPS_DEFAULT_PROFILES_FILE': str(CONFIG / 'fastdds_large_messages.xml')},
    'bounce_viewer': {},
}
PATIENCE = 10.0  # s, for both to end
ENDING = (signal.SIGINT, signal.SIGTERM)
ENDED_BY_US = (0, -signal.SIGINT, 128 + signal.SIGINT)


class Asked(Exception):
    """Somebody wants this to end."""


def main(arguments: list[str]) -> int:
    folder = Path(sys.executable).parent
    for number in (*ENDING, signal.SIGHUP):
        signal.signal(number, ask)
    children: list[subprocess.Popen[bytes]] = []
    try:
        signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
        for program, environment in PROGRAMS.items():
            # In sessions of their own, so that a Ctrl-C reaches each once: from here. Blocked until they are ready for
            # it: what comes earlier waits for them.
            children.append(
                subprocess.Popen(
                    [str(folder / program), *arguments],
                    env={**environment, **os.environ},
                    start_new_session=True,
                )
            )
        signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)
        while all(child.poll() is None for child in children):
            time.sleep(0.1)
        status = next(child.returncode for child in children if child.returncode is not None)
    except Asked:
        status = None
    for number in (*ENDING, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    statuses = [end(child) for child in children]
    if status is None:
        status = 0 if all(each in ENDED_BY_US for each in statuses) else 1
    return status


def ask(*_: object) -> None:
    raise Asked


def end(child: subprocess.Popen[bytes]) -> int:
    """End a child as Ctrl-C does and return its status."""
    if child.poll() is None:
        child.send_signal(signal.SIGINT)
        try:
            child.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            child.kill()
    return child.wait()


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
