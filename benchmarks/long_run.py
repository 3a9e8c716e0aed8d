"""
A run of 10^9 contacts: how far the energy goes astray. `python -m benchmarks.long_run [CONTACTS]`.

It takes about six minutes of one core, so it has its own command: `make bench-long`.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from benchmarks import machine, results
from circle_bounce_ros.kernel import Simulation, deepest_overlap, kinetic_energy
from circle_bounce_ros.scene_file import load_scene

SCENE = 'gas'
REPORTS = 100


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('contacts', nargs='?', type=float, default=1e9)
    parser.add_argument('--into', type=Path, default=results.FOLDER)
    arguments = parser.parse_args()
    found = run(int(arguments.contacts))
    path = results.save('long_run', {'machine': machine.describe(), **found}, arguments.into)
    print(f'written to {path}')


def run(contacts: int) -> dict[str, float]:
    """
    Run the packaged gas until it has had so many contacts.

    Returns
    -------
    dict
        `contacts`, `cpu_s`, `scene_s`, `energy_error` at the end and the largest seen (relative), and
        `deepest_overlap` (in radii, of the last state).

    """
    simulation = Simulation(load_scene(SCENE))
    energy = kinetic_energy(simulation)
    simulation.advance_to(1.0)
    step = max(1.0, contacts / simulation.contact_count / REPORTS)  # s of the scene
    began = time.process_time()
    error = largest = 0.0
    while simulation.contact_count < contacts:
        simulation.advance_to(simulation.time + step)
        error = kinetic_energy(simulation) / energy - 1.0
        largest = max(largest, abs(error))
        print(f'{simulation.contact_count:.3e} contacts, energy error {error:.2e}', flush=True)
    return {
        'contacts': simulation.contact_count,
        'cpu_s': time.process_time() - began,
        'scene_s': simulation.time,
        'energy_error': error,
        'largest_energy_error': largest,
        'deepest_overlap': deepest_overlap(simulation) / float(simulation.radii.min()),
    }


if __name__ == '__main__':
    main()
