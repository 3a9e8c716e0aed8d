"""What a sweep leaves: a row for each run, as text while it goes on and as tables when it ends."""

from __future__ import annotations

import csv
import io
import json
from math import isfinite
from pathlib import Path
from typing import Any, TextIO

import pyarrow as pa

from circle_bounce_ros.offline.files import replace
from circle_bounce_ros.offline.observables import COLUMNS
from circle_bounce_ros.offline.parquet import write_table
from circle_bounce_ros.offline.plan import Plan

ROWS = 'rows.jsonl'
SUMMARY = 'summary.parquet'
SUMMARY_CSV = 'summary.csv'
FAILURES = 'failures.jsonl'

# No row is as long: it has the values of a file of less.
LONGEST_LINE = 100_000_000  # bytes

PARAMETER = 'parameter'  # what the metadata call a column of values that were chosen


def finished_rows(folder: Path, plan: Plan) -> tuple[dict[int, dict[str, Any]], int]:
    """Return the rows that are there, and how many lines were no rows and are left out from now on."""
    path = folder / ROWS
    if not path.exists():
        return {}, 0
    rows, damaged = {}, 0
    with path.open('rb') as log:
        for line in iter(lambda: log.readline(LONGEST_LINE), b''):
            row = read_row(line, plan) if line.endswith(b'\n') else None
            if row is None:
                damaged += 1
            else:
                rows[row['run']] = row
    if damaged:
        replace(path, ''.join(json.dumps(row) + '\n' for row in rows.values()))
    return rows, damaged


def read_row(line: bytes, plan: Plan) -> dict[str, Any] | None:
    """Return the row that a line says, None for anything that is no row of a finished run of this plan."""
    try:
        row: dict[str, Any] = json.loads(line)
        run = plan.run(row['run'])
        known = {'run': run.number, 'seed': run.seed, **run.parameters}
        is_whole = 0 <= run.number < len(plan) and row.keys() == known.keys() | COLUMNS.keys()
        is_ours = is_whole and {name: row[name] for name in known} == known
        if not is_ours or not all(row[name] is None or isfinite(row[name]) for name in COLUMNS):
            return None
        return row
    except (ValueError, TypeError, AttributeError, KeyError, OverflowError, RecursionError):
        return None


def add_line(log: TextIO, row: dict[str, Any]) -> None:
    """Add a row to the log, so that it is there whatever happens next."""
    log.write(json.dumps(row) + '\n')
    log.flush()


def write_summary(
    folder: Path, plan: Plan, rows: dict[int, dict[str, Any]], failures: dict[int, dict[str, Any]]
) -> None:
    """Write all rows in the order of the runs, which is the same whoever carried them out."""
    ordered = [rows[number] for number in sorted(rows)]
    replace(folder / ROWS, ''.join(json.dumps(row) + '\n' for row in ordered))
    failed = [failures[number] for number in sorted(failures)]
    replace(folder / FAILURES, ''.join(json.dumps(row) + '\n' for row in failed))
    units = {'run': ('1', 'number of the run'), 'seed': ('1', 'of its random numbers')}
    units |= dict.fromkeys(plan.parameters, ('as in the scene file', PARAMETER))
    units |= COLUMNS
    fields, arrays = [], []
    for name, (unit, meaning) in units.items():
        values = [row[name] for row in ordered]
        if any(isinstance(value, (list, dict)) for value in values):
            values = [json.dumps(value) for value in values]
        array = pa.array(values, pa.float64() if is_number(name, values) else None)
        arrays.append(array)
        metadata = {'unit': unit, 'meaning': meaning}
        fields.append(pa.field(name, array.type, metadata=metadata))
    schema = pa.schema(fields, metadata={'scene': plan.name, 'plan': plan.digest()})
    write_table(pa.Table.from_arrays(arrays, schema=schema), folder / SUMMARY)
    text = io.StringIO()
    writer = csv.DictWriter(text, list(units), lineterminator='\n')
    writer.writeheader()
    writer.writerows(ordered)
    replace(folder / SUMMARY_CSV, text.getvalue())


def is_number(name: str, values: list[Any]) -> bool:
    """Return whether a column is one of real numbers, even if all of them happen to be whole or missing."""
    return name in COLUMNS or any(isinstance(value, float) for value in values)


def is_parameter(field: pa.Field) -> bool:
    """Return whether a column of the summary holds what the sweep has varied, besides the seed."""
    return (field.metadata or {}).get(b'meaning') == PARAMETER.encode()
