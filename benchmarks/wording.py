"""Numbers in words, the same in every document."""

from __future__ import annotations

import math
from typing import Any


def measured_on(found: dict[str, Any]) -> str:
    """Return when and where."""
    machine = dict(found['machine'])
    date, processor, cores = (machine.pop(key) for key in ('date', 'processor', 'cores'))
    versions = ', '.join(f'{name} {version}' for name, version in machine.items())
    return f'Measured on {date}, {processor}, {cores} cores; {versions}.\n\n'


def with_spread(found: dict[str, Any]) -> str:
    """Return the median of a line, with its quartiles where there are several rounds."""
    spread = f' ({number(found["low"])} - {number(found["high"])})' if found['rounds'] > 1 else ''
    return f'**{number(found["median"])}**{spread}'


def number(value: float) -> str:
    """Return three digits."""
    if value == 0.0 or 1e-3 <= abs(value) < 1e6:
        digits = 2 if value == 0.0 else max(0, 2 - math.floor(math.log10(abs(value))))
        text = f'{value:,.{digits}f}'
        return text.rstrip('0').rstrip('.') if '.' in text else text
    return f'{value:.1e}'
