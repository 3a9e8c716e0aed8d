"""What is left of a recording that a signal, kill -9 or a full disk ended."""

from __future__ import annotations

import resource
import signal
import subprocess

import numpy as np
import pytest
from conftest import files_of, wait_until
from mcap.reader import make_reader
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from pyarrow import parquet
from reading import SECOND, raw_with_mcap, read_with_rosbags, record

from circle_bounce_ros.offline.record import main

LONG = ['gas', '--duration', 100000, '--topics', 'poses', 'time']


def size(folder):
    return sum(path.stat().st_size for path in folder.glob('*.mcap'))


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_after_ctrl_c_or_a_kill_the_bag_is_whole_up_to_where_it_came(tmp_path, bounce, number):
    folder = tmp_path / 'bag'
    process = bounce.start('bounce_record', *LONG, '-o', folder)
    wait_until(lambda: size(folder) > 3e6, 'three megabytes')
    process.send_signal(number)
    out, error = process.communicate(timeout=60)
    assert process.returncode == 128 + number
    assert 'stopped after' in out
    assert error == ''
    assert_is_a_beginning(folder)


def test_a_second_ctrl_c_ends_it_at_once_and_says_how_to_go_on(tmp_path, capsys):
    folder = tmp_path / 'bag'

    def interrupt(number, frame):
        if size(folder) > 3e6:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.default_int_handler(number, frame)

    # Of another number than the first one, which would only be noted.
    before = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 0.05, 0.05)
    try:
        status = main([str(argument) for argument in [*LONG, '-o', folder]])
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert status == 128 + signal.SIGINT
    error = capsys.readouterr().err
    assert f'bounce_record: {folder}: interrupted, at ' in error
    assert f'bounce_record --repair {folder}' in error
    assert len(error.splitlines()) == 1
    assert main(['--repair', str(folder)]) == 0
    assert_is_a_beginning(folder)


def assert_is_a_beginning(folder):
    """Check that a bag holds every message from the first tick on, by both readers."""
    by_rosbags = sorted((topic, time) for topic, time, _ in read_with_rosbags(folder))
    messages = raw_with_mcap(folder)
    assert by_rosbags == sorted((topic, time) for topic, time, _ in messages)
    ticks = [time for topic, time, _ in messages if topic == '/time']
    assert len(ticks) > 10
    assert ticks == [k * SECOND // 60 for k in range(1, len(ticks) + 1)]
    poses = [time for topic, time, _ in messages if topic == '/poses']
    assert poses == ticks[: len(poses)]
    assert len(poses) >= len(ticks) - 1


@pytest.mark.parametrize('options', [[], ['--compress']])
def test_after_kill_9_a_repair_gives_everything_that_was_on_the_disk(tmp_path, bounce, options):
    folder = tmp_path / 'bag'
    process = bounce.start('bounce_record', *LONG, '-o', folder, *options)
    wait_until(lambda: size(folder) > 3e6, 'three megabytes')
    process.kill()
    process.communicate(timeout=60)
    assert not (folder / 'metadata.yaml').exists()
    on_disk = size(folder)
    assert 'repaired' in bounce.run('bounce_record', '--repair', folder)
    assert_is_a_beginning(folder)
    # At most the last chunk, of a megabyte before it is compressed, was torn.
    assert size(folder) > on_disk - 1.1e6
    whole = files_of(folder)
    error = bounce.run('bounce_record', '--repair', folder, status=1)
    assert 'there is nothing to repair' in error
    assert files_of(folder) == whole


def test_what_is_still_being_recorded_is_not_repaired(tmp_path, bounce):
    folder = tmp_path / 'bag'
    process = bounce.start('bounce_record', *LONG, '-o', folder)
    wait_until(lambda: size(folder) > 3e6, 'three megabytes')
    # Alive, but not to fill the disk meanwhile.
    process.send_signal(signal.SIGSTOP)
    error = bounce.run('bounce_record', '--repair', folder, status=1)
    assert f'{folder}: is still being recorded, nothing was touched' in error
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGCONT)
    process.communicate(timeout=60)
    assert_is_a_beginning(folder)


def test_a_bag_that_is_cut_anywhere_is_repaired_up_to_there(tmp_path):
    record('gas', '--duration', 1, '--topics', 'poses', 'bodies', '-o', tmp_path / 'gas')
    data = (tmp_path / 'gas/gas.mcap').read_bytes()
    whole = raw_with_mcap(tmp_path / 'gas')
    for cut in (0.4, 0.7, 0.9999, 1.0):
        folder = tmp_path / f'cut{cut}'
        folder.mkdir()
        (folder / 'gas.mcap').write_bytes(data[: int(cut * len(data))])
        assert main(['--repair', str(folder)]) == 0
        messages = raw_with_mcap(folder)
        assert messages == whole[: len(messages)]
        # Chunks are of one megabyte and one message.
        assert len(messages) >= len(whole) * (cut - 1.2e6 / len(data))
        assert len(read_with_rosbags(folder)) == len(messages)
    assert messages == whole


def test_a_bag_without_any_message_is_not_repaired_and_stays(tmp_path, capsys):
    (tmp_path / 'bag.mcap').write_bytes(b'\x89MCAP0\r\n')
    assert main(['--repair', str(tmp_path)]) == 1
    assert 'no message in it can be read' in capsys.readouterr().err
    assert files_of(tmp_path) == {'bag.mcap': b'\x89MCAP0\r\n'}


def write_raw(
    path, schema='', encoding='ros2msg', hash='RIHS01_' + 'ab' * 32, qos='', data=b'int32 a'
):
    """Write an MCAP of two messages of a type of somebody's own, as a recorder that was killed leaves it."""
    with path.open('wb') as file:
        writer = McapWriter(file, compression=CompressionType.NONE)
        writer.start()
        schema = writer.register_schema(schema or 'robot_msgs/msg/Own', encoding, data)
        metadata = {'offered_qos_profiles': qos} | ({'topic_type_hash': hash} if hash else {})
        for _ in range(2):  # of the same topic, as two recorders in one have them
            channel = writer.register_channel('/own', 'cdr', schema, metadata)
            writer.add_message(channel, SECOND, b'\0\1\0\0\5\0\0\0', SECOND)
        writer.finish()


def test_a_bag_with_types_of_somebodys_own_is_repaired(tmp_path):
    write_raw(tmp_path / 'bag.mcap')
    assert main(['--repair', str(tmp_path)]) == 0
    with (tmp_path / 'bag.mcap').open('rb') as file:
        (schema, channel, message), (_, other, _) = make_reader(file).iter_messages()
    assert (schema.name, schema.encoding, schema.data) == (
        'robot_msgs/msg/Own',
        'ros2msg',
        b'int32 a',
    )
    assert channel.metadata['topic_type_hash'] == 'RIHS01_' + 'ab' * 32
    assert channel.id == other.id
    assert (channel.topic, message.log_time, message.data[4]) == ('/own', SECOND, 5)


@pytest.mark.parametrize(
    ('changes', 'reason'),
    [
        ({'hash': ''}, 'must have the hash of its type'),
        ({'encoding': 'protobuf'}, 'must be defined as'),
        ({'data': b'\xff'}, ''),
        ({'qos': '- history: [', }, ''),
        ({'qos': '3', }, ''),
    ],
)  # fmt: skip
def test_a_topic_that_cannot_be_repaired_is_said_in_one_sentence(
    tmp_path, capsys, changes, reason
):
    write_raw(tmp_path / 'bag.mcap', **changes)
    before = files_of(tmp_path)
    assert main(['--repair', str(tmp_path)]) == 1
    error = capsys.readouterr().err
    assert error.startswith(f'bounce_record: {tmp_path}/bag.mcap: the topic /own: {reason}')
    assert len(error.splitlines()) == 1
    assert files_of(tmp_path) == before


def test_bytes_changed_anywhere_in_a_bag_are_repaired_or_said(tmp_path, capsys):
    options = ['--duration', 1, '--rate', 10, '--topics', 'poses', 'time', '--compress']
    record('mixed', *options, '-o', tmp_path / 'mixed')
    data = (tmp_path / 'mixed/mixed.mcap').read_bytes()
    rng = np.random.default_rng(1)
    capsys.readouterr()
    for attempt in range(25):
        broken = np.frombuffer(data, np.uint8).copy()
        broken[rng.integers(0, len(data), 3)] = rng.integers(0, 256, 3)
        folder = tmp_path / f'broken{attempt}'
        folder.mkdir()
        (folder / 'bag.mcap').write_bytes(broken)
        status = main(['--repair', str(folder)])
        out, error = capsys.readouterr()
        assert (status, len(out.splitlines()), len(error.splitlines())) in ((0, 1, 0), (1, 0, 1))


def limit_files():
    """Let no file of this process grow beyond 5 MB: as on a full disk, but for the number of the error."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (5_000_000, 5_000_000))


def test_a_disk_that_is_full_is_said_and_what_was_written_can_be_repaired(tmp_path, bounce):
    folder = tmp_path / 'bag'
    error = bounce.run('bounce_record', *LONG, '-o', folder, status=1, preexec_fn=limit_files)
    assert f'{folder}: File too large, at ' in error
    assert f'bounce_record --repair {folder}' in error
    assert len(error.splitlines()) == 1
    bounce.run('bounce_record', '--repair', folder)
    assert_is_a_beginning(folder)
    assert size(folder) > 3e6


def test_a_disk_that_gets_full_is_said_and_a_repair_waits_for_room(tmp_path, bounce):
    disk = tmp_path / 'disk'
    disk.mkdir()
    with Mounted(disk, '8m') as mounted:
        precious = disk / 'precious'
        precious.write_text('data')
        folder = disk / 'out'
        error = bounce.run('bounce_record', *LONG, '-o', folder, status=1)
        assert 'No space left on device, at ' in error
        assert len(error.splitlines()) == 1
        before = files_of(disk)
        error = bounce.run('bounce_record', '--repair', folder, status=1)
        assert 'No space left on device' in error
        assert files_of(disk) == before
        mounted.give('32m')
        bounce.run('bounce_record', '--repair', folder)
        assert_is_a_beginning(folder)
        assert precious.read_text() == 'data'


def test_on_a_disk_that_gets_full_the_tables_that_are_there_are_whole(tmp_path, bounce):
    disk = tmp_path / 'disk'
    disk.mkdir()
    with Mounted(disk, '48m'):
        arguments = ['gas', '--duration', 100000, '--format', 'parquet', '--topics', 'bodies']
        error = bounce.run('bounce_record', *arguments, '-o', disk / 'out', status=1)
        assert 'No space left on device, at ' in error
        assert 'the parts that were written are whole' in error
        assert len(error.splitlines()) == 1
        rows = parquet.read_table(disk / 'out/bodies', columns=['stamp'])
        assert len(rows) >= 1_000_000


class Mounted:
    """A file system in memory, for who may mount one."""

    def __init__(self, folder, room):
        self._folder, self._room = folder, room

    def __enter__(self):
        command = ['mount', '-t', 'tmpfs', '-o', f'size={self._room}', 'tmpfs', str(self._folder)]
        try:
            done = subprocess.run(command, capture_output=True, text=True)
        except OSError as error:
            pytest.skip(f'no mount: {error}')
        if done.returncode:
            pytest.skip(f'may not mount: {done.stderr.strip()}')
        return self

    def give(self, room):
        """Make it larger."""
        command = ['mount', '-o', f'remount,size={room}', str(self._folder)]
        subprocess.run(command, check=True)

    def __exit__(self, *_):
        subprocess.run(['umount', str(self._folder)], check=True)
