"""How far the kinetic energy is from where it began."""

from __future__ import annotations

import math

import numpy as np

from circle_bounce_ros.offline.pictures.style import BAND, HELP, MOVING, Picture, canvas, title
from circle_bounce_ros.offline.source import Source, SourceError


def energy(source: Source) -> Picture:
    """Draw the relative change of the kinetic energy over time."""
    source.check_masses('energy')
    masses = source.masses
    times, energies, contacts = [], [], 0
    for frame in source.frames():
        times.append(frame.time)
        # Summed exactly: the roundings that show are the simulation's.
        energies.append(0.5 * math.fsum(masses * np.square(frame.velocities).sum(axis=1)))
        contacts += len(frame.contacts)
    if not energies or not energies[0] > 0.0:
        raise SourceError(f'{source.name}: nothing moves')
    if len(times) < 2:
        raise SourceError(f'{source.name}: must have at least two instants')
    change = np.array(energies) / energies[0] - 1.0
    largest = float(np.abs(change).max())
    figure, axes = canvas(3.9)
    axes.axhspan(-source.digits, source.digits, color=BAND, zorder=0)
    axes.plot(times, change, color=MOVING, linewidth=1.4)
    limit = 1.35 * max(largest, source.digits)
    axes.set_ylim(-limit, limit)
    axes.set_xlim(0.0, times[-1])
    axes.set_xlabel('time / s')
    axes.set_ylabel(r'$E(t) / E(0) - 1$')
    axes.text(
        0.99, 0.03, f'grey: one rounding of one number, {source.digits:.1e}', ha='right',
        color=HELP, transform=axes.transAxes, fontsize=10.0,
    )  # fmt: skip
    known = {'contacts': contacts} if source.contacts_known else {}
    counted = f', {contacts:,} contacts' if known else ''
    title(axes, f'{source.name}: change of the kinetic energy{counted}')
    return figure, {'largest': largest, **known, 'duration': times[-1]}
