"""The pictures: each function returns a figure, and the numbers that it shows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from circle_bounce_ros.kernel import ContactKind, Scene
from circle_bounce_ros.offline import theory
from circle_bounce_ros.offline.observables import Window, bulk, open_border
from circle_bounce_ros.offline.sources import Source, SourceError
from circle_bounce_ros.offline.style import (
    BLUE,
    CYCLE,
    HELP,
    INK,
    LOCKED,
    LOCKED_FILL,
    MOVING,
    MOVING_FILL,
    ORANGE,
    WALL,
    canvas,
    title,
)

Picture = tuple[Figure, dict[str, float]]

# Paths of more circles than this hide each other.
MOST_PATHS = 6
TALLEST = 1.0  # height by width of a picture of the plane

SPEED_BINS = 30
FASTEST = 4.0  # thermal speeds
# Speeds of the same circle so many contacts apart are taken as independent.
CONTACTS_APART = 3.0

TIME_BINS = 20

# 95 % of Student's t lie within plus and minus so much, for 1, 2, ... degrees of freedom.
STUDENT = (
    12.71,
    4.30,
    3.18,
    2.78,
    2.57,
    2.45,
    2.36,
    2.31,
    2.26,
    2.23,
    2.20,
    2.18,
    2.16,
    2.14,
    2.13,
)


def view_of(source: Source) -> Window:
    """Return what is to be seen of the plane: everything that stands still, else where circles begin."""
    scene = source.scene
    spots = [end for wall in scene.walls for end in (wall.start, wall.end)]
    still = [c for c in scene.circles if c.locked]
    around = still if spots else list(scene.circles)
    for circle in around:
        for sign in (-1.0, 1.0):
            spots.append(
                (
                    circle.position[0] + sign * circle.radius,
                    circle.position[1] + sign * circle.radius,
                )
            )
    if not scene.walls or np.ptp(np.array(spots), axis=0).min() == 0.0:
        # Nothing keeps the circles in: show where they go.
        radii = np.array([[circle.radius] for circle in source.moving])
        for frame in source.frames():
            spots.append(tuple((frame.positions - radii).min(axis=0)))
            spots.append(tuple((frame.positions + radii).max(axis=0)))
    low, high = np.array(spots).min(axis=0), np.array(spots).max(axis=0)
    rim = 0.02 * float((high - low).max())
    left, bottom = (low - rim).tolist()
    right, top = (high + rim).tolist()
    return Window((left, bottom), (right, top))


def trajectories(source: Source) -> Picture:
    """Draw the ways of a few circles over everything that stands still."""
    view = view_of(source)
    width, height = (high - low for low, high in zip(*view, strict=True))
    figure, axes = canvas(max(2.5, 8.0 * min(TALLEST, height / width)) + 0.5)
    draw_still(axes, source.scene)
    count = len(source.moving)
    # Spread over the scene, and always the same.
    chosen = np.unique(np.linspace(0, count - 1, min(MOST_PATHS, count)).round().astype(int))
    ways: list[NDArray[np.float64]] = []
    contacts, end = 0, 0.0
    last = None
    for frame in source.frames():
        ways.append(frame.positions[chosen])
        contacts += len(frame.contacts)
        end, last = frame.time, frame.positions
    if last is None or len(ways) < 2:
        raise SourceError(f'{source.name}: must have at least two instants, got {len(ways)}')
    radii = np.array([circle.radius for circle in source.moving])
    rest = np.setdiff1d(np.arange(count), chosen)
    draw_circles(axes, last[rest], radii[rest], '#F4F4F4', '#C8C8C8')
    draw_circles(axes, last[chosen], radii[chosen], MOVING_FILL, MOVING)
    path = np.array(ways)
    for k in range(len(chosen)):
        color = CYCLE[k % len(CYCLE)]
        axes.plot(path[:, k, 0], path[:, k, 1], color=color, linewidth=1.4, zorder=3)
        axes.plot(*path[0, k], 'o', color=color, markersize=4.0, zorder=4)
    plane(axes, view)
    some = f'the ways of {len(chosen)} of {count} circles' if len(chosen) < count else 'all ways'
    title(axes, f'{source.name}: {some} in {end:.4g} s (dots: where they begin)')
    return figure, {'circles': count, 'paths': len(chosen), 'duration': end, 'contacts': contacts}


def plane(axes: Axes, view: Window) -> None:
    """Make a panel a piece of the plane, metres alike in x and y."""
    axes.set_xlim(view.low[0], view.high[0])
    axes.set_ylim(view.low[1], view.high[1])
    axes.set_aspect('equal')
    axes.set_xlabel('x / m')
    axes.set_ylabel('y / m')


def draw_still(axes: Axes, scene: Scene) -> None:
    """Draw walls and locked circles."""
    for wall in scene.walls:
        (x1, y1), (x2, y2) = wall.start, wall.end
        axes.plot([x1, x2], [y1, y2], color=WALL, linewidth=2.5, solid_capstyle='round', zorder=2)
    locked = [circle for circle in scene.circles if circle.locked]
    if locked:
        spots = np.array([circle.position for circle in locked])
        radii = np.array([circle.radius for circle in locked])
        draw_circles(axes, spots, radii, LOCKED_FILL, LOCKED, hatch='////')


def draw_circles(
    axes: Axes,
    spots: NDArray[np.float64],
    radii: NDArray[np.float64],
    fill: str,
    border: str,
    **options: Any,
) -> None:
    """Draw many circles at once: positions (n, 2), m, and radii (n,), m."""
    axes.add_collection(
        EllipseCollection(
            2.0 * radii,
            2.0 * radii,
            np.zeros(len(radii)),
            units='xy',
            offsets=spots,
            offset_transform=axes.transData,
            facecolors=fill,
            edgecolors=border,
            linewidths=0.7,
            zorder=1.5,
            **options,
        )
    )


def speeds(source: Source) -> Picture:
    """Draw how often a speed occurs, with Maxwell's law in two dimensions beside it."""
    if not source.masses_known:
        raise_equal_radii(source, 'speeds')
    masses = source.masses
    edges = np.linspace(0.0, FASTEST, SPEED_BINS + 1)
    counts = np.zeros(SPEED_BINS)
    looks, ends, total, fast = 0, 0, 0.0, 0
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
            fast += int((scaled >= FASTEST).sum())
            looks, total = looks + 1, total + float(scaled.sum())
        ends += ends_of(frame.contacts)
        end = frame.time
    assert thermal is not None
    if not looks:
        raise SourceError(f'{source.name}: must have at least two instants, got one')
    sampled = looks * len(masses)
    independent = min(float(sampled), max(len(masses), ends / CONTACTS_APART))
    width = edges[1]
    height = counts / sampled / width
    error = np.sqrt(counts / sampled * (1.0 - counts / sampled) / independent) / width
    figure, axes = canvas(4.2)
    middle = (edges[1:] + edges[:-1]) / 2.0
    axes.bar(middle, height, 0.92 * width, color=MOVING_FILL, edgecolor=MOVING, linewidth=0.8)
    axes.errorbar(middle, height, error, fmt='none', ecolor=MOVING, elinewidth=1.2)
    u = np.linspace(0.0, FASTEST, 400)
    axes.plot(u, u * np.exp(-(u**2) / 2.0), color=INK, linewidth=2.0)
    axes.annotate(
        "Maxwell's law\n$u\\,e^{-u^2/2}$", (1.9, 1.9 * math.exp(-1.805)), (2.4, 0.45),
        arrowprops={'arrowstyle': '-', 'color': HELP},
    )  # fmt: skip
    axes.set_xlabel(r'speed $u = v / \sqrt{kT / m}$')
    axes.set_ylabel('probability density')
    axes.set_xlim(0.0, FASTEST)
    title(axes, f'{source.name}: speeds of {len(masses)} circles over {end:.4g} s')
    mean, maxwell = total / sampled, math.sqrt(math.pi / 2.0)
    return figure, {'mean speed': mean, 'Maxwell': maxwell, 'samples': sampled}


def raise_equal_radii(source: Source, picture: str) -> None:
    """
    Make sure that circles of unknown mass may be taken as equal.

    Raises
    ------
    SourceError
        When their radii differ, so that their masses may too.

    """
    if len({circle.radius for circle in source.moving}) > 1:
        raise SourceError(
            f'{source.name}: {picture} needs the masses, which a bag of the node does not say; '
            'bounce_record writes them beside its bags'
        )


def ends_of(contacts: NDArray[np.void]) -> int:
    """Return how many circles' contacts these are: two of each pair of moving ones."""
    return len(contacts) + int((contacts['kind'] == ContactKind.CIRCLE).sum())


def free_path(source: Source) -> Picture:
    """Draw mean free path and contact rate over time, with the theory where there is one."""
    window = bulk(source.scene) if source.scene.moving_circles_collide else None
    alike = len({(circle.radius, circle.mass) for circle in source.moving}) == 1
    gas = window if alike and len(source.moving) > 1 else None
    times, ends, inside, ways = [], [], [], []
    for frame in source.frames():
        held = (
            gas.holds(frame.positions[:, 0], frame.positions[:, 1])
            if gas
            else np.ones(len(frame.positions), bool)
        )
        times.append(frame.time)
        inside.append(int(held.sum()))
        ways.append(float(np.hypot(*frame.velocities.T)[held].sum()))
        ends.append(_ends_in(frame.contacts, gas))
    if len(times) < 2 or not sum(ends):
        raise SourceError(f'{source.name}: must have contacts, got none (is the topic recorded?)')
    numbers, expected = _theory_of(source, gas, inside, ways)
    time, step = np.array(times), np.diff(times)
    parts = np.array_split(np.arange(len(step)), min(TIME_BINS, len(step)))
    centre = np.array([time[part + 1].mean() for part in parts])
    hits = np.array([np.array(ends)[part + 1].sum() for part in parts], float)
    circle_time = np.array([(np.array(inside)[part + 1] * step[part]).sum() for part in parts])
    way = np.array([(np.array(ways)[part + 1] * step[part]).sum() for part in parts])
    figure, (left, right) = canvas(3.9, columns=2)
    # Pairs come with both ends at once: as many independent counts as pairs.
    doubling = 2.0 if gas else 1.0
    relative = np.sqrt(doubling / np.maximum(hits, 1.0))
    seen = hits > 0
    rate = hits[seen] / circle_time[seen]
    path = way[seen] / hits[seen]
    for axes, values, error in (
        (left, path, path * relative[seen]),
        (right, rate, rate * relative[seen]),
    ):
        axes.errorbar(
            centre[seen], values, error, fmt='o', color=MOVING, markersize=4.5, elinewidth=1.2,
            label='measured',
        )  # fmt: skip
        axes.set_xlabel('time / s')
        axes.set_xlim(0.0, time[-1])
    numbers['mean free path'] = float(way.sum() / hits.sum())
    numbers['contact rate'] = float(hits.sum() / circle_time.sum())
    if expected:
        left.axhline(numbers['theory path'], color=INK, linewidth=1.8, label=expected[0])
        right.axhline(numbers['theory rate'], color=INK, linewidth=1.8, label=expected[1])
    for axes, values in ((left, path), (right, rate)):
        axes.set_ylim(0.0, 1.6 * float(values.max()))
        axes.legend(loc='upper right', fontsize=10.0)
    title(left, f'{source.name}: mean free path / m')
    title(right, 'contacts of a circle, per second')
    return figure, numbers


def _ends_in(contacts: NDArray[np.void], gas: Window | None) -> int:
    if not gas:
        return ends_of(contacts)
    pairs = contacts[contacts['kind'] == ContactKind.CIRCLE]
    return 2 * int(gas.holds(pairs['x'], pairs['y']).sum())


def _theory_of(
    source: Source, gas: Window | None, inside: Sequence[int], ways: Sequence[float]
) -> tuple[dict[str, float], tuple[str, str] | None]:
    """Return what is expected, by name, and how to call it; None where there is no closed form."""
    scene, moving = source.scene, source.moving
    if gas:
        radius = moving[0].radius
        packing = float(np.mean(inside)) * math.pi * radius**2 / gas.area
        squares = np.square([circle.velocity for circle in moving]).sum(axis=1)
        thermal = math.sqrt(float(squares.mean()) / 2.0)
        path = theory.mean_free_path(radius, packing)
        rate = theory.contact_rate(radius, packing, thermal)
        return {'packing': packing, 'theory path': path, 'theory rate': rate}, (
            'Enskog, ' + r'$1 / (2\sqrt{2}\, n d \chi)$',
            'Enskog, ' + r'$2 n d \chi \sqrt{\pi kT / m}$',
        )
    billiard = billiard_of(scene)
    if not billiard:
        return {}, None
    area, border = billiard
    path = theory.billiard_free_path(area, border)
    speed = float(np.mean(ways)) / len(moving)
    return {'area': area, 'border': border, 'theory path': path, 'theory rate': speed / path}, (
        r'$\pi A / P$',
        r'$v P / (\pi A)$',
    )


def billiard_of(scene: Scene) -> tuple[float, float] | None:
    """
    Return the area open to centres and its border, for equal circles alone in one upright box.

    None where locked circles reach into each other's or a wall's reach: there is no closed form.
    """
    moving = [circle for circle in scene.circles if not circle.locked]
    if len({circle.radius for circle in moving}) != 1:
        return None
    if scene.moving_circles_collide and len(moving) > 1:
        return None
    radius = moving[0].radius
    around = open_border(Scene(moving, scene.walls, moving_circles_collide=False))
    if around is None:
        return None
    ends = np.array([end for wall in scene.walls for end in (wall.start, wall.end)])
    low, high = ends.min(axis=0) + radius, ends.max(axis=0) - radius
    locked = [circle for circle in scene.circles if circle.locked]
    reach = np.array([circle.radius + radius for circle in locked])
    spots = np.array([circle.position for circle in locked]).reshape(-1, 2)
    for k, spot in enumerate(spots):
        apart = np.hypot(*(spots[:k] - spot).T) if k else np.zeros(0)
        if (apart < reach[:k] + reach[k]).any():
            return None
        if (spot - reach[k] < low).any() or (spot + reach[k] > high).any():
            return None
    area = float(np.prod(high - low)) - math.pi * float(np.square(reach).sum())
    return area, around + 2.0 * math.pi * float(reach.sum())


def energy(source: Source) -> Picture:
    """Draw how far the kinetic energy is from where it began."""
    if not source.masses_known:
        raise_equal_radii(source, 'energy')
    masses = source.masses
    times, energies, contacts, seen = [], [], [], 0
    for frame in source.frames():
        times.append(frame.time)
        terms = masses * np.square(frame.velocities).sum(axis=1)
        energies.append(0.5 * math.fsum(terms))
        seen += len(frame.contacts)
        contacts.append(seen)
    if not energies or not energies[0] > 0.0:
        raise SourceError(f'{source.name}: nothing moves')
    error = np.array(energies) / energies[0] - 1.0
    figure, axes = canvas(3.9)
    axes.axhspan(-source.digits, source.digits, color='#EDEDED', zorder=0)
    axes.plot(times, error, color=MOVING, linewidth=1.4)
    limit = 1.25 * max(float(np.abs(error).max()), source.digits)
    axes.set_ylim(-limit, limit)
    axes.set_xlim(0.0, times[-1])
    axes.set_xlabel('time / s')
    axes.set_ylabel(r'$E(t) / E(0) - 1$')
    axes.text(
        0.99, 0.03, f'grey: one rounding of one number, {source.digits:.1e}', ha='right',
        color=HELP, transform=axes.transAxes, fontsize=10.0,
    )  # fmt: skip
    title(axes, f'{source.name}: change of the kinetic energy, {seen:,} contacts')
    largest = float(np.abs(error).max())
    return figure, {'largest': largest, 'contacts': seen, 'duration': times[-1]}


def pressure(name: str, packing: NDArray[np.float64], found: NDArray[np.float64]) -> Picture:
    """
    Draw the compressibility of hard disks against the packing fraction, with the theory.

    Parameters
    ----------
    name : str
    packing, found : (k, s) float
        Packing fraction and Z of s runs at each of k settings.

    """
    if packing.shape[1] < 2:
        raise SourceError(f'{name}: must have at least 2 seeds for error bars, got 1')
    # Run by run, because a run that happens to be a little denser also has a higher pressure.
    exact = np.vectorize(theory.virial_series)(packing)
    henderson = np.vectorize(theory.compressibility)(packing)
    x = packing.mean(axis=1)
    apart = found / exact - 1.0
    runs = packing.shape[1]
    student = STUDENT[min(runs - 1, len(STUDENT)) - 1]
    off = apart.mean(axis=1)
    error = student * apart.std(axis=1, ddof=1) / math.sqrt(runs)
    figure, (top, low) = canvas(6.2, rows=2, sharex=True, height_ratios=[2.2, 1.0])
    phi = np.linspace(0.0, 1.08 * float(x.max()), 300)
    top.plot(phi, [theory.virial_series(p) for p in phi], color=INK, linewidth=1.8,
             label='ten virial coefficients, Padé')  # fmt: skip
    top.plot(phi, [theory.compressibility(p) for p in phi], color=ORANGE, linewidth=1.8,
             linestyle=(0, (5, 3)), label=r'Henderson, $1 + 2\varphi\chi$')  # fmt: skip
    top.plot(x, found.mean(axis=1), 'o', color=BLUE, markersize=6.0,
             label=f'measured, {runs} seeds each')  # fmt: skip
    top.set_ylabel(r'$Z = P / (n\,kT)$')
    top.legend(loc='upper left')
    low.axhline(0.0, color=INK, linewidth=1.8)
    low.plot(
        x, 100.0 * (henderson / exact - 1.0).mean(axis=1), color=ORANGE, linewidth=1.8,
        linestyle=(0, (5, 3)),
    )  # fmt: skip
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
