"""Odd input, made from good input by chance: each function takes a `random.Random`."""

import copy
import json

GOOD_SCENE = {
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

GOOD_SWEEP = {
    'scene': 'gas',
    'parameters': {
        'groups[0].packing': {'from': 0.05, 'to': 0.45, 'steps': 9},
        'groups[0].count': [250, 1000],
    },
    'seeds': {'first': 0, 'count': 4},
    'duration': 60.0,
    'warm_up': 5.0,
    'rate': 20.0,
    'record': 'bag',
    'topics': ['poses'],
}

GOOD_MESSAGES = [
    {'type': 'ack', 'frame': 1},
    {'type': 'reset'},
    {'type': 'pause', 'paused': True},
    {'type': 'step'},
    {'type': 'time_scale', 'value': 1.5},
    {'type': 'scene', 'scene': 'gas', 'seed': 1},
    {'type': 'select', 'circle': 0},
]

VALUES = [0, -1, 1, 2, 3, 0.5, 1e-9, 9e9, 1e60, -1e60, 1e61, 1e-60, 1e-61, 5e-324, 1e308]
VALUES += [2**53, 2**63, 10**400, float('inf'), float('nan'), True, None, '', 'x', '1e5', 'a\0b']
VALUES += ['ü', '\U0001f534', '../..', '/dev/zero', [], [0], [0, 0], [1, 1], [1e-60, 1e60], {}]
VALUES += [{'maxwell': 1}, {'x': 0}, ['x'] * 50]

# What is special to YAML, to JSON or to Unicode, put anywhere.
PIECES = ['\\U00110000', '\\uD800', '\\x00', '"', "'", '&a ', '*a', '!!set ', '!!binary ', '<<: ']
PIECES += ['!!float ', '%YAML 1.9\n---\n', '%TAG ! x\n---\n', '- ', '? ', ': ', '{', '}', '[', ']']
PIECES += ['|', '>', '#', '\t', '\n', '---\n', '...\n', '2001-01-01', '1e999', '9' * 400, '.nan']
PIECES += ['\ufeff', '\x85', '\u2028', '\x7f', '\0', ',', '[' * 50, '{a: ' * 30, '0x1F', '1_000']


def places(value, path=()):
    """Yield the path of each value inside another."""
    items = ()
    if isinstance(value, dict):
        items = value.items()
    elif isinstance(value, list):
        items = enumerate(value)
    for key, inner in items:
        yield (*path, key)
        yield from places(inner, (*path, key))


def spoil(data, rng, times):
    """Return a copy in which a few places are something else, are missing, or are there under another name."""
    data = copy.deepcopy(data)
    for _ in range(rng.randint(1, times)):
        found = list(places(data))
        if not found:
            break
        *outer, last = rng.choice(found)
        holder = data
        for key in outer:
            holder = holder[key]
        way = rng.random()
        if way < 0.1:
            del holder[last]
        elif way < 0.2 and isinstance(holder, dict):
            holder[rng.choice(PIECES)] = holder.pop(last)
        else:
            holder[last] = copy.deepcopy(rng.choice(VALUES))
    return data


def damage(data, rng):
    """Return bytes of which some are others, are missing or come twice, or which end early."""
    data = bytearray(data)
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(data) + 1)
        length = min(len(data) - at, int(2 ** (12 * rng.random())))
        way = rng.randrange(6)
        if way == 0:
            data[at : at + length] = rng.randbytes(length)
        elif way == 1:
            del data[at : at + length]
        elif way == 2:
            data[at:at] = data[at : at + length]
        elif way == 3:
            data[at : at + 4] = rng.choice([b'\xff' * 4, bytes(4), b'\x01\0\0\0', b'\0\0\0\x80'])
        elif way == 4:
            data[at : at + 1] = rng.randbytes(1)
        elif rng.random() < 0.3:
            del data[at:]
    return bytes(data)


def spoiled_text(text, rng):
    """Return a text with pieces in it that mean something, as bytes."""
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(text) + 1)
        text = text[:at] + rng.choice(PIECES) + text[at + rng.choice([0, 0, 1, 5]) :]
    return text.encode('utf-8', 'surrogatepass')


def yaml_of(data):
    """Return data as YAML; JSON is, but for its words for infinity."""
    return json.dumps(data).replace('Infinity', '.inf').replace('NaN', '.nan')


def yaml_file(good, rng):
    """Return the bytes of a file that is nearly a good one."""
    way = rng.random()
    data = good if way < 0.4 else spoil(good, rng, 3)
    if way < 0.2:
        return damage(yaml_of(data).encode(), rng)
    if way < 0.4:
        return spoiled_text(yaml_of(data), rng)
    encoding = 'utf-16' if way < 0.42 else 'utf-8-sig' if way < 0.44 else 'utf-8'
    return yaml_of(data).encode(encoding)


def socket_message(rng):
    """Return a text or bytes that is nearly a message of a page."""
    way = rng.random()
    data = rng.choice(GOOD_MESSAGES)
    if way < 0.1:
        return rng.randbytes(rng.randrange(200))
    if way < 0.3:
        return spoiled_text(json.dumps(data), rng).decode('utf-8', 'replace')
    if way < 0.4:
        return rng.choice(['[' * 4000, '{"a":' * 800, '9' * 4000, '"' + 'x' * 5000, '', '\0'])
    return json.dumps(spoil(data, rng, 2))
