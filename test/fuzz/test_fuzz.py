"""Odd input of every kind ends in words: a few cases with fixed seeds; `make fuzz` goes on with others."""

import random

import engine
import live
import pytest
from observing import NodeProcess, Observer
from targets import TARGETS
from viewing import VIEWER, address_of, end_all

CASES = {'scene': 300, 'sweep': 200, 'topic': 60, 'socket': 500, 'bag': 3, 'table': 20}


@pytest.mark.parametrize('name', TARGETS)
def test_odd_input_ends_in_words(name, tmp_path):
    were_good = set()
    for seed in range(CASES[name]):
        folder = tmp_path / str(seed)
        folder.mkdir()
        try:
            were_good.add(TARGETS[name](random.Random(f'{name} {seed}'), folder))
        except Exception as fault:
            raise AssertionError(f'{name}, seed {seed}: the input is in {folder}') from fault
    # Some input goes all the way through, not only as far as the parser.
    assert were_good in ({True, False}, {None})


def test_odd_scenes_run_to_the_same_bits_plain_and_compiled_and_however_cut():
    pytest.importorskip('numba')
    assert sum(engine.check(seed) for seed in range(20)) >= 10


@pytest.fixture
def observer(domain):
    observer = Observer(domain)
    yield observer
    observer.close()


def test_the_node_outlives_odd_parameters_and_says_no_fault_of_its_own(observer, tmp_path):
    process = NodeProcess(tmp_path / 'log')
    try:
        observer.wait_for_node()
        live.node(random.Random('node 0'), tmp_path, observer, process, 150)
    finally:
        end_all([process])


def test_the_viewer_outlives_odd_messages(observer, tmp_path):
    process = NodeProcess(tmp_path / 'log', '-p', 'port:=0', program=VIEWER)
    try:
        address = address_of(process)
        live.viewer(random.Random('viewer 0'), tmp_path, observer, address, process, 10)
    finally:
        end_all([process])
