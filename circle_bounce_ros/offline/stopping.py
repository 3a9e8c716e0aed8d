"""Ctrl-C and SIGTERM end a command after what it has in hand, so that what it writes is whole."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker
from types import FrameType, TracebackType
from typing import Any

# What a shell expects of a program that Ctrl-C has ended.
INTERRUPTED = 128 + signal.SIGINT


class Stopping:
    """
    A context in which the first signal is only noted. A second one ends the program in the usual way.

    Calling it tells whether one has come.

    Parameters
    ----------
    last_words : str, optional
        With them a second Ctrl-C ends the program at once, after it has said them. For programs full of objects that
        Python may be about to delete: of an exception that comes up there it shows a traceback, and goes on.

    """

    SIGNALS = (signal.SIGINT, signal.SIGTERM)

    def __init__(self, last_words: str = '') -> None:
        self._last_words = last_words
        self._came: int | None = None
        self._before: dict[int, Any] = {}

    def __enter__(self) -> Stopping:
        self._before = {number: signal.signal(number, self._note) for number in self.SIGNALS}
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._restore()

    def __call__(self) -> bool:
        return self._came is not None

    @property
    def exit_status(self) -> int:
        """What a shell expects of a program that a signal has ended, 0 without one."""
        return 128 + self._came if self._came is not None else 0

    def _note(self, number: int, frame: FrameType | None) -> None:
        self._came = number
        if self._last_words:
            signal.signal(signal.SIGINT, self._leave)
            signal.signal(signal.SIGTERM, self._before[signal.SIGTERM])
        else:
            self._restore()

    def _leave(self, number: int, frame: FrameType | None) -> None:
        os.write(2, f'\n{self._last_words}\n'.encode())
        os._exit(128 + number)

    def _restore(self) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)


@contextmanager
def without_interrupts() -> Iterator[None]:
    """
    Keep Ctrl-C from processes that are started in here, and by threads that are started in here.

    A terminal sends it to a whole group of processes. Only the one that talks to its user is to act on it.
    """
    # Whoever starts the first process by multiprocessing starts this one too, and then lets signals in again.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
