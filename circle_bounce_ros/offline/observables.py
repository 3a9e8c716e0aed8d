"""
What one run says in one row: rates, lengths, pressure, diffusion, and how well the energy was kept.

Quantities of the bulk come from a window that keeps away from the walls, because near a wall circles are layered.
The pressure is that of the virial: with N circles in the window at a time, on average, and the impulse J of
each contact of two circles there, whose centres are s apart,

    P A = N kT + sum(s J) / (2 T)        Z = P A / (N kT)

over a time T in a window of area A. NkT is the kinetic energy in the window, on average: heat spreads slowly, so
that the window may be warmer than the whole for seconds.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.encoding.topics import Moment
from circle_bounce_ros.kernel import ContactKind, Scene, Simulation
from circle_bounce_ros.schedule.times import kernel_time

# How far the window keeps from the walls: radii, but no more than this part of the shorter side.
MARGIN = 10.0
LARGEST_MARGIN = 0.25

# Displacements are compared at these times, in mean free times: beyond the free flight, and before most
# circles have come to a wall from where they began.
LAGS = (3.0, 6.0)
# How far from a wall they begin, as a part of the shorter side.
DEEP = 0.3
# That must be so many standard deviations of the displacement along an axis, or walls have turned circles back.
DEVIATIONS = 2.5

# Column, unit and meaning of a row of the summary.
COLUMNS: dict[str, tuple[str, str]] = {
    'measured': ('s', 'time over which the rest was measured'),
    'circles': ('1', 'moving circles'),
    'contacts': ('1', 'contacts of any kind'),
    'pair_contacts': ('1', 'contacts of two moving circles'),
    'contact_rate': ('1/s', 'contacts of one moving circle, per second'),
    'mean_free_path': ('m', 'mean way of a moving circle between two contacts'),
    'temperature': ('J', 'kT: mean kinetic energy of a moving circle'),
    'packing': ('1', 'packing fraction in the bulk'),
    'pressure': ('N/m', 'of the bulk, from the virial'),
    'compressibility': ('1', 'Z = pressure / (number density * kT), in the bulk'),
    'pressure_walls': ('N/m', 'impulse on a box per time and length of border open to centres'),
    'diffusion': (
        'm^2/s',
        'growth of the mean square displacement / 4; none without a warm-up, or where walls are too near',
    ),
    'energy_error': ('1', 'largest change of the kinetic energy, relative'),
}


class Window(NamedTuple):
    """A rectangle away from the walls, m."""

    low: tuple[float, float]
    high: tuple[float, float]

    @property
    def area(self) -> float:
        """m^2."""
        return (self.high[0] - self.low[0]) * (self.high[1] - self.low[1])

    def holds(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return for each of n points whether it is inside, (n,)."""
        (left, bottom), (right, top) = self
        return (x > left) & (x < right) & (y > bottom) & (y < top)


def bulk(scene: Scene) -> Window | None:
    """Return the window of a scene, None where there is no bulk: without walls, or with locked circles."""
    if any(circle.locked for circle in scene.circles):
        return None
    radius = max(circle.radius for circle in scene.circles)
    return inside_walls(scene, MARGIN * radius, LARGEST_MARGIN)


def inside_walls(scene: Scene, margin: float, part: float) -> Window | None:
    """
    Return the box around all walls without its rim; None where walls make no box.

    Parameters
    ----------
    scene : Scene
    margin : float, m
        Width of the rim ...
    part : float
        ... and how much of the shorter side it is at most.

    """
    if not scene.walls:
        return None
    ends = np.array([end for wall in scene.walls for end in (wall.start, wall.end)])
    low, high = ends.min(axis=0), ends.max(axis=0)
    rim = min(margin, part * float((high - low).min()))
    if not rim > 0.0:
        return None
    left, bottom = (low + rim).tolist()
    right, top = (high - rim).tolist()
    return Window((left, bottom), (right, top))


def open_border(scene: Scene) -> float | None:
    """Return the border that centres can touch, m, for equal circles in one upright box; None otherwise."""
    radii = {circle.radius for circle in scene.circles}
    ends = [sorted((wall.start, wall.end)) for wall in scene.walls]
    corners = {end for pair in ends for end in pair}
    if len(radii) != 1 or len(ends) != 4 or len(corners) != 4:
        return None
    if any(len(set(axis)) != 2 for axis in zip(*corners, strict=True)):
        return None
    inset = 2.0 * radii.pop()
    lengths = [math.dist(*pair) for pair in ends]
    diagonal = max(math.dist(a, b) for a in corners for b in corners)
    if max(lengths) >= diagonal:
        return None
    return sum(length - inset for length in lengths)


class Observables:
    """
    What is measured of one simulation, tick by tick, in memory that does not grow.

    Parameters
    ----------
    simulation : Simulation
        At its first instant, with contacts recorded.
    warm_up : float, s
        What happens up to here is not measured.

    """

    def __init__(self, simulation: Simulation, warm_up: float) -> None:
        scene = simulation.scene
        self._simulation = simulation
        self._warm_up = warm_up
        self._window = bulk(scene)
        self._border = open_border(scene)
        self._radius_of = np.array([circle.radius for circle in scene.circles])
        self._energy = self._kinetic(simulation.velocities)
        self._energy_error = 0.0
        self._began: float | None = None
        self._now = 0.0
        self._warm_contacts = 0
        self._samples = 0
        self._way = 0.0  # m/s, sum of the mean speeds of all samples
        self._inside = 0.0  # circles, summed over samples
        self._covered = 0.0  # m^2 of circles, summed over samples
        self._warmth = 0.0  # J, kinetic energy inside, summed over samples
        self._kinds = dict.fromkeys(ContactKind, 0)
        self._virial = 0.0
        self._on_walls = 0.0
        self._spreading: Spreading | None = None
        self._largest_step = 0.0

    def _kinetic(self, velocities: NDArray[np.float64]) -> float:
        return 0.5 * float(self._simulation.masses @ np.square(velocities).sum(axis=1))

    def add(self, moment: Moment) -> None:
        """Measure a tick."""
        time = kernel_time(moment.scene_ns)
        state = moment.state
        step, self._now = time - self._now, time
        contacts = state.contacts
        if self._energy:
            error = abs(self._kinetic(state.velocities) / self._energy - 1.0)
            self._energy_error = max(self._energy_error, error)
        if time <= self._warm_up:
            self._warm_contacts += ends_of(contacts['kind'])
            self._began = time
            return
        if self._began is None:
            # Nothing was warmed up: the contacts of this very interval belong to the measurement.
            self._began = 0.0
        if self._spreading is None:
            self._spreading = self._start_spreading(step, state.positions)
        self._count(contacts)
        self._sample(state.positions, state.velocities)

    def _start_spreading(self, step: float, positions: NDArray[np.float64]) -> Spreading:
        began = self._began or 0.0
        free = began * len(positions) / self._warm_contacts if self._warm_contacts else math.inf
        deep = inside_walls(self._simulation.scene, math.inf, DEEP)
        if deep is None:
            return Spreading(step, free)
        # The rim is DEEP of the shorter side, and the window what two of it leave.
        shorter = min(high - low for low, high in zip(*deep, strict=True)) / (1.0 - 2.0 * DEEP)
        return Spreading(step, free, deep, DEEP * shorter)

    def _count(self, contacts: NDArray[np.void]) -> None:
        for kind in ContactKind:
            self._kinds[kind] += int((contacts['kind'] == kind).sum())
        walls = contacts['kind'] >= ContactKind.WALL
        self._on_walls += float(contacts['impulse'][walls].sum())
        if self._window:
            pairs = contacts[contacts['kind'] == ContactKind.CIRCLE]
            pairs = pairs[self._window.holds(pairs['x'], pairs['y'])]
            apart = self._radius_of[pairs['a']] + self._radius_of[pairs['b']]
            self._virial += float((apart * pairs['impulse']).sum())

    def _sample(self, positions: NDArray[np.float64], velocities: NDArray[np.float64]) -> None:
        self._samples += 1
        self._way += float(np.hypot(velocities[:, 0], velocities[:, 1]).mean())
        assert self._spreading is not None
        self._spreading.add(positions)
        if self._window:
            inside = self._window.holds(positions[:, 0], positions[:, 1])
            self._inside += float(inside.sum())
            self._covered += math.pi * float(np.square(self._simulation.radii[inside]).sum())
            squares = np.square(velocities[inside]).sum(axis=1)
            self._warmth += 0.5 * float(self._simulation.masses[inside] @ squares)

    def row(self) -> dict[str, Any]:
        """Return the row: numbers by the names of `COLUMNS`, None for what this scene does not say."""
        count = len(self._simulation.ids)
        measured = self._now - (self._began or 0.0)
        row: dict[str, Any] = dict.fromkeys(COLUMNS)
        row |= {'measured': measured, 'circles': count, 'energy_error': self._energy_error}
        row['temperature'] = self._energy / count
        if not self._samples or not measured > 0.0:
            return row
        total = sum(self._kinds.values())
        pairs = self._kinds[ContactKind.CIRCLE]
        ends = total + pairs
        row |= {'contacts': total, 'pair_contacts': pairs}
        row['contact_rate'] = ends / (count * measured)
        if ends:
            row['mean_free_path'] = self._way / self._samples * measured * count / ends
        if self._border:
            row['pressure_walls'] = self._on_walls / (measured * self._border)
        if self._window and self._inside:
            kinetic = self._warmth / self._samples
            all_of_it = kinetic + 0.5 * self._virial / measured
            row['packing'] = self._covered / self._samples / self._window.area
            row['pressure'] = all_of_it / self._window.area
            row['compressibility'] = all_of_it / kinetic if kinetic else None
        if self._spreading:
            row['diffusion'] = self._spreading.coefficient
        return row


def ends_of(kinds: NDArray[np.uint8]) -> int:
    """Return how many circles' contacts these are: two of each pair of moving ones."""
    return len(kinds) + int((kinds == ContactKind.CIRCLE).sum())


class Spreading:
    """
    The mean square displacement at two lags, whose difference is 4 D times the time between.

    Parameters
    ----------
    step : float, s
        Between two samples.
    free : float, s
        Mean free time, which sets the lags; `inf` for unknown.
    window : Window, optional
        Where a way has to begin, to be far from walls.
    rim : float, m
        How far that is from them; `inf` without walls.

    """

    def __init__(
        self, step: float, free: float, window: Window | None = None, rim: float = math.inf
    ) -> None:
        self._step = step
        self._known = math.isfinite(free)
        self._lags = [max(k + 1, round(lag * free / step)) if self._known else k + 1
                      for k, lag in enumerate(LAGS)]  # fmt: skip
        self._lags[1] = max(self._lags[1], self._lags[0] + 1)
        self._window = window
        self._rim = rim
        self._age = 0
        self._origin: NDArray[np.float64] | None = None
        self._from_inside: NDArray[np.bool_] | slice = slice(None)
        self._squares = [0.0, 0.0]
        self._ways = [0, 0]

    def add(self, positions: NDArray[np.float64]) -> None:
        """Add a sample, (n, 2), m."""
        if self._origin is None:
            self._begin(positions)
            return
        self._age += 1
        if self._age in self._lags:
            which = self._lags.index(self._age)
            moved = np.square(positions - self._origin).sum(axis=1)[self._from_inside]
            self._squares[which] += float(moved.sum())
            self._ways[which] += len(moved)
            if which == 1:
                self._begin(positions)

    def _begin(self, positions: NDArray[np.float64]) -> None:
        self._origin, self._age = positions, 0
        if self._window:
            self._from_inside = self._window.holds(positions[:, 0], positions[:, 1])

    @property
    def coefficient(self) -> float | None:
        """The diffusion coefficient, m^2/s; None while nothing can be said."""
        if not self._known or not all(self._ways):
            return None
        early, late = (s / n for s, n in zip(self._squares, self._ways, strict=True))
        if DEVIATIONS * math.sqrt(late / 2.0) > self._rim:
            return None
        return (late - early) / (4.0 * self._step * (self._lags[1] - self._lags[0]))
