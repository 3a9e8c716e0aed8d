"""Mean free path and contact rate over time, with the theory where there is one."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from circle_bounce_ros.kernel import ContactKind
from circle_bounce_ros.offline import expected
from circle_bounce_ros.offline.expected import Expected
from circle_bounce_ros.offline.observables import Window, bulk, ends_of
from circle_bounce_ros.offline.pictures.style import INK, MOVING, Picture, canvas, title
from circle_bounce_ros.offline.source import Source, SourceError

TIME_BINS = 20
# What is shown above and below the measured points, at least, as a part of their mean.
LEAST_VIEW = 0.1


class Counts(NamedTuple):
    """
    What was counted in each part of the time.

    Attributes
    ----------
    time : (b,) float, s
        Its middle.
    ends : (b,) float
        Circles' contacts: two of each pair of moving ones.
    pairs : (b,) float
        Contacts of two moving circles.
    circle_time : (b,) float, s
        Time times circles.
    way : (b,) float, m
        What all circles went together.
    packing : float
        Mean number of circles that were counted, times their area, over that of the window; nan without one.
    end : float, s

    """

    time: NDArray[np.float64]
    ends: NDArray[np.float64]
    pairs: NDArray[np.float64]
    circle_time: NDArray[np.float64]
    way: NDArray[np.float64]
    packing: float
    end: float


def free_path(source: Source) -> Picture:
    """
    Draw both.

    Of equal circles that hit each other those away from the walls are counted, for which there is a theory.
    """
    alike = len({(circle.radius, circle.mass) for circle in source.moving}) == 1
    is_gas = source.collide and alike and len(source.moving) > 1
    window = bulk(source.scene) if is_gas else None
    counts = count(source, window)
    theory = (
        expected.of_gas(source.moving, counts.packing)
        if window
        else expected.of_billiard(source.scene, source.collide)
    )
    # Each contact is a count of its own, of variance 1; that of a pair is counted twice, which makes it 4.
    error = np.sqrt(counts.ends + 2.0 * counts.pairs) / np.maximum(counts.ends, 1.0)
    seen = counts.ends > 0.0
    time, error = counts.time[seen], error[seen]
    path = counts.way[seen] / counts.ends[seen]
    rate = counts.ends[seen] / counts.circle_time[seen]
    figure, (left, right) = canvas(3.9, columns=2)
    draw(left, time, path, path * error, theory and (theory.path, theory.path_formula))
    draw(right, time, rate, rate * error, theory and (theory.rate, theory.rate_formula))
    for axes in (left, right):
        axes.set_xlim(0.0, counts.end)
    title(left, f'{source.name}: mean free path / m')
    title(right, 'contacts of a circle, per second')
    return figure, numbers_of(counts, theory)


def count(source: Source, window: Window | None) -> Counts:
    """Count contacts and ways of all circles, or of those in a window."""
    times, ends, pairs, inside, ways = [], [], [], [], []
    for frame in source.frames():
        held = (
            window.holds(frame.positions[:, 0], frame.positions[:, 1])
            if window
            else np.ones(len(frame.positions), bool)
        )
        contacts = frame.contacts
        if window:
            contacts = contacts[contacts['kind'] == ContactKind.CIRCLE]
            contacts = contacts[window.holds(contacts['x'], contacts['y'])]
        times.append(frame.time)
        inside.append(int(held.sum()))
        ways.append(float(np.hypot(*frame.velocities.T)[held].sum()))
        ends.append(ends_of(contacts['kind']))
        pairs.append(ends[-1] - len(contacts))
    if len(times) < 2 or not sum(ends[1:]):
        why = '' if source.contacts_known else ', as their topic is not in it'
        raise SourceError(f'{source.name}: must have contacts, got none{why}')
    time, step = np.array(times), np.diff(times)
    # The contacts of the first frame are from before it.
    parts = np.array_split(np.arange(1, len(time)), min(TIME_BINS, len(step)))

    def summed(values: list[int] | list[float], by_time: bool) -> NDArray[np.float64]:
        weighted = np.array(values, float)[1:] * (step if by_time else 1.0)
        return np.array([weighted[part - 1].sum() for part in parts])

    packing = math.nan
    if window:
        radius = source.moving[0].radius
        packing = float(np.mean(inside)) * math.pi * radius**2 / window.area
    return Counts(
        np.array([time[part].mean() for part in parts]),
        summed(ends, False),
        summed(pairs, False),
        summed(inside, True),
        summed(ways, True),
        packing,
        times[-1],
    )


def draw(
    axes: Axes,
    time: NDArray[np.float64],
    values: NDArray[np.float64],
    errors: NDArray[np.float64],
    theory: tuple[float, str] | None,
) -> None:
    """Draw a panel: measured points with their bars and the theory with its name, seen closely."""
    axes.errorbar(
        time, values, errors, fmt='o', color=MOVING, markersize=4.5, elinewidth=1.2,
        label='measured',
    )  # fmt: skip
    lowest, highest = float((values - errors).min()), float((values + errors).max())
    if theory:
        line, formula = theory
        axes.axhline(line, color=INK, linewidth=1.8, label=formula)
        lowest, highest = min(lowest, line), max(highest, line)
    middle = (lowest + highest) / 2.0
    off = max(LEAST_VIEW * middle, (highest - lowest) / 2.0)
    # Room for the legend above.
    axes.set_ylim(max(0.0, middle - 1.15 * off), middle + 1.9 * off)
    axes.set_xlabel('time / s')
    axes.legend(loc='upper right', fontsize=10.0)


def numbers_of(counts: Counts, theory: Expected | None) -> dict[str, float]:
    """Return the numbers that the picture shows."""
    numbers = (
        theory.given | {'theory path': theory.path, 'theory rate': theory.rate} if theory else {}
    )
    numbers['mean free path'] = float(counts.way.sum() / counts.ends.sum())
    numbers['contact rate'] = float(counts.ends.sum() / counts.circle_time.sum())
    return numbers
