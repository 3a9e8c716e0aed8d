"""bounce_record: what is in a recording, by readers that are not ours."""

from __future__ import annotations

import io
import math
import resource
import signal
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pyarrow.dataset
import pytest
from conftest import files_of, wait_until
from mcap.reader import make_reader
from pyarrow import parquet
from rosbags.interfaces import QosDurability, QosReliability
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

from circle_bounce_ros.kernel import Simulation
from circle_bounce_ros.offline.record import main
from circle_bounce_ros.offline.ticks import Ticks
from circle_bounce_ros.scene_file import load_scene

SECOND = 10**9

DTYPES = {2: 'u1', 6: '<u4', 7: '<f4', 8: '<f8'}


def read_with_rosbags(folder):
    """Return (topic, time, message) of all messages."""
    types = get_typestore(Stores.ROS2_JAZZY)
    with Reader(folder) as reader:
        return [
            (connection.topic, time, types.deserialize_cdr(data, connection.msgtype))
            for connection, time, data in reader.messages()
        ]


def read_with_mcap(folder):
    """Return the same, read by the library of the format with the definitions that are in the file."""
    decoder_of = pytest.importorskip('mcap_ros2.decoder').DecoderFactory
    (path,) = folder.glob('*.mcap')
    with path.open('rb') as file:
        reader = make_reader(file, decoder_factories=[decoder_of()])
        return [
            (channel.topic, message.log_time, decoded)
            for _, channel, message, decoded in reader.iter_decoded_messages()
        ]


def raw_with_mcap(folder):
    """Return (topic, time, bytes) of all messages in their order in the file."""
    (path,) = folder.glob('*.mcap')
    with path.open('rb') as file:
        reader = make_reader(file)
        return [
            (channel.topic, message.log_time, message.data)
            for _, channel, message in reader.iter_messages()
        ]


READERS = [read_with_rosbags, read_with_mcap]


def stamp_of(message):
    stamp = message.header.stamp
    return stamp.sec * SECOND + (stamp.nanosec if hasattr(stamp, 'nanosec') else stamp.nsec)


def points_of(cloud):
    point = np.dtype(
        {
            'names': [field.name for field in cloud.fields],
            'formats': [DTYPES[field.datatype] for field in cloud.fields],
            'offsets': [field.offset for field in cloud.fields],
            'itemsize': cloud.point_step,
        }
    )
    return np.frombuffer(bytes(cloud.data), point)


def record(*arguments):
    assert main([str(argument) for argument in arguments]) == 0


@pytest.fixture(scope='module')
def mixed(tmp_path_factory):
    """Return the folder of a bag of the scene `mixed`: 2 s at 50 Hz."""
    folder = tmp_path_factory.mktemp('bags') / 'mixed'
    record('mixed', '--duration', 2, '--rate', 50, '--seed', 3, '-o', folder)
    return folder


@pytest.mark.parametrize('read', READERS)
def test_foreign_readers_find_the_states_of_the_kernel(mixed, read):
    simulation = Simulation(load_scene('mixed', 3), record_contacts=True)
    messages = read(mixed)
    poses = [m for topic, _, m in messages if topic == '/poses']
    bodies = [m for topic, _, m in messages if topic == '/bodies']
    contacts = [m for topic, _, m in messages if topic == '/contacts']
    assert len(poses) == len(bodies) == len(contacts) == 100
    for k, (pose, body, contact) in enumerate(zip(poses, bodies, contacts, strict=True), start=1):
        assert stamp_of(pose) == stamp_of(body) == k * SECOND // 50
        simulation.advance_to(stamp_of(pose) * 1e-9)
        spots = [(p.position.x, p.position.y) for p in pose.poses]
        np.testing.assert_array_equal(spots, simulation.positions)  # to the last bit
        points = points_of(body)
        np.testing.assert_array_equal(points['vx'], simulation.velocities[:, 0].astype('f4'))
        np.testing.assert_array_equal(points['id'], simulation.ids)
        np.testing.assert_array_equal(points['radius'], simulation.radii.astype('f4'))
        log, seen = simulation.drain_contacts(), points_of(contact)
        np.testing.assert_array_equal(seen['time'], log['time'])
        np.testing.assert_array_equal(seen['b'], log['b'])
        np.testing.assert_array_equal(seen['impulse'], log['impulse'].astype('f4'))


def test_both_readers_agree_on_every_message(mixed):
    ours = [(topic, time) for topic, time, _ in read_with_rosbags(mixed)]
    theirs = [(topic, time) for topic, time, _ in read_with_mcap(mixed)]
    assert sorted(ours) == sorted(theirs)
    assert {topic for topic, _ in ours} == {
        '/clock', '/time', '/poses', '/bodies', '/contacts', '/markers', '/markers/static'
    }  # fmt: skip


def test_named_circles_have_poses_and_twists_and_locked_ones_are_said_once(tmp_path):
    record('lesson', '--duration', 1, '-o', tmp_path / 'bag')
    simulation = Simulation(load_scene('lesson'))
    messages = read_with_rosbags(tmp_path / 'bag')
    poses = [m for topic, _, m in messages if topic == '/green/pose']
    twists = [m for topic, _, m in messages if topic == '/green/twist']
    assert len(poses) == len(twists) == 60
    for pose, twist in zip(poses, twists, strict=True):
        simulation.advance_to(stamp_of(pose) * 1e-9)
        position, linear = pose.pose.position, twist.twist.linear
        assert (position.x, position.y) == tuple(simulation.positions[0])
        assert (linear.x, linear.y) == tuple(simulation.velocities[0])
    (red,) = [m for topic, _, m in messages if topic == '/red/pose']
    assert (red.pose.position.x, red.pose.position.y) == (0.3, 0.15)


def test_latched_topics_are_latched_in_the_bag_too(tmp_path):
    record('lesson', '--duration', 1, '-o', tmp_path / 'bag')
    with Reader(tmp_path / 'bag') as reader:
        offered = {c.topic: c.ext.offered_qos_profiles[0] for c in reader.connections}
    latched = {t for t, q in offered.items() if q.durability == QosDurability.TRANSIENT_LOCAL}
    assert latched == {'/markers/static', '/red/pose'}
    assert {q.reliability for q in offered.values()} == {QosReliability.RELIABLE}
    assert {t: q.depth for t, q in offered.items()} == {
        t: 1 if t in latched else 10 for t in offered
    }


def test_scene_time_starts_again_where_the_scene_says_so_while_stamps_go_on(tmp_path, write_scene):
    path = write_scene(
        circles=[{'position': [0, 0], 'velocity': [1, 0], 'radius': 0.1, 'name': 'ball'}],
        restart_after=0.45,
    )
    record(path, '--duration', 2, '--rate', 10, '-o', tmp_path / 'bag')
    messages = read_with_rosbags(tmp_path / 'bag')
    times = [m.time_ref for topic, _, m in messages if topic == '/time']
    scene = [t.sec * SECOND + t.nanosec for t in times]
    # 0.5 s would be beyond the end, which is shown; then it starts again.
    period = [100_000_000 * k for k in (1, 2, 3, 4)] + [450_000_000, 0]
    assert scene == (period * 4)[:20]
    xs = [m.pose.position.x for topic, _, m in messages if topic == '/ball/pose']
    assert xs == pytest.approx([t * 1e-9 for t in scene], abs=1e-12)  # 1 m/s, a few roundings
    assert [time for topic, time, _ in messages if topic == '/time'] == [
        k * SECOND // 10 for k in range(1, 21)
    ]


@pytest.mark.parametrize('rate', [0.1, 60.0, 999.0, 1e3 / 3])
@pytest.mark.parametrize('restart', [math.inf, 1.0, 0.37])
def test_ticks_are_whole_periods_rounded_down_and_scene_time_never_leaves_the_scene(rate, restart):
    ticks = list(Ticks(rate, 30.0, restart))
    exact = Fraction(repr(rate))
    assert [t.stamp_ns for t in ticks] == [
        math.floor(k * SECOND / exact) for k in range(1, math.floor(30 * exact) + 1)
    ]
    if restart == math.inf:
        assert [t.scene_ns for t in ticks] == [t.stamp_ns for t in ticks]
    else:
        assert max(t.scene_ns for t in ticks) == restart * SECOND
        after = [b.scene_ns for a, b in zip(ticks, ticks[1:]) if a.scene_ns == restart * SECOND]  # noqa: B905, RUF007
        assert set(after) <= {0}


@pytest.mark.parametrize('options', [[], ['--compress'], ['--format', 'parquet']])
def test_the_same_command_gives_the_same_bytes(tmp_path, bounce, options):
    for place in ('a', 'b'):
        (tmp_path / place).mkdir()
        folder = tmp_path / place / 'out'
        bounce.run('bounce_record', 'mixed', '--duration', 2, '-o', folder, *options)
    assert files_of(tmp_path / 'a') == files_of(tmp_path / 'b')


def test_a_compressed_bag_is_smaller_and_says_the_same(tmp_path, mixed):
    folder = tmp_path / 'mixed'
    record('mixed', '--duration', 2, '--rate', 50, '--seed', 3, '-o', folder, '--compress')
    assert raw_with_mcap(folder) == raw_with_mcap(mixed)
    size = (folder / 'mixed.mcap').stat().st_size
    assert size < 0.7 * (mixed / 'mixed.mcap').stat().st_size  # double digits hardly compress


def test_only_the_topics_that_were_asked_for_are_recorded(tmp_path):
    record('lesson', '--duration', 1, '--topics', 'poses', '/green/pose', '-o', tmp_path / 'bag')
    assert {t for t, _, _ in read_with_rosbags(tmp_path / 'bag')} == {'/poses', '/green/pose'}


def test_the_scene_beside_a_recording_is_the_scene_that_was_recorded(mixed):
    again, scene = load_scene(mixed / 'scene.yaml'), load_scene('mixed', 3)
    assert (again.circles, again.walls) == (scene.circles, scene.walls)  # to the last bit


def test_parquet_holds_the_states_of_the_kernel_with_units(tmp_path):
    folder = tmp_path / 'tables'
    record('mixed', '--duration', 1, '--rate', 50, '--format', 'parquet', '-o', folder)
    simulation = Simulation(load_scene('mixed'), record_contacts=True)
    bodies = pyarrow.dataset.dataset(folder / 'bodies').to_table()
    columns = {name: bodies[name].to_numpy().reshape(50, -1) for name in bodies.column_names}
    logs = []
    for k in range(50):
        simulation.advance_to(columns['stamp'][k, 0] * 1e-9)
        np.testing.assert_array_equal(columns['x'][k], simulation.positions[:, 0])
        np.testing.assert_array_equal(columns['vy'][k], simulation.velocities[:, 1])
        np.testing.assert_array_equal(columns['id'][k], simulation.ids)
        logs.append(simulation.drain_contacts())
    contacts = parquet.read_table(folder / 'contacts')
    log = np.concatenate(logs)
    for name in log.dtype.names:
        np.testing.assert_array_equal(contacts[name].to_numpy(), log[name])
    units = {field.name: field.metadata[b'unit'].decode() for field in bodies.schema}
    assert units == {
        'stamp': 'ns', 'time': 's', 'id': '1', 'x': 'm', 'y': 'm', 'vx': 'm/s', 'vy': 'm/s'
    }  # fmt: skip
    circles = parquet.read_table(folder / 'circles.parquet').to_pydict()
    scene = load_scene('mixed')
    assert circles['mass'] == [circle.mass for circle in scene.circles]
    assert bodies.schema.metadata[b'scene'] == b'mixed'


@pytest.mark.parametrize('form', ['bag', 'parquet'])
def test_an_existing_target_is_refused_and_nothing_is_touched(tmp_path, capsys, form):
    folder = tmp_path / 'bag'
    folder.mkdir()
    (folder / 'precious').write_text('data')
    assert main(['lesson', '-o', str(folder), '--format', form]) == 1
    assert f'{folder}: exists already, nothing was touched' in capsys.readouterr().err
    assert files_of(tmp_path) == {'bag/precious': b'data'}


@pytest.mark.parametrize(
    ('arguments', 'reason'),
    [
        (['gaz'], 'scene: must be one of'),
        (['lesson', '--topics', 'poses', 'moon'], 'got moon'),
        (['lesson', '--rate', '0'], 'rate: must be > 0'),
        (['lesson', '--duration', '0.001'], 'duration: must be at least one period'),
        (['lesson', '--duration', 'nan'], 'duration: must be > 0'),
        (['lesson', '--frame-id', ''], 'frame-id: must not be empty'),
        (['lesson', '--format', 'parquet', '--topics', 'poses'], 'must be from bodies, contacts'),
        (['gas', '--seed', '-1'], 'seed: must be'),
    ],
)
def test_what_is_wrong_is_said_and_leaves_nothing(tmp_path, capsys, arguments, reason):
    assert main([*arguments, '-o', str(tmp_path / 'bag')]) == 1
    assert reason in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


LONG = ['gas', '--duration', 100000, '--topics', 'poses', 'time']


def size(folder):
    return sum(path.stat().st_size for path in folder.glob('*.mcap'))


def test_after_ctrl_c_the_bag_is_whole_up_to_where_it_came(tmp_path, bounce):
    folder = tmp_path / 'bag'
    process = bounce.start('bounce_record', *LONG, '-o', folder)
    wait_until(lambda: size(folder) > 3e6, 'three megabytes')
    process.send_signal(signal.SIGINT)
    out, error = process.communicate(timeout=60)
    assert process.returncode == 128 + signal.SIGINT
    assert 'stopped after' in out
    assert error == ''
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


@pytest.mark.parametrize('form', ['bag', 'parquet'])
def test_a_tiny_disk_gets_full_with_one_sentence(tmp_path, bounce, form):
    disk = tmp_path / 'disk'
    disk.mkdir()
    with Mounted(disk, '8m'):
        precious = disk / 'precious'
        precious.write_text('data')
        arguments = ['gas', '--duration', 100000, '--format', form, '-o', disk / 'out']
        error = bounce.run('bounce_record', *arguments, status=1)
        assert 'No space left on device, at ' in error
        assert len(error.splitlines()) == 1
        assert precious.read_text() == 'data'


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

    def __exit__(self, *_):
        subprocess.run(['umount', str(self._folder)], check=True)


def test_after_kill_9_parquet_parts_are_whole(tmp_path, bounce):
    folder = tmp_path / 'tables'
    process = bounce.start(
        'bounce_record', 'gas', '--duration', 100000, '--format', 'parquet', '-o', folder
    )
    wait_until(lambda: (folder / 'bodies/part-00001.parquet').exists(), 'two parts')
    process.kill()
    process.communicate(timeout=60)
    bodies = parquet.read_table(folder / 'bodies', columns=['stamp', 'id'])
    stamps = np.unique(bodies['stamp'].to_numpy())
    assert len(stamps) * 1000 == len(bodies)
    assert stamps.tolist() == [k * SECOND // 60 for k in range(1, len(stamps) + 1)]


def test_a_recording_takes_the_same_memory_however_long_it_is(tmp_path, bounce):
    script = (
        'import resource, sys\n'
        'from circle_bounce_ros.offline.record import main\n'
        'assert main(sys.argv[1:]) == 0\n'
        'print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)\n'
    )
    peaks = []
    for seconds in (2, 20):
        arguments = ['gas', '--duration', str(seconds), '--topics', 'poses', 'bodies', '-o']
        done = subprocess.run(
            [sys.executable, '-c', script, *arguments, str(tmp_path / f'bag{seconds}')],
            capture_output=True,
            text=True,
            check=True,
        )
        peaks.append(int(done.stdout.split()[-1]))
    # 91 MB more on the disk; 10 MB is what an allocator may keep.
    assert peaks[1] < peaks[0] + 10_000


def test_the_bar_on_a_terminal_tells_the_time_left(monkeypatch, tmp_path):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    terminal = Terminal()
    monkeypatch.setattr('sys.stderr', terminal)
    record('gas', '--duration', 5, '--topics', 'poses', '-o', tmp_path / 'bag')
    assert 'left' in terminal.getvalue()
    assert '100%' in terminal.getvalue()
