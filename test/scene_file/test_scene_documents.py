"""docs/scenes.md says what is so: its examples load, its tables have the schema's keys, defaults and scenes."""

import json
import re

import pytest
import yaml

from circle_bounce_ros.installation import share_directory
from circle_bounce_ros.scene_file import load_scene, scene_names

ROOT = share_directory()
TEXT = (ROOT / 'docs' / 'scenes.md').read_text(encoding='utf-8')
SCHEMA = json.loads((ROOT / 'config' / 'scene.schema.json').read_text(encoding='utf-8'))
EXAMPLES = re.findall(r'^```yaml\n(.*?)^```', TEXT, re.DOTALL | re.MULTILINE)


def rows(title):
    """Return the rows of the table under a title, each as a list of cells without back quotes."""
    section = TEXT.split(f'\n## {title}\n')[1].split('\n## ')[0]
    lines = [line for line in section.splitlines() if line.startswith('|')]
    return [
        [cell.strip().replace('`', '') for cell in line.split('|')[1:-1]] for line in lines[2:]
    ]


def test_there_are_examples():
    assert len(EXAMPLES) == 4


@pytest.mark.parametrize('example', EXAMPLES)
def test_an_example_loads(example, write):
    assert load_scene(write(example)).circles


def test_the_first_example_is_the_lesson(write):
    lesson, example = load_scene('lesson'), load_scene(write(EXAMPLES[0]))
    assert (example.circles, example.walls) == (lesson.circles, lesson.walls)


@pytest.mark.parametrize(
    ('title', 'properties'),
    [
        ('The file', SCHEMA['properties']),
        ('Circles', SCHEMA['$defs']['circle']['properties']),
        ('Walls', SCHEMA['$defs']['wall']['properties']),
        ('Groups', SCHEMA['$defs']['group']['properties']),
    ],
)
def test_a_table_has_the_keys_of_the_schema(title, properties):
    assert {key for row in rows(title) for key in row[0].split(', ')} == set(properties)


@pytest.mark.parametrize(('title', 'part'), [('Circles', 'circle'), ('Groups', 'group')])
def test_a_table_has_the_defaults_of_the_schema(title, part):
    part = SCHEMA['$defs'][part]
    for key, _, _, default, *_ in rows(title):
        rules = SCHEMA['$defs']['mass'] if key == 'mass' else part['properties'][key]
        if default == 'required':
            assert key in part['required']
        elif default not in {'', 'none'}:
            assert yaml.safe_load(default) == rules['default']


def test_the_last_table_has_the_packaged_scenes():
    named = {re.match(r'\[(\w+)\]', row[0])[1] for row in rows('The packaged scenes')}
    assert named == set(scene_names())
