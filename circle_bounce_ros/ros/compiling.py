"""Compile the engine in a process of its own: a node with nothing on disk yet starts plain and does not wait."""

from __future__ import annotations

import subprocess
import sys

from circle_bounce_ros.kernel import compiled_code_is_ready
from circle_bounce_ros.kernel.engine.compilation import is_available

COMPILE = 'from circle_bounce_ros.kernel import compile_ahead; compile_ahead()'


class BackgroundCompiler:
    """Fills the cache of compiled code once, with low priority; whoever starts a scene later finds it."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> bool:
        """Begin, if there is something to do and it has not begun; return whether it is under way."""
        if self._process is None and is_available() and not compiled_code_is_ready():
            # The same Python and libraries as here: the environment goes on as it is. Its warnings are for the user.
            self._process = subprocess.Popen(
                ['nice', sys.executable, '-c', COMPILE],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                start_new_session=True,
            )
        return self._process is not None and self._process.poll() is None

    def stop(self) -> None:
        """End it, finished or not."""
        if self._process is not None:
            self._process.terminate()
            self._process.wait()
