"""The short form of the numbers, for the README: what most people want to know."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from benchmarks.rows import verdict
from benchmarks.wording import measured_on, number, with_spread

BEGIN = '<!-- made by `make bench` -->\n'
END = '<!-- end of what `make bench` makes -->\n'

MINUTE, FAST = 'slow', 'fast'


def put_into(
    readme: Path, engine: dict[str, Any], node: dict[str, Any], long_run: dict[str, Any] | None
) -> None:
    """
    Write the short form between its two marks.

    Raises
    ------
    ValueError
        For a document without the marks.

    """
    text = readme.read_text()
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not (begin and end):
        raise ValueError(f'{readme}: must have the lines {BEGIN!r} and {END!r}')
    readme.write_text(before + begin + short(engine, node, long_run) + end + after)


def short(engine: dict[str, Any], node: dict[str, Any], long_run: dict[str, Any] | None) -> str:
    """Return the short form."""
    parts = [measured_on(engine), rates(engine, long_run), beside_peers(engine)]
    return ''.join([*parts, accuracy(engine), live(node)])


def rates(engine: dict[str, Any], long_run: dict[str, Any] | None) -> str:
    """Return what is done in a second, and how far energy goes astray."""
    found = {row['against']: row for row in engine['rows']}
    compiled, plain = found['itself, with numba'], found['itself, without numba']
    text = (
        f'{compiled["scene"]}: {number(compiled["median"])} million contacts a second of one core, compiled by '
        f'numba; without it {number(plain["median"])} events a second, and the same bits.'
    )
    if long_run is not None:
        text += (
            f' After {long_run["contacts"]:.2g} contacts the energy is off by {long_run["energy_error"]:.1e} '
            '(`make bench-long`).'
        )
    return text + '\n\n'


def beside_peers(engine: dict[str, Any]) -> str:
    """Return a table of those lines in which a peer has to be beaten."""
    rows = [
        found
        for found in engine['rows']
        if found['least'] is not None and found['unit'] == 'x faster'
    ]
    lines = (
        f'| {found["scene"]} | {found["against"]} | {with_spread(found)} | {number(found["least"])} |\n'
        for found in rows
    )
    return (
        '| scene | against | CPU time, faster by | wanted |\n|---|---|---|---|\n'
        + ''.join(lines)
        + '\n'
    )


def accuracy(engine: dict[str, Any]) -> str:
    """Return a table of what everybody gets wrong."""
    runs: dict[str, dict[str, Any]] = {}
    for one in engine['accuracy']:
        runs.setdefault(one['name'], {})[one['run'].partition(':')[0]] = one
    lines = (
        f'| {name} | {run[MINUTE]["energy_error"]:.1e} | {run[MINUTE]["deepest_overlap"]:.2g} | '
        f'{run[FAST]["escaped"]:,} of {run[FAST]["count"]:,} |\n'
        for name, run in runs.items()
    )
    head = (
        '| the gas of 1,000 | energy error after a minute | deepest overlap, radii | '
        'left the closed box at 100 radii a frame |\n|---|---|---|---|\n'
    )
    return head + ''.join(lines) + '\n'


def live(node: dict[str, Any]) -> str:
    """Return a table of what the node costs, somebody listening over DDS."""
    rows = [found for found in node['rows'] if found['least'] is not None]
    lines = (
        f'| {found["scene"]} | {found["against"]} | {with_spread(found)} {found["unit"]}'.rstrip()
        + f' | {verdict(found)} |\n'
        for found in rows
    )
    return '| the node | | found | |\n|---|---|---|---|\n' + ''.join(lines) + '\n'
