"""The pressure of hard disks against their packing fraction, with the theory drawn in."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.offline import theory
from circle_bounce_ros.offline.pictures.style import (
    BLUE,
    HELP,
    INK,
    ORANGE,
    Picture,
    canvas,
    title,
)
from circle_bounce_ros.offline.source import SourceError

# 95 % of Student's t lie within plus and minus so much, for 1, 2, ... degrees of freedom.
STUDENT = (
    *(12.71, 4.30, 3.18, 2.78, 2.57, 2.45, 2.36, 2.31, 2.26, 2.23),
    *(2.20, 2.18, 2.16, 2.14, 2.13, 2.12, 2.11, 2.10, 2.09, 2.09),
)
DASHES = (0, (5, 3))


def pressure(name: str, packing: NDArray[np.float64], found: NDArray[np.float64]) -> Picture:
    """
    Draw the compressibility against the packing fraction, and below how far it is from the theory.

    Parameters
    ----------
    name : str
    packing, found : (k, s) float
        Packing fraction and Z of s runs at each of k settings.

    """
    runs = packing.shape[1]
    if runs < 2:
        raise SourceError(f'{name}: must have at least 2 seeds for error bars, got 1')
    # Run by run, because a run that happens to be a little denser also has a higher pressure.
    exact = np.vectorize(theory.virial_series)(packing)
    henderson = np.vectorize(theory.compressibility)(packing)
    x = packing.mean(axis=1)
    apart = found / exact - 1.0
    student = STUDENT[min(runs - 1, len(STUDENT)) - 1]
    off = apart.mean(axis=1)
    error = student * apart.std(axis=1, ddof=1) / math.sqrt(runs)
    figure, (top, low) = canvas(6.2, rows=2, sharex=True, height_ratios=[2.2, 1.0])
    phi = np.linspace(0.0, 1.08 * float(x.max()), 300)
    top.plot(phi, [theory.virial_series(p) for p in phi], color=INK, linewidth=1.8,
             label='ten virial coefficients, Padé')  # fmt: skip
    top.plot(phi, [theory.compressibility(p) for p in phi], color=ORANGE, linewidth=1.8,
             linestyle=DASHES, label=r'Henderson, $1 + 2\varphi\chi$')  # fmt: skip
    top.plot(x, found.mean(axis=1), 'o', color=BLUE, markersize=6.0,
             label=f'measured, {runs} seeds each')  # fmt: skip
    top.set_ylabel(r'$Z = P / (n\,kT)$')
    top.legend(loc='upper left')
    low.axhline(0.0, color=INK, linewidth=1.8)
    low.plot(x, 100.0 * (henderson / exact - 1.0).mean(axis=1), color=ORANGE, linewidth=1.8,
             linestyle=DASHES)  # fmt: skip
    low.errorbar(x, 100.0 * off, 100.0 * error, fmt='o', color=BLUE, capsize=3.0, markersize=5.0)
    low.set_ylabel('off by / %')
    low.text(0.01, 0.04, 'bars: 95 %', color=HELP, transform=low.transAxes, fontsize=10.0)
    low.set_xlabel(r'packing fraction in the bulk $\varphi$')
    low.set_xlim(0.0, phi[-1])
    title(top, f'Pressure of hard disks ({packing.size} runs)')
    return figure, {
        'settings': len(x),
        'seeds': runs,
        'bars off the theory': int((np.abs(off) > error).sum()),
        'largest deviation %': float(100.0 * np.abs(off).max()),
        'largest bar %': float(100.0 * error.max()),
    }
