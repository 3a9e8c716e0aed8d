"""
A recording as Parquet tables, for people without ROS: full precision, units in the metadata of the columns.

A table is a folder of parts, each written under another name outside of it and then moved: whatever ends the
program, there is nothing but whole parts in it, and any reader can take the folder as one table.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from pyarrow import parquet

from circle_bounce_ros.encoding.topics import Moment
from circle_bounce_ros.kernel import CONTACT_FIELDS, ContactField, Scene
from circle_bounce_ros.offline.files import begun
from circle_bounce_ros.offline.recording import SCENE_FILE, lock, scene_text
from circle_bounce_ros.schedule.times import kernel_time

# A part holds at most so many rows and so many ticks: what kill -9 may cost.
ROWS_A_PART = 1 << 20
TICKS_A_PART = 1 << 14

COMPRESSION = 'zstd'

CIRCLES_FILE = 'circles.parquet'

Column = tuple[str, pa.DataType, str, str]

STAMP: Column = ('stamp', pa.int64(), 'ns', 'simulated time since the start, never runs backwards')
TIME: Column = ('time', pa.float64(), 's', 'scene time')


def _column(field: ContactField) -> Column:
    # Ids are never negative; all other types are the kernel's.
    kind = pa.uint32() if field.type is np.int64 else pa.from_numpy_dtype(field.type)
    return field.name, kind, field.unit, field.meaning


TABLES: dict[str, list[Column]] = {
    'bodies': [
        STAMP,
        TIME,
        ('id', pa.uint32(), '1', 'index of the circle in the scene'),
        ('x', pa.float64(), 'm', 'centre'),
        ('y', pa.float64(), 'm', 'centre'),
        ('vx', pa.float64(), 'm/s', 'velocity'),
        ('vy', pa.float64(), 'm/s', 'velocity'),
    ],
    'contacts': [STAMP, *map(_column, CONTACT_FIELDS)],
}

CIRCLES: list[Column] = [
    ('id', pa.uint32(), '1', 'index of the circle in the scene'),
    ('name', pa.string(), '1', 'null for a circle without a name'),
    ('radius', pa.float64(), 'm', ''),
    ('mass', pa.float64(), 'kg', 'of no effect for a locked circle'),
    ('locked', pa.bool_(), '1', ''),
    ('x', pa.float64(), 'm', 'centre at time 0'),
    ('y', pa.float64(), 'm', 'centre at time 0'),
]


def schema_of(columns: list[Column], about: Mapping[str, str]) -> pa.Schema:
    """Return a schema whose columns say unit and meaning, and which says where all of it comes from."""
    fields = [
        pa.field(name, kind, metadata={'unit': unit, 'meaning': meaning})
        for name, kind, unit, meaning in columns
    ]
    return pa.schema(fields, metadata=dict(about))


class Table:
    """
    A folder of parts, to which rows are added.

    Parameters
    ----------
    folder : Path
        Is made; its parent exists.
    schema : pyarrow.Schema

    """

    def __init__(self, folder: Path, schema: pa.Schema) -> None:
        folder.mkdir()
        self._folder = folder
        self._schema = schema
        self._parts = 0
        self._pending: list[dict[str, NDArray[Any]]] = []
        self._rows = 0

    def add(self, columns: dict[str, NDArray[Any]]) -> None:
        """Add rows: arrays (n,) by the names of the columns, not to be written to any more."""
        self._pending.append(columns)
        self._rows += len(next(iter(columns.values())))
        if self._rows >= ROWS_A_PART or len(self._pending) >= TICKS_A_PART:
            self.flush()

    def flush(self) -> None:
        """Write the buffered rows as a part; without any, an empty first part."""
        if not self._pending and self._parts:
            return
        arrays = [
            pa.array(self._gather(field.name), field.type, from_pandas=False)
            for field in self._schema
        ]
        write_table(
            pa.Table.from_arrays(arrays, schema=self._schema),
            self._folder / f'part-{self._parts:05d}.parquet',
            # Some readers take every file in a folder, whatever its name.
            self._folder.parent,
        )
        self._parts += 1
        self._pending, self._rows = [], 0

    def _gather(self, name: str) -> NDArray[Any]:
        if not self._pending:
            return np.zeros(0)
        return np.concatenate([columns[name] for columns in self._pending])

    def forget(self) -> None:
        """Discard buffered rows."""
        self._pending, self._rows = [], 0


def write_table(table: pa.Table, path: Path, folder: Path | None = None) -> None:
    """Write a table, as `begun` does."""
    with begun(path, folder) as here:
        parquet.write_table(
            table,
            here,
            compression=COMPRESSION,
            # What repeats, and only that, is shorter as a dictionary.
            use_dictionary=[
                name for name in ('stamp', 'time', 'id') if name in table.schema.names
            ],
        )


class ParquetFolder:
    """
    A new folder with the tables `bodies`, `contacts` and `circles`.

    Parameters
    ----------
    folder : Path
        Must not exist.
    scene : Scene
    tables : collection of str, optional
        Those of `TABLES` to record; by default all.

    Raises
    ------
    OSError
        When the folder cannot be made.
    SceneError
        When the scene is too large to be written beside it.

    """

    def __init__(self, folder: Path, scene: Scene, tables: Collection[str] | None = None) -> None:
        text = scene_text(scene)
        folder.mkdir(parents=True)
        self._lock = lock(folder)
        (folder / SCENE_FILE).write_text(text)
        about = {'scene': scene.name, 'seed': 'none' if scene.seed is None else str(scene.seed)}
        write_table(_circles(scene, about), folder / CIRCLES_FILE)
        moving = [i for i, circle in enumerate(scene.circles) if not circle.locked]
        self._ids = np.array(moving, np.uint32)
        self._tables = {
            name: Table(folder / name, schema_of(columns, about))
            for name, columns in TABLES.items()
            if tables is None or name in tables
        }
        self.wants_contacts = 'contacts' in self._tables

    def write(self, moment: Moment) -> None:
        """Add a tick to the tables."""
        state = moment.state
        if 'bodies' in self._tables:
            x, y = state.positions.T
            vx, vy = state.velocities.T
            time = np.full(self._ids.size, kernel_time(moment.scene_ns))
            self._tables['bodies'].add(
                self._stamped(moment, time) | {'id': self._ids, 'x': x, 'y': y, 'vx': vx, 'vy': vy}
            )
        if self.wants_contacts:
            contacts = state.contacts
            self._tables['contacts'].add(
                self._stamped(moment, contacts['time'])
                | {name: contacts[name] for name in contacts.dtype.names or () if name != 'time'}
            )

    @staticmethod
    def _stamped(moment: Moment, time: NDArray[np.float64]) -> dict[str, NDArray[Any]]:
        return {'stamp': np.full(len(time), moment.stamp_ns), 'time': time}

    def close(self) -> None:
        """Write buffered rows."""
        for table in self._tables.values():
            table.flush()
        os.close(self._lock)

    def abort(self) -> None:
        """Discard buffered rows; the parts that are written stay."""
        for table in self._tables.values():
            table.forget()
        os.close(self._lock)


def _circles(scene: Scene, about: Mapping[str, str]) -> pa.Table:
    circles = scene.circles
    columns: dict[str, list[Any]] = {
        'id': list(range(len(circles))),
        'name': [circle.name for circle in circles],
        'radius': [circle.radius for circle in circles],
        'mass': [circle.mass for circle in circles],
        'locked': [circle.locked for circle in circles],
        'x': [circle.position[0] for circle in circles],
        'y': [circle.position[1] for circle in circles],
    }
    return pa.Table.from_pydict(columns, schema=schema_of(CIRCLES, about))
