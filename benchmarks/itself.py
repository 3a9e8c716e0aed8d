"""The engine beside itself: rates, other sizes and densities, ever more disks, and the first call."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import tempfile
import tracemalloc
from typing import Any

from benchmarks import scenes
from benchmarks.contestants import Ours
from benchmarks.measure import Pace, Work, frames_of, in_turn, ratios, summary
from benchmarks.rows import row
from circle_bounce_ros.kernel import Scene, Simulation

Row = dict[str, Any]


def rows(pace: Pace) -> list[Row]:
    """Return all lines but those of ever more disks."""
    return [*rates(pace), tilted_walls(pace), *unlike_equal_disks(pace), *compilation(pace)]


def rates(pace: Pace) -> list[Row]:
    """Return the lines of what there is done in a second, compiled and plain."""
    count = min(1_000, pace.largest)
    gas = scenes.gas(count)
    compiled, plain = in_turn(
        [contacts_of(Simulation(gas)), events_of(Simulation(gas, compiled=False))], pace
    )
    name = f'gas, {count:,} equal disks'
    contacts, events = [1e-6 / cost for cost in compiled], [1.0 / cost for cost in plain]
    return [
        row(name, 'itself, with numba', contacts, 'million contacts/s', 2, 4),
        row(name, 'itself, without numba', events, 'events/s', 40_000, 100_000),
    ]


def tilted_walls(pace: Pace) -> Row:
    """Return the line of walls at a tilt."""
    count = min(1_000, pace.largest)
    sides = {n: scenes.in_a_polygon([scenes.Kind(count, 1.0)], scenes.PACKING, n) for n in (4, 12)}
    square, tilted = in_turn([frames_of(Ours(sides[n])) for n in (4, 12)], pace)
    name = f'{count:,} disks in a box of 12 tilted walls'
    slower = ratios(tilted, square)
    return row(name, 'itself in a square', slower, 'x slower', 1.3, 1.1, more_is_better=False)


def unlike_equal_disks(pace: Pace) -> list[Row]:
    """Return the lines of different sizes and of a thin gas, per contact."""
    count = min(2_000, pace.largest)
    wanted = {
        'radii 1:10, 5 % large': (scenes.sizes(count, 10.0, 0.05), 3, 1.5),
        'radii 1:100, 1 % large': (scenes.sizes(count, 100.0, 0.01), 6, 2),
        'equal, packing 0.003': (scenes.gas(count, packing=0.003), 6, 3),
    }
    works = [contacts_of(Simulation(scenes.gas(count)))]
    works += [contacts_of(Simulation(scene)) for scene, _, _ in wanted.values()]
    equal, *others = in_turn(works, pace)
    return [
        row(
            f'{count:,} disks, {name}',
            'itself, equal radii, packing 0.3, per contact',
            ratios(cost, equal),
            'x slower',
            least,
            aim,
            more_is_better=False,
        )
        for (name, (_, least, aim)), cost in zip(wanted.items(), others, strict=True)
    ]


def contacts_of(simulation: Simulation) -> Work:
    """Return work that is counted in contacts, some hundred at a time."""
    step = scenes.FRAME

    def work() -> float:
        nonlocal step
        before = simulation.contact_count
        simulation.advance_to(simulation.time + step)
        contacts = simulation.contact_count - before
        if contacts < 500:
            step *= 2.0
        return float(contacts)

    return work


def events_of(simulation: Simulation) -> Work:
    """Return work that is counted in events: contacts and changes of cell."""

    def work() -> float:
        before = events_so_far(simulation)
        simulation.advance_to(simulation.time + scenes.FRAME)
        return float(events_so_far(simulation) - before)

    return work


def events_so_far(simulation: Simulation) -> int:
    """Return how many contacts and changes of cell there have been; nobody else wants to know."""
    return int(simulation._engine.get('events'))


def cost_against_count(pace: Pace) -> tuple[list[Row], list[dict[str, float]]]:
    """
    Return what a contact and an event cost among ever more disks.

    Returns
    -------
    rows : list
        The lines of the growth, and of the memory of the most.
    found : list of dict
        For the figure.

    """
    counts = [n for n in (100, 316, 1_000, 3_162, 10_000, 31_623, 100_000) if n <= pace.largest]
    simulations = [Simulation(scenes.gas(count)) for count in counts]
    costs = in_turn([contacts_of(one) for one in simulations], pace)
    found, of_event = [], []
    for count, simulation, cost in zip(counts, simulations, costs, strict=True):
        contacts_an_event = simulation.contact_count / events_so_far(simulation)
        of_event.append([contacts_an_event * of_contact for of_contact in cost])
        contact, event = summary(cost), summary(of_event[-1])
        found.append(
            {
                'count': count,
                'contact_ns': 1e9 * contact['median'],
                'contact_ns_low': 1e9 * contact['low'],
                'contact_ns_high': 1e9 * contact['high'],
                'event_ns': 1e9 * event['median'],
            }
        )
    logarithm = math.log(counts[-1]) / math.log(counts[0])
    growth = ratios(of_event[-1], of_event[0])
    note = f'an event costs {summary(growth)["median"]:.3g} times as much, log N is {logarithm:.3g} times as much'
    return [
        row(
            f'cost of an event, {counts[-1]:,} disks against {counts[0]:,}',
            'growth of log N',
            [one / logarithm for one in growth],
            'x as much',
            1.0,
            more_is_better=False,
            note=note,
        ),
        memory(scenes.gas(counts[-1])),
    ], found


def memory(scene: Scene) -> Row:
    """Return the line of what a simulation holds, the scene that it starts from not counted."""
    tracemalloc.start()
    simulation = Simulation(scene)
    simulation.advance_to(scenes.FRAME)
    held, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    count = len(simulation.ids)
    name = f'{count:,} equal disks'
    return row(name, 'memory', [held / count], 'bytes a disk', 400, more_is_better=False)


FIRST_CALL = """
import json, sys, time
from circle_bounce_ros.kernel import Circle, Scene, Simulation
scene = Scene([Circle((3.0 * i, 0.0), (1.0, 0.0), radius=1.0) for i in range(10)])
began = time.process_time()
Simulation(scene, compiled=True).advance_to(1.0)
print(json.dumps(time.process_time() - began))
"""


def compilation(pace: Pace) -> list[Row]:
    """Return the lines of the first call, with nothing and with everything in the cache."""
    rounds = min(3, pace.rounds)
    cold, warm = [], []
    for _ in range(rounds):
        with tempfile.TemporaryDirectory() as cache:
            cold.append(first_call(cache))
            warm.append(first_call(cache))
    return [
        row('first call', 'nothing compiled yet', cold, 's of CPU', 8, 3, more_is_better=False),
        row('first call', 'compiled before', warm, 's of CPU', 0.6, 0.3, more_is_better=False),
    ]


def first_call(cache: str) -> float:
    """Return the CPU time of the first call in a new process, import of numba included, s."""
    environment = {**os.environ, 'XDG_CACHE_HOME': cache}
    output = subprocess.check_output([sys.executable, '-c', FIRST_CALL], env=environment)
    return float(json.loads(output))
