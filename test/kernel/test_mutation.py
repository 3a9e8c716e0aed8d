"""
A bounce at a strange angle is nearly always a sign error: each sign and comparison, flipped, fails a test.

Every `+` and `-` of the lesson's formulas is turned into the other, one at a time, and every comparison is
turned round and has its boundary moved to the other side. The tests of that file are then run against the
module so changed, until one fails. `pytest -v` lists the changes.
"""

import ast
import tokenize
import types
import warnings
from functools import partial
from pathlib import Path

import pytest
import test_contact
import test_impact
import test_reflection

from circle_bounce_ros.kernel import contact, impact, reflection

TESTS_OF = {contact: test_contact, reflection: test_reflection, impact: test_impact}

OTHER_SIGN = {ast.Add: ast.Sub, ast.Sub: ast.Add}
TURNED_ROUND = {
    ast.Lt: ast.Gt,
    ast.Gt: ast.Lt,
    ast.LtE: ast.GtE,
    ast.GtE: ast.LtE,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
}
OTHER_BOUNDARY = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}

# Changes that no test can see, as they change no result that is promised.
EQUIVALENT = {
    'time_to_touch_xy: gap_sq > -2.0 * closing * limit -> gap_sq >= -2.0 * closing * limit': (
        'a touch at the very limit may be left out or given'
    ),
    'time_to_touch_xy: gap_sq <= 0.0 -> gap_sq < 0.0': (
        'without a gap the last line gives 0 as well: the root is that of the square of closing'
    ),
    'time_to_wall_xy: side < 0.0 -> side <= 0.0': (
        'a centre on the wall itself is on neither side of it, and a scene never puts one there'
    ),
    'time_to_wall_xy: wait < 0.0 -> wait <= 0.0': 'zero is replaced by zero',
}


def flips(tree):
    """Yield function, node, attribute and value for each change that can be made."""
    for function in tree.body:
        for node in ast.walk(function):
            if isinstance(node, (ast.BinOp, ast.AugAssign)) and type(node.op) in OTHER_SIGN:
                yield function, node, 'op', OTHER_SIGN[type(node.op)]()
            elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
                yield function, node, 'op', ast.UAdd()
            elif isinstance(node, ast.Compare):
                (op,) = node.ops
                for others in (TURNED_ROUND, OTHER_BOUNDARY):
                    if type(op) in others:
                        yield function, node, 'ops', [others[type(op)]()]


def mutants_of(module):
    """Yield a name and the code of each mutant of a module."""
    source = Path(module.__file__).read_text(encoding='utf-8')
    for k in range(len(list(flips(ast.parse(source))))):
        tree = ast.parse(source)
        function, node, attribute, value = list(flips(tree))[k]
        name = f'{function.name}: {ast.unparse(node)}'
        setattr(node, attribute, value)
        name += f' -> {ast.unparse(node)}'
        yield name, compile(tree, '<mutant>', 'exec')


def runs_of(tests):
    """Yield the tests of a file as functions without arguments, one for each set of parameters."""
    for name, test in vars(tests).items():
        if not name.startswith('test_'):
            continue
        marks = [mark for mark in getattr(test, 'pytestmark', ()) if mark.name == 'parametrize']
        if not marks:
            yield test
            continue
        (mark,) = marks
        names, values = mark.args
        for value in values:
            yield partial(test, *([value] if isinstance(names, str) else value))


RUNS_OF = {module: list(runs_of(tests)) for module, tests in TESTS_OF.items()}
MUTANTS = [(module, *mutant) for module in TESTS_OF for mutant in mutants_of(module)]


def fails(run):
    try:
        with warnings.catch_warnings():
            warnings.simplefilter('error')
            run()
    except (Exception, pytest.fail.Exception):
        return True
    return False


def is_killed(module, code, monkeypatch):
    """Run the tests of a module against its mutant until one fails."""
    mutant = types.ModuleType(module.__name__)
    exec(code, vars(mutant))
    for name, function in vars(mutant).items():
        if isinstance(function, types.FunctionType) and function.__module__ == module.__name__:
            monkeypatch.setattr(module, name, function)
    runs = RUNS_OF[module]
    for k, run in enumerate(runs):
        if fails(run):
            runs.insert(0, runs.pop(k))  # what has killed one mutant is likely to kill the next
            return True
    return False


@pytest.mark.parametrize(('module', 'name', 'code'), MUTANTS, ids=[name for _, name, _ in MUTANTS])
def test_a_flipped_sign_fails_a_test(module, name, code, monkeypatch):
    if name in EQUIVALENT:
        assert not is_killed(module, code, monkeypatch), f'not equivalent: {EQUIVALENT[name]}'
    else:
        assert is_killed(module, code, monkeypatch), 'no test has seen this change'


@pytest.mark.parametrize('module', TESTS_OF, ids=[module.__name__ for module in TESTS_OF])
def test_unchanged_the_same_tests_pass(module, monkeypatch):
    code = compile(Path(module.__file__).read_text(encoding='utf-8'), '<unchanged>', 'exec')
    assert len(RUNS_OF[module]) > 40
    assert not is_killed(module, code, monkeypatch)


@pytest.mark.parametrize('module', TESTS_OF, ids=[module.__name__ for module in TESTS_OF])
def test_no_sign_has_been_overlooked(module):
    with open(module.__file__, 'rb') as file:
        tokens = [token.string for token in tokenize.tokenize(file.readline)]
    signs = sum(tokens.count(sign) for sign in ('+', '-', '+=', '-='))
    turned_round = sum(tokens.count(sign) for sign in ('<', '<=', '>', '>=', '==', '!='))
    other_boundary = sum(tokens.count(sign) for sign in ('<', '<=', '>', '>='))
    changes = [name for of, name, _ in MUTANTS if of is module]
    assert len(changes) == signs + turned_round + other_boundary > 10


def test_no_change_is_called_equivalent_that_is_none():
    assert set(EQUIVALENT) <= {name for _, name, _ in MUTANTS}
