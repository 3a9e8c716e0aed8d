"""No file whatsoever ends in anything but a scene or a sentence."""

import copy
import random

import pytest
import yaml

from circle_bounce_ros.kernel import Scene, SceneError
from circle_bounce_ros.scene_file import load_scene

GOOD = {
    'circles': [
        {'name': 'a', 'position': [0, 0], 'velocity': [1, 0], 'radius': 0.1, 'mass': 1},
        {'position': [1, 0], 'radius': 0.1, 'locked': True},
    ],
    'walls': [
        {'start': [-3, -1], 'end': [-3, 1]},
        {'box': {'min': [-4, -4], 'max': [4, 4]}},
        {'polygon': [[2, 2], [3, 2], [3, 3]]},
    ],
    'groups': [
        {
            'count': 5,
            'radius': [0.05, 0.1],
            'speed': 1,
            'region': {'min': [-1, -3], 'max': [1, -1]},
        },
        {'count': 3, 'packing': 0.5, 'locked': True, 'region': {'min': [-3, 2], 'max': [0, 3]}},
        {'radius': 0.1, 'packing': 0.1, 'mass': 2, 'region': {'min': [-2, 1], 'max': [0, 2]}},
    ],
    'moving_circles_collide': True,
    'restart_after': 10,
    'seed': 1,
}

NASTY = [
    0,
    -1,
    1,
    2,
    3,
    0.5,
    1e-9,
    9e9,
    1e60,
    -1e60,
    1e61,
    1e-60,
    1e-61,
    5e-324,
    1e308,
    2**63,
    True,
    None,
]
NASTY += ['', 'x', '1e5', [], [0], [0, 0], [1, 1], [1e-60, 1e60], {}, {'maxwell': 1}, {'x': 0}]


def places(value, path=()):
    items = ()
    if isinstance(value, dict):
        items = value.items()
    elif isinstance(value, list):
        items = enumerate(value)
    for key, inner in items:
        yield (*path, key)
        yield from places(inner, (*path, key))


def spoil(data, rng):
    """Return a copy in which one place is something else, or is missing."""
    data = copy.deepcopy(data)
    *outer, last = rng.choice(list(places(data)))
    holder = data
    for key in outer:
        holder = holder[key]
    if rng.random() < 0.1:
        del holder[last]
    else:
        holder[last] = rng.choice(NASTY)
    return data


def outcome(path):
    """Return the scene, or the sentence that refuses it."""
    try:
        return load_scene(path)
    except SceneError as error:
        return str(error)


def is_one_line_about(path, sentence):
    return sentence.startswith(f'{path}: ') and '\n' not in sentence


@pytest.mark.parametrize('seed', range(8))
def test_a_spoiled_file_gives_a_scene_or_one_line(seed, write):
    rng = random.Random(seed)
    scenes = 0
    for _ in range(100):
        data = GOOD
        for _ in range(rng.randint(1, 3)):
            data = spoil(data, rng)
        path = write(yaml.safe_dump(data))
        result = outcome(path)
        assert isinstance(result, Scene) or is_one_line_about(path, result)
        scenes += isinstance(result, Scene)
    # Some of them are fine: the values go all the way through, not only as far as the schema.
    assert 2 <= scenes <= 60


@pytest.mark.parametrize('seed', range(4))
def test_bytes_at_random_give_one_line(seed, tmp_path):
    rng = random.Random(seed)
    good = yaml.safe_dump(GOOD).encode()
    path = tmp_path / 'bytes.yaml'
    for _ in range(100):
        data = bytearray(good)
        for _ in range(rng.randint(1, 5)):
            data[rng.randrange(len(data))] = rng.choice(b'\0\t\n\xff!&*-:[]{}"\'|>%@`#?,~0a')
        path.write_bytes(data)
        result = outcome(path)
        assert isinstance(result, Scene) or is_one_line_about(path, result)
