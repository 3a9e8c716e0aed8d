"""One run of a sweep, wherever a worker is: simulate, record, measure, and only then show up in the folder."""

from __future__ import annotations

import json
import shutil
import uuid
from functools import lru_cache
from pathlib import Path
from typing import Any

from circle_bounce_ros.kernel import Scene, Simulation
from circle_bounce_ros.offline.files import remove_begun
from circle_bounce_ros.offline.observables import Observables
from circle_bounce_ros.offline.plan import Plan, Run, restore
from circle_bounce_ros.offline.recording import Sink, moments
from circle_bounce_ros.offline.sinks import open_sink, topics_to_record
from circle_bounce_ros.offline.summary import read_row

PLAN = 'plan.json'
RUNS = 'runs'
ROW = 'row.json'
RECORDING = 'recording'
# Where runs are until they are whole: beside the others, a reader of all recordings would find half of one.
UNFINISHED = '.unfinished'

RUNS_A_FOLDER = 1000  # more files in one folder make file systems slow


@lru_cache(maxsize=4)
def plan_of(folder: str, digest: str) -> Plan:
    """
    Return the plan of a sweep, read once by each worker.

    Raises
    ------
    FileNotFoundError
        On a machine that does not see the folder of the sweep.
    ValueError
        When another sweep is there.

    """
    plan = restore((Path(folder) / PLAN).read_text())
    if plan.digest() != digest:
        raise ValueError(f'{folder}: holds another sweep than the one that was asked for')
    return plan


def place_of(folder: Path, number: int) -> Path:
    """Return the folder of a run."""
    return folder / RUNS / f'{number // RUNS_A_FOLDER:06d}' / f'{number:09d}'


def perform(folder: str, digest: str, number: int) -> dict[str, Any]:
    """
    Carry out a run and return its row of the summary, or what went wrong.

    Twice the same run, even at the same time, does no harm: whoever is first to be complete gives the
    folder its name.

    Parameters
    ----------
    folder : str
        Of the sweep; workers and whoever asks see it under the same path.
    digest : str
        Of the plan.
    number : int

    Returns
    -------
    dict
        `run`, `seed`, the parameters and the observables; or `run`, `seed`, the parameters and `error`.

    """
    run = None
    try:
        plan = plan_of(folder, digest)
        run = plan.run(number)
        place = place_of(Path(folder), number)
        if (place / ROW).exists():
            row = read_row((place / ROW).read_bytes(), plan)
            if row and row['run'] == number:
                return row
            # What cannot be read is done again.
            shutil.rmtree(place)
        return _perform(plan, run, place)
    except Exception as error:
        about = {'seed': run.seed, **run.parameters} if run else {}
        return {'run': number} | about | {'error': f'{type(error).__name__}: {error}'}


def _perform(plan: Plan, run: Run, place: Path) -> dict[str, Any]:
    scene = plan.build(run)
    if plan.record == 'none':
        return _simulate(plan, run, scene, None)
    place.parent.mkdir(parents=True, exist_ok=True)
    begun = place.parents[2] / UNFINISHED / f'{place.name}-{uuid.uuid4().hex}'
    begun.mkdir(parents=True)
    try:
        row = _simulate(plan, run, scene, begun / RECORDING)
        (begun / ROW).write_text(json.dumps(row) + '\n')
        try:
            begun.rename(place)
        except OSError:
            # Somebody else was first, with the same bytes.
            if not (place / ROW).exists():
                raise
    finally:
        shutil.rmtree(begun, ignore_errors=True)
    return row


def _simulate(plan: Plan, run: Run, scene: Scene, recording: Path | None) -> dict[str, Any]:
    simulation = Simulation(scene, record_contacts=True)
    observables = Observables(simulation, plan.warm_up)
    sink = _sink(plan, scene, recording)
    try:
        for moment in moments(simulation, plan.ticks()):
            observables.add(moment)
            if sink:
                sink.write(moment)
        if sink:
            sink.close()
    except BaseException:
        if sink:
            sink.abort()
        raise
    return {'run': run.number, 'seed': run.seed, **run.parameters, **observables.row()}


def _sink(plan: Plan, scene: Scene, recording: Path | None) -> Sink | None:
    if recording is None:
        return None
    # Once more, for names of circles may differ from run to run.
    topics = None if plan.topics is None else topics_to_record(plan.topics, scene, plan.record)
    return open_sink(recording, scene, plan.record, topics)


def remove_unfinished(folder: Path) -> None:
    """Remove what was killed in the middle from the folder of a sweep."""
    remove_begun(folder)
    shutil.rmtree(folder / UNFINISHED, ignore_errors=True)
