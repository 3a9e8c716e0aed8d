"""
Plain data against config/scene.schema.json; the first fault in the file becomes one sentence.

The schema says in `errorMessage` (a word that editors know) what no keyword says well, and in `x-unit` the
unit of a number.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from functools import lru_cache
from typing import Any

from jsonschema import Draft202012Validator, ValidationError
from jsonschema.validators import extend

from circle_bounce_ros.installation import share_directory
from circle_bounce_ros.kernel import SceneError
from circle_bounce_ros.scene_file.wording import inside, shown

_TYPES = {
    'array': 'a list',
    'boolean': 'true or false',
    'integer': 'a whole number',
    'number': 'a number',
    'object': 'a mapping',
    'string': 'text',
}

_RANGES = {'exclusiveMinimum': '>', 'minimum': '>=', 'exclusiveMaximum': '<', 'maximum': '<='}

# Of several faults in one place the first of these is told: a value of the wrong type breaks other rules too.
_ORDER = ('type', 'additionalProperties', 'required', 'oneOf', 'anyOf', 'exclusiveMinimum')


def check(data: Any) -> None:
    """
    Check plain data against the schema of scene files.

    Raises
    ------
    SceneError
        The first fault in the order of the file.

    """
    errors = list(_validator().iter_errors(data))
    if errors:
        error = min(errors, key=lambda error: _rank(error, data))
        place, problem = _sentence(error)
        raise SceneError(place, problem)


def _first_faulty_item(
    validator: Any, schema: Any, instance: Any, _: Any
) -> Iterator[ValidationError]:
    """Yield the errors of the first item that has some: a long list of mistakes is one mistake."""
    if isinstance(instance, list):
        yield from _first_faulty(validator, ((i, item, schema) for i, item in enumerate(instance)))


def _first_faulty_property(
    validator: Any, schemas: Any, instance: Any, _: Any
) -> Iterator[ValidationError]:
    """Yield the errors of the first property, in the order of the file, that has some."""
    if isinstance(instance, dict):
        known = ((key, value, schemas[key]) for key, value in instance.items() if key in schemas)
        yield from _first_faulty(validator, known)


def _first_faulty(
    validator: Any, parts: Iterable[tuple[str | int, Any, Any]]
) -> Iterator[ValidationError]:
    for key, value, schema in parts:
        if errors := list(validator.descend(value, schema, path=key)):
            yield from errors
            return


# jsonschema itself collects every error of a file, and of a long list there may be a million.
_Validator: Any = extend(  # type: ignore[no-untyped-call]
    Draft202012Validator, {'items': _first_faulty_item, 'properties': _first_faulty_property}
)


@lru_cache(maxsize=1)
def _validator() -> Any:
    path = share_directory() / 'config' / 'scene.schema.json'
    return _Validator(json.loads(path.read_text(encoding='utf-8')))


def _rank(error: ValidationError, data: Any) -> tuple[list[int], int, str]:
    """Return what to sort by: where in the file, then which rule."""
    where = []
    for key in error.absolute_path:
        where.append(list(data).index(key) if isinstance(data, dict) else int(key))
        data = data[key]
    rule = _ORDER.index(error.validator) if error.validator in _ORDER else len(_ORDER)
    return where, rule, error.message


def _sentence(error: ValidationError) -> tuple[str, str]:
    place = _place(error.absolute_path)
    limit: Any = error.validator_value
    value: Any = error.instance
    schema: Any = error.schema
    got = f'got {shown(value)}'
    if error.validator == 'required':
        missing = next(key for key in limit if key not in value)
        return inside(place, missing), 'must be given, got nothing'
    if error.validator == 'additionalProperties':
        unknown = next(key for key in value if key not in schema['properties'])
        known = ', '.join(schema['properties'])
        return inside(place, unknown), f'must be one of the keys {known}, got an unknown key'
    if error.validator == 'type' and (limit == 'object' or 'errorMessage' not in schema):
        return place, f'must be {_TYPES[limit]}, {got}'
    if error.validator in _RANGES:
        unit = f' {schema["x-unit"]}' if 'x-unit' in schema else ''
        return place, f'must be {_RANGES[error.validator]} {limit}{unit}, {got}'
    return place, f'{schema["errorMessage"]}, {got}'


def _place(path: Iterable[str | int]) -> str:
    place = ''
    for key in path:
        place = inside(place, key)
    return place
