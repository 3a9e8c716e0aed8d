"""The few messages that a page may send, and what each must hold; everything else is refused."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

# The longest message accepted, bytes. A scene's path is the longest thing that a page has to say, with up to six
# bytes a character.
LARGEST_MESSAGE = 4096

LARGEST_ID = 2**32 - 1  # what `bodies` can hold
LARGEST_WHOLE = 2**53 - 1  # what JavaScript can count to
MOST_TEXT = 400  # characters


class MessageError(ValueError):
    """What is wrong with a message, in one sentence."""


Check = Callable[[Any], bool]


def _whole(least: int, most: int) -> Check:
    return lambda value: type(value) is int and least <= value <= most


def _is_truth(value: Any) -> bool:
    return isinstance(value, bool)


def _is_scale(value: Any) -> bool:
    return type(value) in (int, float) and 0 <= value <= 1000


def _is_text(value: Any) -> bool:
    return isinstance(value, str) and 0 < len(value) <= MOST_TEXT and value.isprintable()


# The fields of each type of message, all of them required.
FIELDS: dict[str, dict[str, Check]] = {
    'ack': {'frame': _whole(0, LARGEST_WHOLE)},
    'reset': {},
    'pause': {'paused': _is_truth},
    'step': {},
    'time_scale': {'value': _is_scale},
    'scene': {'scene': _is_text, 'seed': _whole(-1, LARGEST_WHOLE)},
    # -1: none any more.
    'select': {'circle': _whole(-1, LARGEST_ID)},
}


def read(text: str) -> dict[str, Any]:
    """
    Return a message from a page: its `type` and exactly the fields that this type has.

    Raises
    ------
    MessageError
        For everything else.

    """
    try:
        message = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise MessageError('not JSON') from error
    if not isinstance(message, dict):
        raise MessageError('not an object')
    kind = message.get('type')
    if not isinstance(kind, str) or kind not in FIELDS:
        raise MessageError(f'type: must be one of {", ".join(FIELDS)}')
    checks = FIELDS[kind]
    if message.keys() != checks.keys() | {'type'}:
        raise MessageError(f'{kind}: must have {", ".join(checks) or "no field"} and nothing else')
    for name, is_right in checks.items():
        if not is_right(message[name]):
            raise MessageError(f'{kind}.{name}: out of range')
    return message
