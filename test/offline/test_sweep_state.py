"""What a sweep goes on from when it is started again: none of it is trusted."""

from __future__ import annotations

import argparse
import json
from contextlib import nullcontext

import pytest
from conftest import files_of, perform_here, rows_of

from circle_bounce_ros.offline import sweep as command
from circle_bounce_ros.offline.run import perform
from circle_bounce_ros.offline.summary import finished_rows
from circle_bounce_ros.offline.sweep_file import load_plan


@pytest.fixture
def done(tmp_path, write_sweep):
    """Return the plan, the folder and the rows of a sweep of six runs that are done."""
    path = write_sweep(duration=2.0)
    folder = tmp_path / 'out'
    rows = perform_here(path, folder)
    (folder / 'rows.jsonl').write_text(''.join(json.dumps(row) + '\n' for row in rows))
    return load_plan(path), folder, rows


def changed(line, **values):
    return json.dumps(json.loads(line) | values).encode() + b'\n'


DAMAGES = {
    'text': lambda line: b'no row\n',
    'binary': lambda line: bytes(range(128, 256)) + b'\n',
    'nothing': lambda line: b'\n',
    'null': lambda line: b'null\n',
    'a list': lambda line: b'[1, 2]\n',
    'half a row': lambda line: line[: len(line) // 2] + b'\n',
    'two rows in one': lambda line: line[:-1] + line,
    'brackets': lambda line: b'[' * 1_000_000 + b'\n',
    'many digits': lambda line: b'{"run": ' + b'1' * 100_000 + b'}\n',
    'a missing key': lambda line: line.replace(b'"pressure"', b'"presure"'),
    'no number': lambda line: changed(line, pressure='high'),
    'not finite': lambda line: changed(line, pressure=float('nan')),
    'another seed': lambda line: changed(line, seed=77),
    'no such run': lambda line: changed(line, run=10**30),
    'a run before the first': lambda line: changed(line, run=-1),
    'half a run': lambda line: changed(line, run=2.5),
    'a failure': lambda line: changed(line, error='something'),
}


def test_a_damaged_line_costs_its_own_run_only(done):
    plan, folder, rows = done
    log = folder / 'rows.jsonl'
    whole = log.read_bytes().splitlines(keepends=True)
    for name, damage in DAMAGES.items():
        for place in (0, 3, 5):
            lines = [*whole[:place], damage(whole[place]), *whole[place + 1 :]]
            log.write_bytes(b''.join(lines))
            left = {row['run']: row for k, row in enumerate(rows) if k != place}
            assert finished_rows(folder, plan) == (left, 1), name
            # It is out of the way.
            assert finished_rows(folder, plan) == (left, 0), name


def test_a_damaged_line_is_said_once_and_its_run_is_done_again(done, capsys, monkeypatch):
    plan, folder, rows = done
    log = folder / 'rows.jsonl'
    lines = log.read_bytes().splitlines(keepends=True)
    log.write_bytes(b''.join([*lines[:2], b'torn\n', *lines[3:5], lines[5][:30]]))
    again = []

    def carry_out(client, plan, folder, missing, *_):
        again.extend(missing)
        return (perform(str(folder), plan.digest(), number) for number in again)

    # In this process, without Dask.
    monkeypatch.setattr(command, 'connect', lambda *_: nullcontext())
    monkeypatch.setattr(command, 'carry_out', carry_out)
    for said in (1, 0):
        chosen = argparse.Namespace(output=folder)
        assert command.sweep(plan, chosen, lambda: False) == 0
        assert capsys.readouterr().err.count('rows.jsonl: 2 damaged lines') == said
    assert again == [2, 5]
    assert rows_of(folder) == rows


def test_a_row_beside_a_recording_that_is_none_is_done_again_with_it(tmp_path, write_sweep):
    path = write_sweep(record='bag', duration=2.0, seeds=[5])
    rows = perform_here(path, tmp_path / 'here')
    before = files_of(tmp_path / 'here')
    of_another_run = json.dumps(rows[0]).encode()
    for text in (b'', b'[]', b'{"run": 3}', b'null\n', b'\xff\xfe', of_another_run):
        (tmp_path / 'here/runs/000000/000000001/row.json').write_bytes(text)
        assert perform(str(tmp_path / 'here'), load_plan(path).digest(), 1) == rows[1]
        assert files_of(tmp_path / 'here') == before


@pytest.mark.parametrize('text', [b'', b'{}', b'[]', b'\xff\xfe', b'[' * 100_000])
def test_a_damaged_plan_is_said_and_nothing_is_touched(tmp_path, capsys, write_sweep, text):
    path = write_sweep()
    folder = tmp_path / 'out'
    folder.mkdir()
    (folder / 'plan.json').write_bytes(text)
    assert command.main([str(path), '-o', str(folder)]) == 1
    error = capsys.readouterr().err
    assert error.startswith(
        f'bounce_sweep: {folder}/plan.json: cannot be read, nothing was touched'
    )
    assert len(error.splitlines()) == 1
    assert (folder / 'plan.json').read_bytes() == text
