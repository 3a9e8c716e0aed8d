"""What is in the tables of bounce_record."""

from __future__ import annotations

import numpy as np
import pyarrow.dataset
from conftest import wait_until
from pyarrow import parquet
from reading import SECOND, record

from circle_bounce_ros.kernel import Simulation
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
