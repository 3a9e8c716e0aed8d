"""What is in the tables of bounce_record."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pyarrow.dataset
from conftest import ROOT, wait_until
from pyarrow import parquet
from reading import SECOND, record

from circle_bounce_ros.kernel import Simulation
from circle_bounce_ros.offline.parquet import ParquetFolder
from circle_bounce_ros.offline.record import main
from circle_bounce_ros.scene_file import load_scene


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


# Dies in the middle of writing its second part, as by kill -9: nothing is cleaned up.
DIES = """
import os, sys
from circle_bounce_ros.offline import parquet, record
whole = parquet.parquet.write_table
def write_table(table, path, **options):
    if 'part-00001' in path.name:
        path.write_bytes(b'PAR1')
        os._exit(9)
    whole(table, path, **options)
parquet.parquet.write_table = write_table
parquet.TICKS_A_PART = 10
record.main(sys.argv[1:])
"""


def test_a_part_that_was_being_written_at_kill_9_is_no_data_to_any_reader(tmp_path, capsys):
    folder = tmp_path / 'tables'
    command = [sys.executable, '-c', DIES, 'mixed', '--format', 'parquet', '-o', str(folder)]
    assert subprocess.run(command, cwd=ROOT, capture_output=True).returncode == 9
    # Readers take a folder, what ends so in it, or all that ends so below: with hidden files, as some do.
    assert [path.name for path in (folder / 'bodies').iterdir()] == ['part-00000.parquet']
    for path in folder.rglob('*.parquet'):
        assert parquet.read_table(path).num_rows > 0
    left = set(folder.iterdir())
    assert main(['--repair', str(folder)]) == 0
    assert capsys.readouterr().out == f'{folder}: its tables are whole\n'
    (torn,) = left - set(folder.iterdir())
    assert torn.name.startswith('.')


def test_tables_that_are_still_being_recorded_are_not_cleaned(tmp_path, capsys):
    sink = ParquetFolder(tmp_path / 'tables', load_scene('lesson'))
    assert main(['--repair', str(tmp_path / 'tables')]) == 1
    assert 'is still being recorded, nothing was touched' in capsys.readouterr().err
    sink.close()
    assert main(['--repair', str(tmp_path / 'tables')]) == 0


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
