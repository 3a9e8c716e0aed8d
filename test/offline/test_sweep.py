"""bounce_sweep: all runs, once each, whoever carries them out and however often it is started."""

from __future__ import annotations

import csv
import json
import os
import signal
import socket
from contextlib import ExitStack, suppress

import pytest
from conftest import files_of, perform_here, rows_of, wait_until
from processes import Cluster, Terminal, workers_of
from pyarrow import parquet
from rosbags.rosbag2 import Reader

from circle_bounce_ros.offline.run import perform, plan_of
from circle_bounce_ros.offline.summary import finished_rows
from circle_bounce_ros.offline.sweep import main
from circle_bounce_ros.offline.sweep_file import load_plan

RESULTS = {'rows.jsonl', 'summary.parquet', 'summary.csv', 'failures.jsonl', 'plan.json'}


def results_of(folder):
    """Return everything that a sweep gives, by name."""
    files = files_of(folder)
    return {name: data for name, data in files.items() if name != '.lock'}


@pytest.mark.parametrize('record', ['bag', 'parquet'])
def test_results_do_not_depend_on_the_number_of_workers(tmp_path, bounce, write_sweep, record):
    sweep = write_sweep(record=record)
    alone = perform_here(sweep, tmp_path / 'here')
    bounce.run('bounce_sweep', sweep, '-o', tmp_path / 'two', '--workers', 2)
    assert rows_of(tmp_path / 'two') == alone
    here, two = results_of(tmp_path / 'here'), results_of(tmp_path / 'two')
    assert {name: data for name, data in two.items() if name.startswith('runs/')} == {
        name: data for name, data in here.items() if name.startswith('runs/')
    }
    assert len([name for name in two if name.endswith('row.json')]) == 6
    summary = parquet.read_table(tmp_path / 'two/summary.parquet')
    assert summary['contacts'].to_pylist() == [row['contacts'] for row in alone]
    assert summary.schema.field('mean_free_path').metadata[b'unit'] == b'm'
    with (tmp_path / 'two/summary.csv').open() as file:
        table = list(csv.DictReader(file))
    assert [float(row['pressure']) for row in table] == [row['pressure'] for row in alone]
    if record == 'bag':
        with Reader(tmp_path / 'two/runs/000000/000000003/recording') as reader:
            assert {c.topic: c.msgcount for c in reader.connections}['/poses'] == 80


def test_started_again_after_a_kill_it_does_only_what_is_missing(tmp_path, bounce, write_sweep):
    sweep = write_sweep(record='bag', seeds={'first': 0, 'count': 8}, duration=10.0)
    folder = tmp_path / 'out'
    process = bounce.start(
        'bounce_sweep', sweep, '-o', folder, '--workers', 1, start_new_session=True
    )
    log = folder / 'rows.jsonl'
    wait_until(lambda: log.exists() and log.read_text().count('\n') >= 3, 'three runs')
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate(timeout=60)
    done = {path: path.stat().st_mtime_ns for path in folder.glob('runs/*/*/row.json')}
    assert 3 <= len(done) < 24
    with log.open('a') as file:
        file.write('{"run": 23, "se')  # torn in the middle of a line
    (folder / '.unfinished/000000023-cut').mkdir(parents=True)
    out = bounce.run('bounce_sweep', sweep, '-o', folder, '--workers', 1)
    assert '24 of 24 runs done, 0 failed' in out
    assert {path: path.stat().st_mtime_ns for path in done} == done
    assert not (folder / '.unfinished').exists()
    # Whether they are recorded is no matter to the rows.
    alone = write_sweep('alone', seeds={'first': 0, 'count': 8}, duration=10.0)
    assert rows_of(folder) == perform_here(alone, tmp_path / 'here')
    # And again: nothing at all is missing.
    before = results_of(folder)
    assert main([str(sweep), '-o', str(folder)]) == 0
    assert results_of(folder) == before


def test_after_ctrl_c_on_a_terminal_it_says_what_is_missing_and_goes_on_later(
    tmp_path, bounce, write_sweep
):
    sweep = write_sweep(seeds={'first': 0, 'count': 40}, duration=10.0)
    folder = tmp_path / 'out'
    log = folder / 'rows.jsonl'
    with Terminal('bounce_sweep', sweep, '-o', folder, '--workers', 2) as terminal:
        wait_until(lambda: log.exists() and log.read_text().count('\n') >= 3, 'three runs')
        # To the workers as well, as a terminal does.
        terminal.press_ctrl_c()
        status, shown = terminal.end()
    assert status == 128 + signal.SIGINT
    assert 'Traceback' not in shown
    assert 'of 120 runs are missing: start it again' in shown
    assert '/120 [' in shown  # the bar
    done = rows_of(folder)
    assert 3 <= len(done) < 120
    assert '120 of 120 runs done' in bounce.run('bounce_sweep', sweep, '-o', folder)
    rows = rows_of(folder)
    assert [row['run'] for row in rows] == list(range(120))
    digest = load_plan(sweep).digest()
    assert all(
        perform(str(folder), digest, number) == rows[number] for number in range(0, 120, 10)
    )


def test_a_second_ctrl_c_on_a_terminal_ends_it_without_a_traceback(tmp_path, write_sweep):
    sweep = write_sweep(seeds={'first': 0, 'count': 40}, duration=10.0)
    folder = tmp_path / 'out'
    log = folder / 'rows.jsonl'
    with Terminal('bounce_sweep', sweep, '-o', folder, '--workers', 1) as terminal:
        wait_until(lambda: log.exists() and log.read_text(), 'a run')
        terminal.press_ctrl_c()
        wait_until(terminal.wants_to_end, 'the first one to be noted')
        terminal.press_ctrl_c()
        status, shown = terminal.end()
    assert status == 128 + signal.SIGINT
    assert 'Traceback' not in shown
    assert 'bounce_sweep: interrupted, what is done is kept: start it again' in shown
    assert 1 <= len(finished_rows(folder, load_plan(sweep))[0]) < 120


def has_a_run_in_its_hands(folder):
    return bool(list(folder.glob('.unfinished/*')))


def test_a_local_worker_killed_in_the_middle_is_replaced(tmp_path, bounce, write_sweep):
    sweep = write_sweep(record='bag', seeds={'first': 0, 'count': 2}, duration=20.0)
    folder = tmp_path / 'out'
    process = bounce.start('bounce_sweep', sweep, '-o', folder, '--workers', 1)
    wait_until(lambda: has_a_run_in_its_hands(folder), 'a run at work')
    (worker,) = workers_of(process)
    os.kill(worker, signal.SIGKILL)
    out, error = process.communicate(timeout=120)
    assert process.returncode == 0, error
    assert '6 of 6 runs done, 0 failed' in out
    assert rows_of(folder) == perform_here(sweep, tmp_path / 'here')


def test_a_failing_run_is_reported_with_its_seed_and_stops_no_other(tmp_path, bounce, write_sweep):
    """Nor does a sweep need the port of another one, where Dask shows its dashboard."""
    sweep = write_sweep(parameters={'groups[0].packing': [0.2, 0.99]})
    folder = tmp_path / 'out'
    with ExitStack() as held:
        with suppress(OSError):  # when somebody else has it, it is taken just as well
            held.enter_context(socket.create_server(('', 8787)))
        error = bounce.run('bounce_sweep', sweep, '-o', folder, '--workers', 1, status=1)
    for run, seed in ((2, 5), (3, 6)):
        assert f'bounce_sweep: run {run}, seed {seed}: SceneError: groups[0]' in error
    assert [row['run'] for row in rows_of(folder)] == [0, 1]
    failures = [json.loads(line) for line in (folder / 'failures.jsonl').read_text().splitlines()]
    assert [(f['run'], f['seed'], f['groups[0].packing']) for f in failures] == [
        (2, 5, 0.99),
        (3, 6, 0.99),
    ]


@pytest.fixture
def cluster(tmp_path):
    cluster = Cluster(tmp_path)
    try:
        yield cluster
    finally:
        cluster.end()


def test_a_worker_killed_in_the_middle_costs_nothing_but_time(
    tmp_path, bounce, write_sweep, cluster
):
    sweep = write_sweep(record='bag', seeds={'first': 0, 'count': 4}, duration=20.0)
    cluster.add_worker()
    cluster.add_worker()
    folder = tmp_path / 'out'
    process = bounce.start('bounce_sweep', sweep, '-o', folder, '--scheduler', cluster.address)
    # Killed with a run in its hands.
    wait_until(lambda: len(list(folder.glob('.unfinished/*'))) >= 2, 'two runs at work')
    cluster.workers[0].kill()
    out, error = process.communicate(timeout=120)
    assert process.returncode == 0, error
    assert '12 of 12 runs done, 0 failed' in out
    assert rows_of(folder) == perform_here(sweep, tmp_path / 'here')


def test_a_scheduler_that_dies_is_said_and_what_is_done_is_kept(
    tmp_path, bounce, write_sweep, cluster
):
    sweep = write_sweep(seeds={'first': 0, 'count': 100}, duration=10.0)
    cluster.add_worker()
    folder = tmp_path / 'out'
    process = bounce.start('bounce_sweep', sweep, '-o', folder, '--scheduler', cluster.address)
    log = folder / 'rows.jsonl'
    wait_until(lambda: log.exists() and log.read_text().count('\n') >= 2, 'two runs')
    cluster.scheduler.kill()
    _, error = process.communicate(timeout=120)
    assert process.returncode == 1
    assert error == (
        'bounce_sweep: the cluster has gone, what it has done is kept: start it again\n'
    )
    done = [row['run'] for row in rows_of(folder)]
    assert 2 <= len(done) < 300


def test_a_scheduler_that_is_not_there_is_said(tmp_path, capsys, write_sweep, monkeypatch):
    monkeypatch.setattr('circle_bounce_ros.offline.sweep.CONNECTING', '0.5s')
    arguments = [
        str(write_sweep()),
        '-o',
        str(tmp_path / 'out'),
        '--scheduler',
        'tcp://127.0.0.1:9',
    ]
    assert main(arguments) == 1
    assert 'scheduler: must be one that answers, got tcp://127.0.0.1:9' in capsys.readouterr().err


def test_a_folder_with_something_else_in_it_is_refused(tmp_path, capsys, write_sweep):
    folder = tmp_path / 'out'
    folder.mkdir()
    (folder / 'precious').write_text('data')
    assert main([str(write_sweep()), '-o', str(folder)]) == 1
    assert 'exists and is no sweep, nothing was touched' in capsys.readouterr().err
    assert files_of(folder) == {'precious': b'data'}


def test_a_folder_that_is_not_utf8_is_refused(tmp_path, capsys, write_sweep):
    assert main([str(write_sweep()), '-o', str(tmp_path / '\udcff')]) == 1
    assert 'output: must be UTF-8' in capsys.readouterr().err
    assert not (tmp_path / '\udcff').exists()


def test_a_folder_of_another_sweep_is_refused(tmp_path, capsys, write_sweep):
    folder = tmp_path / 'out'
    perform_here(write_sweep(), folder)
    before = files_of(folder)
    assert main([str(write_sweep('other', duration=5.0)), '-o', str(folder)]) == 1
    assert 'holds a sweep with other settings' in capsys.readouterr().err
    assert {n: d for n, d in files_of(folder).items() if n != '.lock'} == before
    with pytest.raises(ValueError, match='holds another sweep'):
        plan_of(str(folder), 'another digest')
