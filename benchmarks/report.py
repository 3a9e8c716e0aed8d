"""
Tables and figures from the numbers: `python -m benchmarks.report`.

Writes docs/benchmarks.md, PNG files beside the numbers in docs/benchmarks, and the short form into the README.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use('Agg')

from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from benchmarks import results, summary
from benchmarks.rows import verdict
from benchmarks.wording import measured_on, number, with_spread

README = Path(__file__).resolve().parents[1] / 'README.md'

HEAD = """\
# Benchmarks

How fast the engine and the node are, and how right, beside what people would use instead. Repeat it with

    make bench         # 10 minutes: everything below but the two long runs
    make bench-long    # 6 minutes: 10^9 contacts
    make bench-soak    # 10 minutes: memory of the node

What is compared takes turns in one run on the same scenes; what counts is CPU time. Numbers are medians over the
rounds, in brackets the quartiles. A frame is 1/60 s of the scene, with all positions read. The gases are like the
packaged `gas`: disks cover 0.3 of the box and travel about a sixth of a radius a frame. What an exact
engine costs grows with the speed, what a fixed step costs does not: the second figure shows how much that matters.

"""

TABLE = '| scene | against | found | at least | aim | |\n|---|---|---|---|---|---|\n'


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--folder', type=Path, default=results.FOLDER)
    parser.add_argument('--readme', type=Path, default=README, help='gets the short form')
    arguments = parser.parse_args()
    folder = arguments.folder
    path = folder.with_suffix('.md')
    path.write_text(document(folder))
    engine, node = results.load('engine', folder), results.load('node', folder)
    if engine is not None and node is not None:
        summary.put_into(arguments.readme, engine, node, results.load('long_run', folder))
    print(f'written to {path}')


def document(folder: Path) -> str:
    """Return the document, and draw its figures."""
    parts = [HEAD]
    engine = results.load('engine', folder)
    if engine is not None:
        parts += ['## The engine\n\n', measured_on(engine), table(engine['rows'])]
        parts.append(accuracy(engine['accuracy']))
        parts += [figures(engine, folder), settings(engine)]
    for name, title in (('node', 'The node'), ('soak', 'Memory of the node')):
        found = results.load(name, folder)
        if found is not None:
            parts += [f'## {title}\n\n', measured_on(found), table(found['rows'])]
    long_run = results.load('long_run', folder)
    if long_run is not None:
        parts.append(of_long_run(long_run))
    return ''.join(parts).rstrip() + '\n'


def table(rows: list[dict[str, Any]]) -> str:
    """Return lines as a table."""
    return TABLE + ''.join(line(found) for found in rows) + '\n'


def line(found: dict[str, Any]) -> str:
    cells = [
        found['scene'],
        found['against'],
        f'{with_spread(found)} {found["unit"]}'.strip(),
        *('' if found[name] is None else number(found[name]) for name in ('least', 'aim')),
        '; '.join(part for part in (verdict(found), found['note']) if part),
    ]
    return f'| {" | ".join(cells)} |\n'


def accuracy(found: list[dict[str, Any]]) -> str:
    """Return what everybody makes of the same gas."""
    head = (
        '## How right\n\nThe same gas of disks in a closed box, judged by one function that looks at all pairs.\n\n'
        '| run | who | energy error | deepest overlap, radii | left the closed box |\n|---|---|---|---|---|\n'
    )
    lines = [
        f'| {one["run"]} | {one["name"]} | {one["energy_error"]:.1e} | {one["deepest_overlap"]:.2g} | '
        f'{one["escaped"]:,} of {one["count"]:,} |\n'
        for one in found
    ]
    return head + ''.join(lines) + '\n'


def settings(engine: dict[str, Any]) -> str:
    """Return how everybody was set up."""
    lines = ''.join(f'- {text}\n' for text in sorted(set(engine['settings'].values())))
    return f'How the peers are set up; of pymunk the spatial index that is faster on the scene:\n\n{lines}\n'


def of_long_run(found: dict[str, Any]) -> str:
    """Return the paragraph of the run of 10^9 contacts."""
    return (
        f'## A long run\n\n{measured_on(found)}'
        f'The packaged gas after {found["contacts"]:.3g} contacts ({found["scene_s"]:,.0f} s of the scene, '
        f'{found["cpu_s"]:.0f} s of CPU): the energy is off by {found["energy_error"]:.1e}, at most by '
        f'{found["largest_energy_error"]:.1e} on the way (at most 1e-13 is allowed); deepest overlap '
        f'{found["deepest_overlap"]:.1g} of a radius.\n'
    )


# ------------------------------------------------------------------ figures


def figures(engine: dict[str, Any], folder: Path) -> str:
    """Draw them and return how the document shows them."""
    drawn = [
        (
            'cost.png',
            'What an event and a contact cost, by how many disks there are',
            cost(engine['cost']),
        ),
        (
            'speed.png',
            'How many times faster than pymunk, by how fast the disks are',
            speed(engine['speed']),
        ),
    ]
    text = ''
    for name, title, figure in drawn:
        figure.savefig(folder / name, dpi=120, metadata={'Software': None})
        plt.close(figure)
        text += f'![{title}]({folder.name}/{name})\n\n'
    return text


def cost(found: list[dict[str, float]]) -> Figure:
    """Draw the cost against N, with log N through the first point."""
    figure, axes = plt.subplots(figsize=(7, 4), layout='constrained')
    counts = [one['count'] for one in found]
    events = [one['event_ns'] for one in found]
    contacts = [one['contact_ns'] for one in found]
    below = [one['contact_ns'] - one['contact_ns_low'] for one in found]
    above = [one['contact_ns_high'] - one['contact_ns'] for one in found]
    axes.errorbar(counts, contacts, [below, above], fmt='o-', capsize=3, label='a contact')
    axes.plot(counts, events, 's-', label='an event (contact or change of cell)')
    limit = [events[0] * math.log(count) / math.log(counts[0]) for count in counts]
    axes.plot(counts, limit, '--', color='grey', label='log N from the first point')
    axes.set(xscale='log', xlabel='disks', ylabel='CPU time, ns', ylim=(0, None))
    axes.set_title('Gas of equal disks, packing 0.3')
    axes.legend()
    axes.grid(alpha=0.3)
    return figure


def speed(found: list[dict[str, float]]) -> Figure:
    """Draw the ratio against the speed of the disks."""
    figure, axes = plt.subplots(figsize=(7, 4), layout='constrained')
    speeds = [one['speed'] for one in found]
    for key, label in (
        ('pymunk', 'body.position of each'),
        ('batch', 'pymunk.batch (experimental)'),
    ):
        axes.plot(speeds, [one[key] for one in found], 'o-', label=f'pymunk read with {label}')
    axes.axhline(1.0, color='grey', linestyle='--')
    axes.set(
        xscale='log',
        yscale='log',
        xlabel='speed, radii a frame',
        ylabel='pymunk by ours, CPU time',
    )
    axes.set_title('Gas of 1,000 disks: faster than pymunk by')
    axes.legend()
    axes.grid(alpha=0.3, which='both')
    return figure


if __name__ == '__main__':
    main()
