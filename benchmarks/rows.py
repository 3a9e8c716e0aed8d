"""One line of the table: what was measured, how far it scattered, and what it should be."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from benchmarks.measure import summary


def row(
    scene: str,
    against: str,
    values: Sequence[float],
    unit: str,
    least: float | None = None,
    aim: float | None = None,
    more_is_better: bool = True,
    note: str = '',
) -> dict[str, Any]:
    """
    Return a line of the table.

    Parameters
    ----------
    scene, against : str
        What was run, and what it is compared with.
    values : (k,) float
        One number a round.
    unit : str
        Put behind the numbers, such as 'x'.
    least, aim : float, optional
        What has to be reached, and what is hoped for.
    more_is_better : bool
    note : str
        What a reader has to know.

    """
    found = {
        'scene': scene,
        'against': against,
        'unit': unit,
        'least': least,
        'aim': aim,
        'more_is_better': more_is_better,
        'note': note,
        **summary(values),
    }
    print(f'{scene} | {against} | {found["median"]:.4g} {unit} | {verdict(found)}', flush=True)
    return found


def verdict(found: dict[str, Any]) -> str:
    """Return whether a line is reached; if not, by how much it is missed."""
    for name, word in (('aim', 'aim reached'), ('least', 'reached')):
        wanted = found[name]
        if wanted is not None and is_reached(found, wanted):
            return word
    if found['least'] is None and found['aim'] is None:
        return ''
    wanted = found['least'] if found['least'] is not None else found['aim']
    if wanted == 0.0:
        return f'missed by {found["median"]:.3g} {found["unit"]}'
    gap = abs(found['median'] / wanted - 1.0)
    return f'missed by {100.0 * gap:.0f} %'


def is_reached(found: dict[str, Any], wanted: float) -> bool:
    """Return whether the median is as good as what is wanted."""
    if found['more_is_better']:
        return bool(found['median'] >= wanted)
    return bool(found['median'] <= wanted)
