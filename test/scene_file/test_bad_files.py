"""Whatever is wrong with a file is said in one sentence: file, place, rule, value."""

import os

import pytest
import yaml
from bad_files import BAD_FILES, GOOD_CIRCLE

from circle_bounce_ros.kernel import SceneError
from circle_bounce_ros.scene_file import load_scene, reading, scene_names


def sentence(path, seed=None):
    with pytest.raises(SceneError) as refused:
        load_scene(path, seed)
    return str(refused.value)


@pytest.mark.parametrize('name', BAD_FILES)
def test_a_bad_file_is_refused_with_place_rule_and_value(name, bad_folder, monkeypatch):
    monkeypatch.chdir(bad_folder)
    assert sentence(f'{name}.yaml') == f'{name}.yaml: {BAD_FILES[name][1]}'


@pytest.mark.parametrize('name', BAD_FILES)
def test_the_sentence_is_the_same_without_the_parser_in_c(name, bad_folder, monkeypatch):
    monkeypatch.chdir(bad_folder)
    monkeypatch.setattr(reading, 'FastLoader', yaml.SafeLoader)
    assert sentence(f'{name}.yaml') == f'{name}.yaml: {BAD_FILES[name][1]}'


@pytest.mark.parametrize('name', scene_names())
def test_a_good_file_reads_the_same_without_the_parser_in_c(name, monkeypatch):
    fast = load_scene(name)
    monkeypatch.setattr(reading, 'FastLoader', yaml.SafeLoader)
    assert load_scene(name) == fast


def test_the_first_fault_in_the_file_is_told(write):
    text = (
        'circles:\n- {position: [0, 0], radius: 1, mass: -1}\n- {position: [0, 0], radius: -1}\n'
    )
    assert 'circles[0].mass' in sentence(write(text))
    text = 'walls: [{start: [1, 1]}]\ncircles: [{position: [0, 0], radius: -1}]\n'
    assert 'walls[0]' in sentence(write(text))


def test_a_place_can_be_read_from_the_error(write):
    path = write('circles: [{position: [0, 0], radius: -1}]\n')
    with pytest.raises(SceneError) as refused:
        load_scene(path)
    assert refused.value.place == f'{path}: circles[0].radius'
    assert refused.value.problem == 'must be > 0 m, got -1'


def test_a_missing_file_is_refused(tmp_path):
    path = f'{tmp_path}/none.yaml'
    assert sentence(path) == f'{path}: must be a file, got a path where there is none'


def test_a_directory_is_refused(tmp_path):
    assert sentence(f'{tmp_path}/') == f'{tmp_path}/: must be a file, got a directory'


def test_a_path_through_a_file_is_refused(write):
    path = f'{write(GOOD_CIRCLE)}/scene.yaml'
    assert sentence(path) == f'{path}: must be a readable file, got an error: Not a directory'


@pytest.mark.skipif(os.geteuid() == 0, reason='root may read every file')
def test_a_file_that_may_not_be_read_is_refused(write):
    path = write(GOOD_CIRCLE)
    path.chmod(0)
    assert sentence(path) == f'{path}: must be a readable file, got an error: Permission denied'


def test_a_path_with_a_null_character_is_refused():
    assert sentence('a\0.yaml') == 'a\0.yaml: must be a path without null characters, got one'


def test_a_pipe_that_nobody_writes_to_is_refused_at_once(tmp_path):
    path = f'{tmp_path}/pipe.yaml'
    os.mkfifo(path)
    expected = f'{path}: must be a regular file, got a pipe, socket or device'
    assert sentence(path) == expected


def test_a_file_of_more_than_10_mb_is_refused(write):
    path = write('#' * (reading.LARGEST_FILE + 1))
    assert sentence(path) == f'{path}: must be at most 50 MB, got more'


@pytest.mark.parametrize('name', ['nosuch', '', 'Lesson', 'lesson '])
def test_an_unknown_name_is_refused_with_the_names_there_are(name):
    assert sentence(name) == (
        'scene: must be one of billiard, break, digits_of_pi, gas, lesson, mixed, pegboard, '
        f"or a path (with '/' or ending in .yaml), got {name!r}"
    )


@pytest.mark.parametrize('seed', [-1, 2**63, 0.5, True, '1'])
def test_a_seed_that_is_none_is_refused(seed):
    expected = 'must be a whole number from 0 to 9223372036854775807'
    assert sentence('gas', seed) == f'gas: seed: {expected}, got {seed!r}'
