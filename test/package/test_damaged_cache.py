"""Whatever happens to the compiled code on disk, functions give their values, and one warning says what happened."""

import os
import resource
import shutil
import threading
import warnings

import pytest

from circle_bounce_ros.kernel import Circle, Scene, Simulation, compile_ahead
from circle_bounce_ros.kernel.engine import backends, code_cache
from circle_bounce_ros.kernel.engine.code_cache import CodeCache, find, is_ready, write

numba = pytest.importorskip('numba', reason='numba is not installed: there is nothing to compile')


@pytest.fixture
def home(tmp_path, monkeypatch):
    """Return the user's cache folder, empty; the folder after it is `temporary` beside it."""
    monkeypatch.setenv('XDG_CACHE_HOME', str(tmp_path / 'cache'))
    monkeypatch.setattr(code_cache.tempfile, 'tempdir', str(tmp_path / 'temporary'))
    (tmp_path / 'temporary').mkdir()
    return tmp_path / 'cache/circle_bounce_ros'


def three_doubled():
    """Return 6 and the warnings, by a function that is compiled, or read from disk, in place of the engine."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter('always')
        code = CodeCache()
        double = numba.njit(lambda x: 2 * x)
        code.attach(double)
        value = double(3)
        code.save()
    return value, [str(warning.message) for warning in caught], bool(double.stats.cache_hits)


def test_what_was_compiled_is_read_by_the_next_without_a_warning(home):
    assert not is_ready()
    assert three_doubled() == (6, [], False)
    assert is_ready()
    assert three_doubled() == (6, [], True)
    assert [path.name for path in home.iterdir()] == [code_cache.file_name()]


def with_checksum(content):
    return code_cache.CHECKSUM(content).digest() + content


DAMAGE = {
    'empty': lambda path: path.write_bytes(b''),
    'cut': lambda path: path.write_bytes(path.read_bytes()[:-1]),
    'cut to its checksum': lambda path: path.write_bytes(path.read_bytes()[:32]),
    'one bit': lambda path: path.write_bytes(
        path.read_bytes()[:-9] + b'\0' + path.read_bytes()[-8:]
    ),
    'machine code': lambda path: path.write_bytes(
        path.read_bytes().replace(b'\x7fELF', b'\x7fBAD')
    ),
    'random': lambda path: path.write_bytes(os.urandom(5000)),
    'no pickle': lambda path: path.write_bytes(with_checksum(b'\x80\x05garbage')),
    'no code': lambda path: path.write_bytes(with_checksum(b'N.')),
    'a folder': lambda path: (path.unlink(), path.mkdir(), (path / 'file').touch()),
    'a dangling link': lambda path: (path.unlink(), path.symlink_to('nowhere')),
    'a link to itself': lambda path: (path.unlink(), path.symlink_to(path.name)),
    'writable by anybody': lambda path: path.chmod(0o666),
    'of another user': lambda path: os.chown(path, 12345, -1),
}


@pytest.mark.parametrize('damage', DAMAGE)
def test_damaged_code_is_compiled_and_written_again(home, damage):
    if damage == 'of another user' and os.getuid():
        pytest.skip('only root may give files away')
    three_doubled()
    path = home / code_cache.file_name()
    DAMAGE[damage](path)
    # Otherwise it would be handed to LLVM, which may end the process.
    assert is_ready() == (damage in ('no pickle', 'no code'))
    value, (warning,), read = three_doubled()
    assert (value, read) == (6, False)
    assert str(path) in warning
    assert is_ready()
    assert three_doubled() == (6, [], True)


def test_code_that_numba_cannot_use_is_compiled_again(home, monkeypatch):
    three_doubled()
    payloads = code_cache.pickle.loads(find()[1])
    write(code_cache.pickle.dumps(dict.fromkeys(payloads, ('nonsense',))))
    value, (warning,), _ = three_doubled()
    assert value == 6
    assert 'cannot be used' in warning
    assert three_doubled() == (6, [], True)


@pytest.mark.parametrize('place', ['a file', 'a dangling link', 'of another user'])
def test_where_the_users_folder_cannot_be_used_the_temporary_one_serves(home, tmp_path, place):
    home.parent.mkdir()
    if place == 'a file':
        home.touch()
    elif place == 'a dangling link':
        home.symlink_to('nowhere')
    elif os.getuid():
        pytest.skip('only root may give folders away')
    else:
        home.mkdir()
        os.chown(home, 12345, -1)
    assert three_doubled() == (6, [], False)
    assert find()[0].is_relative_to(tmp_path / 'temporary')
    assert three_doubled() == (6, [], True)


def test_a_full_disk_costs_the_next_start_and_no_more(home):
    """No file may grow over 1,000 bytes, which is told as a full disk is: by an OSError in the middle of it."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        value, (warning,), _ = three_doubled()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert value == 6
    assert 'not kept' in warning
    assert not is_ready()
    assert not list(home.iterdir())
    assert three_doubled() == (6, [], False)
    assert three_doubled() == (6, [], True)


def test_with_no_place_at_all_compiled_code_is_not_kept(monkeypatch):
    monkeypatch.setattr(code_cache, 'folders', list)
    value, (warning,), _ = three_doubled()
    assert value == 6
    assert 'not kept' in warning
    assert not is_ready()


def test_a_cache_that_is_removed_in_between_is_compiled_again(home):
    three_doubled()
    shutil.rmtree(home.parent)
    assert not is_ready()
    assert three_doubled() == (6, [], False)


def test_relative_places_are_none(monkeypatch):
    monkeypatch.setenv('XDG_CACHE_HOME', 'here')
    monkeypatch.setattr(code_cache.tempfile, 'tempdir', 'there')
    assert code_cache.folders() == []


def test_two_writers_never_leave_half_of_a_file(home):
    contents = [bytes([letter]) * 100_000 for letter in b'ab']

    def write_often(content):
        for _ in range(50):
            assert write(content) == ''

    writers = [threading.Thread(target=write_often, args=[content]) for content in contents]
    write(contents[0])
    for writer in writers:
        writer.start()
    while any(writer.is_alive() for writer in writers):
        assert find()[1] in contents
    assert len(list(home.iterdir())) == 1


def test_code_of_older_sources_goes_when_nobody_has_used_it_for_long(home):
    home.mkdir(parents=True)
    kept, old, left = (home / f'{letter * 16}.code' for letter in 'abc')
    folder = home / ('d' * 16)
    foreign = home / 'mine.txt'
    folder.mkdir()
    left = left.with_suffix('.code.x1')
    for path in (kept, old, left, foreign, folder / 'ready'):
        path.touch()
    for path in (old, left, foreign, folder):
        os.utime(path, (0, 0))
    assert write(b'new') == ''
    assert set(home.iterdir()) == {kept, foreign, home / code_cache.file_name()}


def test_code_that_is_used_is_not_old(home):
    write(b'content')
    path = home / code_cache.file_name()
    os.utime(path, (0, 0))
    assert is_ready()
    assert path.stat().st_mtime > 1e9


def test_an_engine_that_cannot_be_compiled_runs_plain_with_one_warning(monkeypatch):
    def fail():
        raise RuntimeError('no LLVM here')

    monkeypatch.setattr(backends, 'compiled', fail)
    backends.fastest.cache_clear()
    scene = Scene([Circle((2.0 * x, 0.0), (1.0, 0.0), radius=0.1) for x in range(9)])
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter('always')
            simulations = [Simulation(scene) for _ in range(3)]
            assert not compile_ahead()
    finally:
        backends.fastest.cache_clear()
    assert ['no LLVM here' in str(warning.message) for warning in caught] == [True]
    for simulation in simulations:
        simulation.advance_to(1.0)
        assert simulation.positions[0].tolist() == [1.0, 0.0]
