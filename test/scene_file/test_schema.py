"""The JSON Schema is one, says what each key is, and gives every fault a sentence."""

import json

import pytest
from jsonschema import Draft202012Validator

from circle_bounce_ros.installation import share_directory
from circle_bounce_ros.kernel import SceneError
from circle_bounce_ros.scene_file import schema as schema_module

SCHEMA = json.loads(
    (share_directory() / 'config' / 'scene.schema.json').read_text(encoding='utf-8')
)


def parts(part, place='schema'):
    """Yield each subschema that describes a value, with its place."""
    yield place, part
    for name, inner in {**part.get('properties', {}), **part.get('$defs', {})}.items():
        yield from parts(inner, f'{place}.{name}')
    if 'items' in part:
        yield from parts(part['items'], f'{place}[]')


PARTS = dict(parts(SCHEMA))


def test_the_schema_is_valid_by_its_own_metaschema():
    Draft202012Validator.check_schema(SCHEMA)


@pytest.mark.parametrize('place', PARTS)
def test_every_part_has_a_description_that_begins_like_a_sentence_and_ends_it(place):
    part = PARTS[place]
    if '$ref' in part and 'description' not in part:
        part = SCHEMA['$defs'][part['$ref'].removeprefix('#/$defs/')]
    assert part['description'].endswith('.')
    assert part['description'][0].isupper() or part['description'].startswith('true')


@pytest.mark.parametrize('place', PARTS)
def test_every_number_with_a_unit_names_it_in_its_description(place):
    unit = PARTS[place].get('x-unit')
    if unit:
        assert f' {unit}' in PARTS[place]['description']


@pytest.mark.parametrize('place', PARTS)
def test_every_mapping_refuses_unknown_keys(place):
    if 'properties' in PARTS[place]:
        assert PARTS[place]['additionalProperties'] is False


@pytest.mark.parametrize('place', PARTS)
def test_every_rule_that_needs_a_sentence_of_its_own_has_one(place):
    part = PARTS[place]
    need_words = {'pattern', 'maxLength', 'minItems', 'maxItems', 'oneOf', 'anyOf'} & set(part)
    if need_words or isinstance(part.get('type'), list):
        assert part['errorMessage'].startswith('must ')


def test_no_rule_is_used_that_has_no_sentence():
    annotations = {'$schema', '$defs', '$ref', 'title', 'description', 'default', 'errorMessage'}
    rules = {'type', 'properties', 'items', 'additionalProperties', 'required', 'pattern', 'oneOf'}
    rules |= {'anyOf', 'minItems', 'maxItems', 'maxLength', 'x-unit', *schema_module._RANGES}
    for part in PARTS.values():
        assert set(part) <= annotations | rules


@pytest.mark.parametrize('place', PARTS)
def test_defaults_obey_their_own_rules(place):
    part = PARTS[place]
    if 'default' in part:
        Draft202012Validator(part).validate(part['default'])


COUNT = 200
BOX = {'min': [0, 0], 'max': [1, 1]}
KEYS = {f'k{i}': 1 for i in range(COUNT)}
LONG_MISTAKES = {
    'numbers for circles': {'circles': [1] * COUNT},
    'circles of nothing': {'circles': [{}] * COUNT},
    'keys of the file': KEYS,
    'keys of a circle': {'circles': [KEYS]},
    'keys of circles': {'circles': [{'a': 1, 'b': 2}] * COUNT},
    'coordinates': {'circles': [{'radius': 1, 'position': ['x'] * COUNT}]},
    'half walls': {'circles': [], 'walls': [{'start': [5, 5]}] * COUNT},
    'corners': {'circles': [], 'walls': [{'polygon': [[1]] * COUNT}]},
    'radii': {'groups': [{'count': 1, 'region': BOX, 'radius': ['x'] * COUNT}]},
    'groups': {'groups': ['x'] * COUNT},
    'everywhere': {'circles': [1] * COUNT, 'walls': [1] * COUNT, 'groups': [1] * COUNT},
}


@pytest.mark.parametrize('data', LONG_MISTAKES.values(), ids=LONG_MISTAKES)
def test_a_mistake_made_many_times_is_looked_at_once(data):
    errors = list(schema_module._validator().iter_errors(data))
    # One for each rule that the first faulty thing on each level breaks.
    assert 1 <= len(errors) <= 6
    # What all errors there are would have come to.
    assert len(errors) <= len(list(Draft202012Validator(SCHEMA).iter_errors(data)))


@pytest.mark.parametrize('data', LONG_MISTAKES.values(), ids=LONG_MISTAKES)
def test_the_mistake_that_is_told_is_the_first_of_all_that_there_are(data):
    errors = list(Draft202012Validator(SCHEMA).iter_errors(data))
    first = schema_module._sentence(min(errors, key=lambda e: schema_module._rank(e, data)))
    with pytest.raises(SceneError) as refused:
        schema_module.check(data)
    assert (refused.value.place, refused.value.problem) == first
