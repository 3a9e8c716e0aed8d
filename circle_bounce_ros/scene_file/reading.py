"""
A scene file's bytes -> plain data: mappings, lists, text, numbers, booleans, None.

Built from YAML's events, so no object is ever constructed from a tag, no alias is ever followed, and each
error knows its place. Plain words are read by YAML 1.2's core rules on every machine: `1e-3` is a number,
`yes` and `1_000` are text, `010` is ten.
"""

from __future__ import annotations

import math
import re
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from circle_bounce_ros.kernel import SceneError
from circle_bounce_ros.scene_file.wording import inside, shortened, shown

# A hundred thousand circles fit, with the longest names and all digits; more is a mistake, or somebody filling the
# memory.
LARGEST_FILE = 50_000_000  # bytes

# The schema needs 6. Python's own stack ends near 1,000.
DEEPEST_NESTING = 20

# As long as a text takes the parser in Python a second or two.
LONGEST_PARSED_AGAIN = 250_000  # characters

FastLoader: Any = getattr(yaml, 'CSafeLoader', yaml.SafeLoader)

_UNPRINTABLE = re.compile('[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]')
_SURROGATE = re.compile('[\ud800-\udfff]')
_INTEGER = re.compile('[-+]?[0-9]+')
_FLOAT = re.compile(r'[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?')
_NOT_FINITE = re.compile(r'[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)')
_WORDS = {
    '': None,
    '~': None,
    **dict.fromkeys(('null', 'Null', 'NULL')),
    **dict.fromkeys(('true', 'True', 'TRUE'), True),
    **dict.fromkeys(('false', 'False', 'FALSE'), False),
}


def read(path: Path) -> Any:
    """
    Return what a scene file says, unchecked.

    Raises
    ------
    SceneError
        For what is no file, cannot be read, is too large, no UTF-8 text, or no plain YAML.

    """
    return parse(_text(_bytes(path)))


def parse(text: str) -> Any:
    """
    Return what a YAML text says, unchecked.

    Raises
    ------
    SceneError
        For bad YAML, more than one document, tags, anchors, aliases, a key given twice, numbers that are
        not finite, and nesting without reason.

    """
    try:
        return _document(_events(FastLoader(text)))
    except yaml.YAMLError as error:
        fault = error
    # The parser in C is 18 times faster but words its errors differently: the one in Python speaks for both, where
    # nobody has to wait for it.
    if len(text) <= LONGEST_PARSED_AGAIN:
        try:
            return _document(_events(yaml.SafeLoader(text)))
        except yaml.YAMLError as error:
            fault = error
    raise _sentence(fault)


def _events(loader: Any) -> Iterator[Any]:
    """Yield what a parser finds; what goes wrong in it is a YAMLError."""
    try:
        while loader.check_event():
            yield loader.get_event()
    except (ValueError, OverflowError) as error:
        # The parser in Python trusts the digits of an escape ("\\U00110000") and of a version (%YAML 1.999...).
        problem = 'an escape or a version is out of range'
        raise yaml.MarkedYAMLError(problem=problem, problem_mark=loader.get_mark()) from error
    finally:
        loader.dispose()


def _sentence(error: yaml.YAMLError) -> SceneError:
    mark = getattr(error, 'problem_mark', None) or getattr(error, 'context_mark', None)
    place = f'line {mark.line + 1}, column {mark.column + 1}' if mark else ''
    problem = getattr(error, 'problem', None) or getattr(error, 'context', None) or error
    return SceneError(place, f'must be valid YAML, got an error: {problem}')


def _bytes(path: Path) -> bytes:
    try:
        mode = path.stat().st_mode
        # Opening a pipe that nobody writes to would wait for ever.
        data = _first_bytes(path) if stat.S_ISREG(mode) else b''
    except FileNotFoundError:
        raise SceneError('', 'must be a file, got a path where there is none') from None
    except OSError as error:
        raise SceneError('', f'must be a readable file, got an error: {error.strerror}') from None
    except ValueError:
        raise SceneError('', 'must be a path without null characters, got one') from None
    if stat.S_ISDIR(mode):
        raise SceneError('', 'must be a file, got a directory')
    if not stat.S_ISREG(mode):
        raise SceneError('', 'must be a regular file, got a pipe, socket or device')
    if len(data) > LARGEST_FILE:
        raise SceneError('', f'must be at most {LARGEST_FILE / 1e6:g} MB, got more')
    return data


def _first_bytes(path: Path) -> bytes:
    with path.open('rb') as file:
        return file.read(LARGEST_FILE + 1)


def _text(data: bytes) -> str:
    try:
        text = data.decode('utf-8-sig')
    except UnicodeDecodeError as error:
        line = data.count(b'\n', 0, error.start) + 1
        problem = f'must be UTF-8 text, got the byte 0x{data[error.start]:02x}'
        raise SceneError(f'line {line}', problem) from None
    unprintable = _UNPRINTABLE.search(text)
    if unprintable:
        line = text.count('\n', 0, unprintable.start()) + 1
        problem = f'must be printable text, got the character {unprintable[0]!r}'
        raise SceneError(f'line {line}', problem)
    return text


def _document(events: Iterator[Any]) -> Any:
    next(events)  # the stream's start
    if isinstance(next(events), yaml.StreamEndEvent):
        raise SceneError('', 'must have circles or groups, got an empty file')
    value = _node(next(events), events, '', 0)
    next(events)  # the document's end
    event = next(events)
    if not isinstance(event, yaml.StreamEndEvent):
        raise SceneError('', f'must be one YAML document, got a second one on line {_line(event)}')
    return value


def _node(event: Any, events: Iterator[Any], place: str, depth: int) -> Any:
    if isinstance(event, yaml.AliasEvent):
        raise SceneError(place, f'must be written out, got the alias {shown(f"*{event.anchor}")}')
    if event.anchor is not None:
        raise SceneError(place, f'must have no anchor, got {shown(f"&{event.anchor}")}')
    if event.tag is not None:
        raise SceneError(place, f'must have no YAML tag, got {shown(event.tag)}')
    if isinstance(event, yaml.ScalarEvent):
        return _plain(event.value, place) if event.implicit[0] else _quoted(event.value, place)
    if depth == DEEPEST_NESTING:
        raise SceneError('', f'must be nested at most {DEEPEST_NESTING} deep, got more')
    if isinstance(event, yaml.SequenceStartEvent):
        return _sequence(events, place, depth + 1)
    return _mapping(events, place, depth + 1)


def _sequence(events: Iterator[Any], place: str, depth: int) -> list[Any]:
    items: list[Any] = []
    while not isinstance(event := next(events), yaml.SequenceEndEvent):
        items.append(_node(event, events, inside(place, len(items)), depth))
    return items


def _mapping(events: Iterator[Any], place: str, depth: int) -> dict[str, Any]:
    items: dict[str, Any] = {}
    while not isinstance(event := next(events), yaml.MappingEndEvent):
        if not isinstance(event, yaml.ScalarEvent):
            raise SceneError(place, 'must have words for keys, got a list, a mapping or an alias')
        key = _quoted(event.value, place)
        inner = inside(place, key)
        if key in items:
            raise SceneError(inner, f'must be given once, got it again on line {_line(event)}')
        items[key] = _node(next(events), events, inner, depth)
    return items


def _plain(text: str, place: str) -> Any:
    """Return what a word without quotes means."""
    if text in _WORDS:
        return _WORDS[text]
    # Longer ones are beyond any range that is allowed, and int() itself refuses very long ones.
    if len(text) <= 20 and _INTEGER.fullmatch(text):
        return int(text)
    if _NOT_FINITE.fullmatch(text):
        raise SceneError(place, f'must be finite, got {text}')
    if _FLOAT.fullmatch(text):
        number = float(text)
        if not math.isfinite(number):
            raise SceneError(place, f'must be finite, got {shortened(text)}')
        return number
    return text


def _quoted(text: str, place: str) -> str:
    """Return a text in which escapes may have been; half a character fits into no file and no message."""
    if not text.isascii() and (half := _SURROGATE.search(text)):
        raise SceneError(place, f'must be Unicode text, got {half[0]!r}')
    return text


def _line(event: Any) -> int:
    return int(event.start_mark.line) + 1
