"""bounce_sweep: many runs of one template, on Dask."""

from __future__ import annotations

import argparse
import asyncio
import fcntl
import logging
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import Any

import dask
from distributed import CancelledError, Client, KilledWorker, LocalCluster, wait
from tqdm import tqdm

from circle_bounce_ros.offline.files import ENDING, is_utf8, replace
from circle_bounce_ros.offline.plan import Plan, PlanError, restore
from circle_bounce_ros.offline.run import PLAN, perform, remove_unfinished
from circle_bounce_ros.offline.stopping import INTERRUPTED, Stopping, without_interrupts
from circle_bounce_ros.offline.summary import ROWS, add_line, finished_rows, write_summary
from circle_bounce_ros.offline.sweep_file import load_plan
from circle_bounce_ros.scene_file.wording import shown

COMMAND = 'bounce_sweep'
LAST_WORDS = f'{COMMAND}: interrupted, what is done is kept: start it again'
LOCK = '.lock'

# Runs that wait at the scheduler for each thread of a worker: it never holds the whole sweep.
AHEAD = 4
# A run is given up after so many workers have died of it.
DEATHS = 10
GONE = 'the cluster has gone, what it has done is kept: start it again'
# How often to look whether to stop.
PATIENCE = 0.5  # s
# How long a scheduler may take to answer.
CONNECTING = '10s'


class SweepError(ValueError):
    """Why a sweep cannot go on, in one sentence."""


def arguments_of(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Return the parsed command line."""
    parser = argparse.ArgumentParser(
        prog=COMMAND,
        description='Carry out all runs of a sweep; called again, those that are missing.',
    )
    parser.add_argument('sweep', type=Path, metavar='SWEEP.yaml')
    parser.add_argument('-o', '--output', type=Path, required=True, metavar='FOLDER')
    where = parser.add_mutually_exclusive_group()
    where.add_argument('--workers', type=int, help='processes on this machine; default: its cores')
    where.add_argument(
        '--scheduler', metavar='tcp://HOST:PORT', help='of a Dask cluster that sees the folder too'
    )
    chosen = parser.parse_args(arguments)
    if chosen.workers is not None and chosen.workers < 1:
        parser.error(f'--workers: must be at least 1, got {chosen.workers}')
    return chosen


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Sweep.

    Returns
    -------
    int
        0; 1 when something is wrong or runs failed; 130 after Ctrl-C, to be called again.

    """
    chosen = arguments_of(arguments)
    try:
        plan = load_plan(chosen.sweep)
        with locked(chosen.output, plan), Stopping(LAST_WORDS) as stop:
            failed = sweep(plan, chosen, stop)
        return stop.exit_status or int(failed > 0)
    except (SweepError, PlanError) as error:
        print(f'{COMMAND}: {error}', file=sys.stderr)
        return 1
    except OSError as error:
        print(f'{COMMAND}: {error.filename or ""}: {error.strerror or error}', file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print(LAST_WORDS, file=sys.stderr)
        return INTERRUPTED


@contextmanager
def locked(folder: Path, plan: Plan) -> Iterator[None]:
    """
    Make the folder of a sweep this command's own for a while.

    Raises
    ------
    SweepError
        When something else is in it, or another one is at work there.

    """
    if not is_utf8(folder):
        raise SweepError(f'output: must be UTF-8, got {shown(str(folder))}')
    plan_file = folder / PLAN
    if folder.exists() and not plan_file.exists():
        ours = (LOCK, f'.{PLAN}{ENDING}')
        others = [path for path in folder.iterdir() if path.name not in ours]
        if others:
            raise SweepError(f'{folder}: exists and is no sweep, nothing was touched')
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / LOCK).open('a') as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise SweepError(f'{folder}: another {COMMAND} is at work there') from None
        if not plan_file.exists():
            replace(plan_file, plan.dump())
        elif plan_in(plan_file) != plan:
            raise SweepError(
                f'{folder}: holds a sweep with other settings, nothing was touched: '
                'take another folder'
            )
        yield


def plan_in(path: Path) -> Plan:
    """
    Return the plan of a sweep that has been started.

    Raises
    ------
    SweepError
        For a damaged one: nothing says any more to which sweep the runs belong.

    """
    try:
        return restore(path.read_text())
    except ValueError as error:
        raise SweepError(
            f'{path}: cannot be read, nothing was touched: take another folder: {error}'
        ) from None


def sweep(plan: Plan, chosen: argparse.Namespace, stop: Stopping) -> int:
    """Do what is missing, write the summary, and return how many runs failed."""
    folder: Path = chosen.output.resolve()
    remove_unfinished(folder)
    rows, damaged = finished_rows(folder, plan)
    if damaged:
        print(
            f'{chosen.output / ROWS}: {damaged} damaged line{"s" * (damaged > 1)} left out, '
            'what is missing is done again',
            file=sys.stderr,
        )
    missing = (number for number in range(len(plan)) if number not in rows)
    left = len(plan) - len(rows)
    failures: dict[int, dict[str, Any]] = {}
    if left:
        if rows:
            print(f'{chosen.output}: {len(rows)} of {len(plan)} runs are there', file=sys.stderr)
        with connect(chosen, left) as client, (folder / ROWS).open('a') as log:
            for row in carry_out(client, plan, folder, missing, (len(plan), left), stop):
                (failures if 'error' in row else rows)[row['run']] = row
                if 'error' not in row:
                    add_line(log, row)
        if not stop():
            # After a stop a cluster of somebody else's may still be at work.
            remove_unfinished(folder)
    write_summary(folder, plan, rows, failures)
    for number in sorted(failures):
        row = failures[number]
        print(f'{COMMAND}: run {number}, seed {row.get("seed")}: {row["error"]}', file=sys.stderr)
    unfinished = len(plan) - len(rows) - len(failures)
    if unfinished:
        print(
            f'{chosen.output}: {unfinished} of {len(plan)} runs are missing: start it again',
            file=sys.stderr,
        )
    print(f'{chosen.output}: {len(rows)} of {len(plan)} runs done, {len(failures)} failed')
    return len(failures)


@contextmanager
def connect(chosen: argparse.Namespace, runs: int) -> Iterator[Any]:
    """Return a client of the cluster that the command line says."""
    settings = {
        'distributed.scheduler.allowed-failures': DEATHS,
        # Data never travels here, only numbers of runs: nothing to measure or to spill.
        'distributed.worker.memory.spill': False,
        'distributed.worker.memory.target': False,
        'distributed.admin.tick.limit': '60s',
    }
    with dask.config.set(settings):
        if chosen.scheduler:
            # What happens there is said in one sentence here.
            logging.getLogger('distributed.client').setLevel(logging.CRITICAL)
            try:
                client = Client(chosen.scheduler, timeout=CONNECTING)
            except (OSError, ValueError) as error:
                raise SweepError(
                    f'scheduler: must be one that answers, got {chosen.scheduler}: {error}'
                ) from None
            with client:
                yield client
            return
        workers = min(chosen.workers or len(os.sched_getaffinity(0)), runs)
        with without_interrupts():
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                dashboard_address=None,
                # Without a dashboard it still serves HTTP, else on port 8787, which a second sweep finds taken.
                scheduler_kwargs={'dashboard_address': '127.0.0.1:0'},
                host='127.0.0.1',
                silence_logs=logging.CRITICAL,
            )
        with cluster, Client(cluster) as client:
            yield client


def carry_out(
    client: Any,
    plan: Plan,
    folder: Path,
    missing: Iterator[int],
    total_and_left: tuple[int, int],
    stop: Stopping,
) -> Iterator[dict[str, Any]]:
    """Return the rows of runs as they come in, in any order."""
    total, left = total_and_left
    digest = plan.digest()

    def submit(number: int) -> Any:
        return client.submit(
            perform, str(folder), digest, number, pure=False, key=f'run-{digest[:8]}-{number}'
        )

    threads = max(1, sum(client.nthreads().values()))
    waiting = {submit(number) for number in islice(missing, AHEAD * threads)}
    with tqdm(total=total, initial=total - left, unit='run', disable=None, file=sys.stderr) as bar:
        while waiting:
            try:
                done = wait(waiting, PATIENCE, 'FIRST_COMPLETED').done
            except asyncio.TimeoutError:  # another one than TimeoutError before Python 3.11
                done = set()
            except CancelledError:
                raise SweepError(GONE) from None
            for future in done:
                yield row_of(plan, future)
                bar.update()
            waiting -= done
            if stop():
                client.cancel(list(waiting))
                return
            waiting |= {submit(number) for number in islice(missing, len(done))}


def row_of(plan: Plan, future: Any) -> dict[str, Any]:
    """
    Return the row of a run that is done, one way or another.

    Raises
    ------
    SweepError
        When the cluster has gone.

    """
    run = plan.run(int(future.key.rsplit('-', 1)[1]))
    try:
        row: dict[str, Any] = future.result()
    except (CancelledError, OSError):
        raise SweepError(GONE) from None
    except KilledWorker as error:
        problem = f'{error.allowed_failures + 1} workers died while they had it'
        return {'run': run.number, 'seed': run.seed, **run.parameters, 'error': problem}
    return row


if __name__ == '__main__':
    sys.exit(main())
