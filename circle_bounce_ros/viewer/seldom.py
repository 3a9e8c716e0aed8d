"""A log that somebody else's mistakes cannot fill."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable

from aiohttp.http import HttpProcessingError

PERIOD = 60.0  # s
LONGEST = 300  # characters: they may be a stranger's


class SeldomLog:
    """
    Says a sentence of each kind at most once a minute.

    Parameters
    ----------
    say : callable
        Takes a sentence.

    """

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._said: dict[str, float] = {}

    def __call__(self, sentence: str) -> None:
        """Say a sentence, whose kind is what stands before the first colon, unless one of its kind was said."""
        kind = sentence.partition(':')[0]
        now = time.monotonic()
        if now - self._said.get(kind, -PERIOD) >= PERIOD:
            self._said[kind] = now
            self._say(sentence[:LONGEST])


def one_line(text: str) -> str:
    """Return what may be a stranger's text as one printable line, cut when it is long."""
    line = ' '.join(text.split())[:LONGEST]
    return ''.join(c if c.isprintable() else ascii(c)[1:-1] for c in line)[:LONGEST]


def http_log(say: Callable[[str], None]) -> logging.Logger:
    """Return a logger for aiohttp: what strangers send wrong becomes a sentence, what goes wrong here is logged."""

    def is_ours(record: logging.LogRecord) -> bool:
        error = record.exc_info[1] if record.exc_info else None
        if isinstance(error, HttpProcessingError):
            say(f'request: cannot be read: {one_line(error.message)}')
            return False
        return True

    logger = logging.Logger('circle_bounce_ros.viewer.http')
    logger.addHandler(logging.StreamHandler())
    logger.addFilter(is_ours)
    return logger
