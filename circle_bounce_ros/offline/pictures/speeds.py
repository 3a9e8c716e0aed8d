"""How often a speed occurs, with Maxwell's law in two dimensions over it."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes

from circle_bounce_ros.offline.observables import ends_of
from circle_bounce_ros.offline.pictures.style import (
    HELP,
    INK,
    MOVING,
    MOVING_FILL,
    Picture,
    canvas,
    title,
)
from circle_bounce_ros.offline.source import Source, SourceError

BINS = 30
FASTEST = 4.0  # thermal speeds
# Speeds of the same circle so many contacts apart are taken as independent.
CONTACTS_APART = 3.0


def speeds(source: Source) -> Picture:
    """Draw the speeds of all frames but the first, each by the thermal speed of its circle."""
    source.check_masses('speeds')
    masses = source.masses
    edges = np.linspace(0.0, FASTEST, BINS + 1)
    counts = np.zeros(BINS)
    looks, ends, total = 0, 0, 0.0
    thermal, end = None, 0.0
    for frame in source.frames():
        squares = np.square(frame.velocities).sum(axis=1)
        if thermal is None:
            energy = 0.5 * float(masses @ squares)
            if not energy > 0.0:
                raise SourceError(f'{source.name}: nothing moves')
            thermal = np.sqrt(energy / len(masses) / masses)
        else:
            scaled = np.sqrt(squares) / thermal
            counts += np.histogram(scaled, edges)[0]
            looks, total = looks + 1, total + float(scaled.sum())
        ends += ends_of(frame.contacts['kind'])
        end = frame.time
    if not looks:
        raise SourceError(f'{source.name}: must have at least two instants')
    sampled = looks * len(masses)
    independent = min(float(sampled), max(len(masses), ends / CONTACTS_APART))
    width = edges[1]
    part = counts / sampled
    height, error = part / width, np.sqrt(part * (1.0 - part) / independent) / width
    figure, axes = canvas(4.2)
    middle = (edges[1:] + edges[:-1]) / 2.0
    axes.bar(middle, height, 0.92 * width, color=MOVING_FILL, edgecolor=MOVING, linewidth=0.8)
    axes.errorbar(middle, height, error, fmt='none', ecolor=MOVING, elinewidth=1.2)
    _draw_law(axes, source.collide and len(masses) > 1)
    axes.set_xlabel(r'speed $u = v / \sqrt{kT / m}$')
    axes.set_ylabel('probability density')
    axes.set_xlim(0.0, FASTEST)
    axes.set_ylim(bottom=0.0)
    circles = '1 circle' if len(masses) == 1 else f'{len(masses)} circles'
    title(axes, f'{source.name}: speeds of {circles} over {end:.4g} s')
    mean, maxwell = total / sampled, math.sqrt(math.pi / 2.0)
    return figure, {'mean speed': mean, 'Maxwell': maxwell, 'samples': sampled}


def _draw_law(axes: Axes, holds: bool) -> None:
    """Draw Maxwell's law, and say so where it is not expected to hold."""
    u = np.linspace(0.0, FASTEST, 400)
    axes.plot(u, u * np.exp(-(u**2) / 2.0), color=INK, linewidth=2.0)
    text = "Maxwell's law\n$u\\,e^{-u^2/2}$"
    if not holds:
        text += '\n(not for these: no moving\ncircles hit each other)'
    # Above the curve's far side, by parts of the panel: bars may be far higher than the curve.
    axes.annotate(
        text, (2.0, 2.0 * math.exp(-2.0)), (0.6, 0.6), textcoords='axes fraction',
        arrowprops={'arrowstyle': '-', 'color': HELP},
    )  # fmt: skip
