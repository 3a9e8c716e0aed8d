"""Pictures of bags that others wrote: as `ros2 bag record` writes them, of a node that goes by the wall's clock."""

from __future__ import annotations

import shutil
import struct

import numpy as np
import pytest
from conftest import ROOT
from PIL import Image
from rosbags.rosbag2 import CompressionFormat, CompressionMode, Reader, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from circle_bounce_ros.kernel import ContactKind, Simulation
from circle_bounce_ros.offline import plot, record
from circle_bounce_ros.offline.bag_source import of_bag
from circle_bounce_ros.offline.pictures.speeds import speeds
from circle_bounce_ros.offline.source import SourceError
from circle_bounce_ros.scene_file import load_scene

SECOND = 10**9
TODAY = 1_790_000_000 * SECOND
RATE = 20  # Hz
EVERYTHING = ('clock', 'time', 'bodies', 'contacts', 'markers/static')


@pytest.fixture(scope='module')
def gas_bag(tmp_path_factory):
    """Return the folder of a bag of the scene `gas`: 3 s at 20 Hz."""
    folder = tmp_path_factory.mktemp('bags') / 'gas'
    arguments = ['gas', '--duration', '3', '--rate', str(RATE), '-o', str(folder)]
    assert record.main([*arguments, '--topics', *EVERYTHING]) == 0
    return folder


def rewrite(
    old,
    new,
    storage=StoragePlugin.SQLITE3,
    compression=CompressionMode.NONE,
    topics=EVERYTHING,
    stamp=lambda ns: ns,
    begin=0,
    namespaces=('',),
):
    """Write the messages of a bag into another one, as a recorder of the node would, without the scene."""
    types = get_typestore(Stores.ROS2_JAZZY)
    writer = Writer(new, version=9, storage_plugin=storage)
    if compression != CompressionMode.NONE:
        writer.set_compression(compression, CompressionFormat.ZSTD)
    with Reader(old) as reader, writer:
        wanted = [c for c in reader.connections if c.topic.lstrip('/') in topics]
        connections = {
            (c.topic, namespace): writer.add_connection(
                namespace + c.topic, c.msgtype, typestore=types
            )
            for c in wanted
            for namespace in namespaces
        }
        for connection, time, data in reader.messages(wanted):
            if time < begin and connection.topic != '/markers/static':
                continue
            if connection.topic in ('/time', '/bodies', '/contacts'):
                # The stamp of the header comes first in all of them.
                data = data[:4] + struct.pack('<II', *divmod(stamp(time), SECOND)) + data[12:]
            for namespace in namespaces:
                connection_to = connections[connection.topic, namespace]
                writer.write(connection_to, stamp(time) + 150_000, data)
    return new


def frames_of(folder, rate=1000.0, **options):
    return list(of_bag(folder, 1000.0, rate, **options).frames())


def assert_is_the_gas(frames, first=1):
    """Check frames by the kernel: one for each tick from `first` on."""
    simulation = Simulation(load_scene('gas'), record_contacts=True)
    assert len(frames) == 3 * RATE - first + 1
    for k, frame in enumerate(frames, start=first):
        simulation.advance_to(k / RATE)
        contacts = simulation.drain_contacts()
        # float32 in the message.
        np.testing.assert_array_equal(frame.positions, simulation.positions.astype('f4'))
        np.testing.assert_array_equal(frame.velocities, simulation.velocities.astype('f4'))
        if k > first:
            np.testing.assert_array_equal(frame.contacts['kind'], contacts['kind'])
            np.testing.assert_array_equal(frame.contacts['x'], contacts['x'].astype('f4'))


@pytest.mark.parametrize(
    ('storage', 'compression'),
    [
        (StoragePlugin.SQLITE3, CompressionMode.NONE),
        (StoragePlugin.SQLITE3, CompressionMode.FILE),
        (StoragePlugin.SQLITE3, CompressionMode.MESSAGE),
        (StoragePlugin.MCAP, CompressionMode.NONE),
        (StoragePlugin.MCAP, CompressionMode.STORAGE),
        (StoragePlugin.MCAP, CompressionMode.FILE),
    ],
)
def test_a_bag_is_read_however_it_is_stored(tmp_path, gas_bag, storage, compression):
    assert_is_the_gas(frames_of(rewrite(gas_bag, tmp_path / 'other', storage, compression)))


def slowly(ns):
    """Return the wall's clock at a scene time, with time_scale 0.5."""
    return TODAY + 2 * ns


def test_times_are_those_of_the_scene_whatever_the_clock_on_the_wall_says(tmp_path, gas_bag):
    folder = rewrite(gas_bag, tmp_path / 'wall', stamp=slowly)
    times = [frame.time for frame in frames_of(folder)]
    assert times == pytest.approx([k / RATE for k in range(3 * RATE)], abs=1e-8)  # ns


def test_without_the_topic_time_the_stamps_count(tmp_path, gas_bag):
    folder = rewrite(gas_bag, tmp_path / 'wall', topics=('bodies', 'contacts'), stamp=slowly)
    frames = frames_of(folder)
    assert [frame.time for frame in frames] == pytest.approx(
        [2 * k / RATE for k in range(3 * RATE)], abs=1e-8
    )
    assert_is_the_gas(frames)


def test_contacts_that_were_not_recorded_are_not_counted_as_none(tmp_path, capsys, gas_bag):
    folder = rewrite(gas_bag, tmp_path / 'bodies', topics=('bodies',))
    for picture in ('energy', 'trajectories'):
        path = tmp_path / f'{picture}.png'
        assert plot.main([picture, str(folder), '-o', str(path)]) == 0
        assert 'contacts' not in numbers_of_picture(path)
    assert plot.main(['free_path', str(folder), '-o', str(tmp_path / 'path.png')]) == 1
    assert 'must have contacts, got none, as their topic is not in it' in capsys.readouterr().err
    figure, _ = speeds(of_bag(folder, 9.0, 9.0))
    assert 'not for these' not in ' '.join(text.get_text() for text in figure.axes[0].texts)


def test_a_bag_may_begin_in_the_middle(tmp_path, gas_bag):
    folder = rewrite(gas_bag, tmp_path / 'later', begin=SECOND)
    frames = frames_of(folder)
    assert frames[0].time == 0.0
    assert_is_the_gas(frames, first=RATE)
    assert plot.main(['free_path', str(folder), '-o', str(tmp_path / 'a.png')]) == 0


def clock_of_a_pause(ns):
    """Return the wall's clock where the node stood still for a minute at 1 s."""
    return TODAY + ns + (60 * SECOND if ns > SECOND else 0)


def test_a_pause_takes_no_time(tmp_path, gas_bag):
    folder = rewrite(gas_bag, tmp_path / 'paused', stamp=clock_of_a_pause)
    assert frames_of(folder)[-1].time == pytest.approx(3 - 1 / RATE, abs=1e-8)


def test_where_the_scene_starts_again_time_goes_on(tmp_path, write_scene):
    scene = write_scene(
        circles=[{'position': [0, 0], 'velocity': [1, 0], 'radius': 0.1}], restart_after=0.5
    )
    folder = tmp_path / 'again'
    command = [str(scene), '--rate', '10', '--duration', '1.5', '-o', str(folder)]
    assert record.main([*command, '--topics', 'bodies', 'time']) == 0
    times = [frame.time for frame in frames_of(rewrite(folder, tmp_path / 'bare'))]
    # 0.1 ... 0.5 and 0, 0.1 ... 0.5 and 0, 0.1 ... 0.3: going back takes no time, so it is no new instant.
    assert times == pytest.approx([k / 10 for k in range(4 + 5 + 3 + 1)], abs=1e-8)


def test_of_two_nodes_in_a_bag_one_is_chosen(tmp_path, gas_bag):
    folder = rewrite(gas_bag, tmp_path / 'two', namespaces=('/a', '/b/c'))
    with pytest.raises(SourceError, match=r'namespace: must be one of /a/, /b/c/, as more than'):
        of_bag(folder, 9.0, 9.0)
    assert_is_the_gas(frames_of(folder, namespace='b/c'))
    with pytest.raises(SourceError, match='must hold the topic /d/bodies, got /a/bodies, '):
        of_bag(folder, 9.0, 9.0, 'd')


def test_fewer_instants_still_have_all_contacts(tmp_path, gas_bag):
    folder = rewrite(gas_bag, tmp_path / 'bare')
    every, some = frames_of(folder), frames_of(folder, rate=5.0)
    assert [frame.time for frame in some] == pytest.approx(
        [k / 5 for k in range(len(some))], abs=1e-8
    )
    last = some[-1].time
    held = [frame.contacts for frame in every if frame.time <= last]
    np.testing.assert_array_equal(
        np.concatenate([frame.contacts for frame in some]), np.concatenate(held)
    )


def test_another_scene_in_the_middle_is_said_with_its_time(tmp_path, gas_bag):
    other = tmp_path / 'other'
    arguments = ['mixed', '--duration', '1', '--rate', '20', '-o', str(other)]
    assert record.main([*arguments, '--topics', 'bodies']) == 0
    types = get_typestore(Stores.ROS2_JAZZY)
    both = tmp_path / 'both'
    with Writer(both, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        to = writer.add_connection('/bodies', 'sensor_msgs/msg/PointCloud2', typestore=types)
        for begin, folder in ((0, gas_bag), (3 * SECOND, other)):
            with Reader(folder) as reader:
                wanted = [c for c in reader.connections if c.topic == '/bodies']
                for _, time, data in reader.messages(wanted):
                    stamp = struct.pack('<II', *divmod(begin + time, SECOND))
                    writer.write(to, begin + time, data[:4] + stamp + data[12:])
    with pytest.raises(SourceError, match=r'another scene begins at 3 s: take a shorter'):
        frames_of(both)
    assert len(list(of_bag(both, 2.9, 1000.0).frames())) == 2.9 * RATE + 1


def write_cloud(folder, fields, step, data, is_bigendian=False):
    """Write a bag of one message on `bodies`, with fields of name, offset and datatype, and return it."""
    types = get_typestore(Stores.ROS2_JAZZY)
    kind = types.types['sensor_msgs/msg/PointCloud2']
    header = types.types['std_msgs/msg/Header'](
        stamp=types.types['builtin_interfaces/msg/Time'](sec=1, nanosec=0), frame_id='lidar'
    )
    field = types.types['sensor_msgs/msg/PointField']
    fields = [field(name, offset, datatype, count=1) for name, offset, datatype in fields]
    values = np.frombuffer(data, np.uint8)
    cloud = kind(header, 1, 1, fields, is_bigendian, step, len(data), values, True)
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        to = writer.add_connection('/bodies', kind.__msgtype__, typestore=types)
        writer.write(to, SECOND, types.serialize_cdr(cloud, kind.__msgtype__))
    return folder


@pytest.mark.parametrize(
    ('datatype', 'step', 'reason'),
    [
        (7, 4, 'must have the fields x, .*, lacks y, vx'),
        (9, 4, 'datatype: must be from 1 to 8, got 9'),
        (0, 4, 'datatype: must be from 1 to 8, got 0'),
        (8, 4, 'its fields do not describe its data: '),
        (7, 5, 'its fields do not describe its data: '),
    ],
)
def test_topics_of_these_names_that_are_something_else_are_said(tmp_path, datatype, step, reason):
    folder = write_cloud(tmp_path / 'lidar', [('x', 0, datatype)], step, bytes(4))
    with pytest.raises(SourceError, match=f'{folder}: /bodies: {reason}'):
        of_bag(folder, 9.0, 9.0)


@pytest.mark.parametrize('order', ['<', '>'])
def test_numbers_of_every_kind_are_read(tmp_path, order):
    # As sensor_msgs/PointField numbers them: INT8 1, UINT8 2, INT16 3, ... FLOAT64 8.
    names = ['radius', 'u', 'x', 'v', 'y', 'id', 'vx', 'vy']
    data = struct.pack(f'{order}bBhHiIfd', 1, 200, -3, 60000, -70000, 7, 0.5, 0.1)
    offsets = [0, 1, 2, 4, 6, 10, 14, 18]
    fields = list(zip(names, offsets, range(1, 9), strict=True))
    (frame,) = frames_of(write_cloud(tmp_path / 'kinds', fields, 26, data, order == '>'))
    assert frame.positions.tolist() == [[-3.0, -70000.0]]
    assert frame.velocities.tolist() == [[0.5, 0.1]]


def test_a_bag_of_0_1_0_is_drawn_by_its_own_description_of_its_fields(tmp_path):
    """Its contacts have other offsets and seven bytes of padding, its bodies have no mass."""
    old = ROOT / 'test/offline/data/bag_of_0_1_0'  # bounce_record lesson --duration 6 --rate 4
    for with_scene in (True, False):
        folder = tmp_path / f'copy{with_scene}'
        shutil.copytree(old, folder)
        if not with_scene:
            (folder / 'scene.yaml').unlink()
        simulation = Simulation(load_scene('lesson'), record_contacts=True)
        frames = frames_of(folder)
        assert len(frames) == 24
        for k, frame in enumerate(frames, start=1):
            simulation.advance_to(k / 4)
            contacts = simulation.drain_contacts()
            np.testing.assert_array_equal(frame.positions, simulation.positions.astype('f4'))
            np.testing.assert_array_equal(frame.contacts['kind'], contacts['kind'])
            np.testing.assert_array_equal(frame.contacts['y'], contacts['y'].astype('f4'))
        assert simulation.contact_count > 4


@pytest.mark.parametrize('storage', [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
def test_a_broken_file_is_said_in_one_sentence(tmp_path, capsys, gas_bag, storage):
    folder = rewrite(gas_bag, tmp_path / 'broken', storage)
    (path,) = [path for path in folder.iterdir() if path.name != 'metadata.yaml']
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    assert plot.main(['energy', str(folder), '-o', str(tmp_path / 'a.png')]) == 1
    error = capsys.readouterr().err
    assert f'{folder}: cannot be read: ' in error
    assert len(error.splitlines()) == 1
    assert not (tmp_path / 'a.png').exists()


def numbers_of_picture(path):
    text = Image.open(path).text['Numbers']
    parts = (part.rsplit(' = ', 1) for part in text.split('; '))
    return {name: float(value) for name, value in parts}


def test_a_bag_of_the_node_has_the_theory_of_what_it_holds(tmp_path, gas_bag):
    """Nothing in it says whether circles hit each other, but the contacts do."""
    gas = rewrite(gas_bag, tmp_path / 'bare_gas')
    assert of_bag(gas, 9.0, 9.0).collide
    assert plot.main(['free_path', str(gas), '-o', str(tmp_path / 'gas.png')]) == 0
    numbers = numbers_of_picture(tmp_path / 'gas.png')
    # Enskog; 3 s of some 600 circles are 25,000 contacts, whose rate fluctuates by 1 %: three times.
    assert numbers['mean free path'] == pytest.approx(numbers['theory path'], rel=0.03)
    billiard = tmp_path / 'billiard'
    command = ['billiard', '--duration', '60', '-o', str(billiard)]
    assert record.main([*command, '--topics', *EVERYTHING]) == 0
    bare = rewrite(billiard, tmp_path / 'bare_billiard')
    assert not of_bag(bare, 9.0, 9.0).collide
    assert plot.main(['free_path', str(bare), '-o', str(tmp_path / 'billiard.png')]) == 0
    numbers = numbers_of_picture(tmp_path / 'billiard.png')
    area = 1.9**2 - np.pi * 0.45**2
    assert numbers['theory path'] == pytest.approx(
        np.pi * area / (4 * 1.9 + 2 * np.pi * 0.45), rel=1e-5
    )
    kinds = {kind for frame in frames_of(bare) for kind in frame.contacts['kind']}
    assert kinds == {ContactKind.LOCKED, ContactKind.WALL}


def test_an_animation_of_a_bag_goes_as_fast_as_the_scene(tmp_path):
    folder = tmp_path / 'lesson'
    assert record.main(['lesson', '--duration', '2', '-o', str(folder)]) == 0
    path = tmp_path / 'a.gif'
    assert plot.main(['animation', str(folder), '-o', str(path)]) == 0
    with Image.open(path) as gif:
        shown = []
        for k in range(gif.n_frames):
            gif.seek(k)
            shown.append(gif.info['duration'])
    # From 1/60 s to 2 s at 20 frames a second, and the last one as long as the others.
    assert sum(shown) == 2000
    assert set(shown) == {50}


@pytest.mark.parametrize(
    ('options', 'reason'),
    [
        (['--seed', '3'], 'seed: goes with a scene only'),
        (['--duration', '0'], 'duration: must be > 0 s, got 0'),
        (['--duration', 'nan'], 'duration: must be > 0 s, got nan'),
        (['--rate', '-1'], 'rate: must be > 0 and at most 1e+06 Hz, got -1'),
    ],
)
def test_options_that_do_not_go_with_a_bag_are_refused(tmp_path, capsys, gas_bag, options, reason):
    assert plot.main(['energy', str(gas_bag), '-o', str(tmp_path / 'a.png'), *options]) == 1
    assert reason in capsys.readouterr().err


def test_of_a_bag_the_energy_of_all_of_it_is_shown(tmp_path):
    folder = tmp_path / 'lesson'
    assert record.main(['lesson', '--duration', '90', '--rate', '10', '-o', str(folder)]) == 0
    assert plot.main(['energy', str(folder), '-o', str(tmp_path / 'a.png')]) == 0
    assert numbers_of_picture(tmp_path / 'a.png')['duration'] == pytest.approx(89.9)


def test_tables_are_not_taken_for_a_bag_that_was_cut_short(tmp_path, capsys):
    folder = tmp_path / 'tables'
    arguments = ['lesson', '--duration', '0.1', '--format', 'parquet', '-o', str(folder)]
    assert record.main(arguments) == 0
    assert plot.main(['energy', str(folder), '-o', str(tmp_path / 'a.png')]) == 1
    assert f'{folder}: must be a bag, got Parquet tables' in capsys.readouterr().err
