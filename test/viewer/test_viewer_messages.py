"""A page may say a few things and nothing else."""

import json

import pytest

from circle_bounce_ros.viewer.messages import FIELDS, MessageError, read

GOOD = [
    {'type': 'ack', 'frame': 7},
    {'type': 'reset'},
    {'type': 'pause', 'paused': True},
    {'type': 'step'},
    {'type': 'time_scale', 'value': 0.25},
    {'type': 'time_scale', 'value': 2},
    {'type': 'scene', 'scene': 'my own/über.yaml', 'seed': -1},
    {'type': 'select', 'circle': -1},
    {'type': 'select', 'circle': 2**32 - 1},
]


@pytest.mark.parametrize('message', GOOD, ids=json.dumps)
def test_what_a_page_says_is_understood_as_it_was_meant(message):
    assert read(json.dumps(message)) == message


def test_there_is_a_good_example_of_every_type():
    assert {message['type'] for message in GOOD} == FIELDS.keys()


@pytest.mark.parametrize(
    'text',
    [
        '',
        'null',
        '[]',
        '"reset"',
        '{}',
        '[' * 1000,
        '{"type": "shutdown"}',
        '{"type": ["reset"]}',
        '{"type": "reset", "now": true}',
        '{"type": "pause"}',
        '{"type": "pause", "paused": 1}',
        '{"type": "ack", "frame": -1}',
        '{"type": "ack", "frame": 1.0}',
        '{"type": "ack", "frame": true}',
        '{"type": "time_scale", "value": NaN}',
        '{"type": "time_scale", "value": 1e999}',
        f'{{"type": "time_scale", "value": 1{"0" * 400}}}',
        '{"type": "time_scale", "value": -1}',
        '{"type": "time_scale", "value": true}',
        '{"type": "scene", "scene": "", "seed": 0}',
        '{"type": "scene", "scene": "a\\nb", "seed": 0}',
        '{"type": "scene", "scene": "lesson", "seed": -2}',
        '{"type": "scene", "scene": 7, "seed": 0}',
        '{"type": "select", "circle": 4294967296}',
        json.dumps({'type': 'scene', 'scene': 'x' * 401, 'seed': 0}),
    ],
)
def test_everything_else_is_refused(text):
    with pytest.raises(MessageError):
        read(text)
