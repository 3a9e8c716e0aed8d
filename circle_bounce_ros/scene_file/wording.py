"""How errors name a place and show a value."""

from __future__ import annotations

import json
from typing import Any

# A value in an error is there to be recognised, not to be read.
LONGEST_VALUE = 60  # characters


def inside(place: str, key: str | int) -> str:
    """Return the place of an item in the thing at a place: `circles[2].radius`."""
    if isinstance(key, int):
        return f'{place}[{key}]'
    return f'{place}.{_word(key)}' if place else _word(key)


def shown(value: Any) -> str:
    """Return how an error shows a value: on one line, text in quotes, shortened when long."""
    if value is None:
        return 'nothing'
    if isinstance(value, dict):
        keys = shortened(', '.join(_word(key) for key in value))
        return f'the key{"s" if len(value) > 1 else ""} {keys}' if value else 'an empty mapping'
    return shortened(repr(value) if isinstance(value, str) else json.dumps(value))


def named(text: str) -> str:
    """Return a place, path or topic as it is, or as a value is shown when that would not be one short line."""
    return text if text and text.isprintable() and len(text) <= LONGEST_VALUE else shown(text)


def shortened(text: str) -> str:
    """Return the text, cut when it is long."""
    return text if len(text) <= LONGEST_VALUE else text[: LONGEST_VALUE - 3] + '...'


def _word(key: str) -> str:
    return shortened(key) if key.isidentifier() else shown(key)
