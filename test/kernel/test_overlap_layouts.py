"""The search for overlaps in odd layouts: it finds what all pairs have, and looks at few of them."""

import numpy as np
import pytest

from circle_bounce_ros.kernel import Circle, Scene, Simulation, candidates
from circle_bounce_ros.kernel.overlap import (
    ENOUGH,
    Bodies,
    circle_candidates,
    deepest,
    wall_candidates,
)

NO_WALLS = np.zeros((0, 4))


def lattice(rng, count):
    """Return places one apart from each other in a square, and radii that do not reach that far."""
    width = int(np.ceil(np.sqrt(count)))
    places = np.stack(np.divmod(np.arange(count), width), axis=1) + 0.5
    return places, rng.uniform(0.1, 0.49, count)


def column(rng, count):
    return np.stack((np.zeros(count), np.arange(count)), axis=1), rng.uniform(0.1, 0.49, count)


def row(rng, count):
    places, radii = column(rng, count)
    return places[:, ::-1] - 7.0, radii


def giant_among_dust(rng, count):
    places, radii = lattice(rng, count)
    places[0], radii[0] = (-1e6, 0.0), 1e6 - 1.0
    return places, radii / 3.0


def clusters_far_apart(rng, count):
    places, radii = lattice(rng, count)
    places[count // 2 :] += 1e12
    return places, radii


def sizes_of_all_kinds(rng, count):
    """Return circles on a line, each of them in a size of its own; each begins where the last one ended."""
    radii = 10.0 ** rng.uniform(-4.0, 4.0, count)
    ends = np.cumsum(2.001 * radii)
    return np.stack((ends - radii, np.zeros(count)), axis=1), radii * 0.999


LAYOUTS = [lattice, column, row, giant_among_dust, clusters_far_apart, sizes_of_all_kinds]


def bodies_of(layout, rng, count, *, locked=0.3, walls=NO_WALLS, collide=True):
    places, radii = layout(rng, count)
    order = rng.permutation(count)
    return Bodies(places[order], radii[order], rng.random(count) < locked, walls, collide)


def depths(bodies):
    """Return the depth of all pairs of circles, minus infinity where they do not count."""
    dx, dy = (bodies.positions[:, None, axis] - bodies.positions[None, :, axis] for axis in (0, 1))
    depth = bodies.radii[:, None] + bodies.radii - np.hypot(dx, dy)
    moves = ~bodies.locked
    count = moves[:, None] | moves if bodies.moving_circles_collide else moves[:, None] ^ moves
    return np.where(np.triu(count, 1), depth, -np.inf)


@pytest.mark.parametrize('collide', [True, False])
@pytest.mark.parametrize('layout', LAYOUTS)
def test_every_overlap_is_among_the_candidates(layout, collide):
    for seed in range(12):
        rng = np.random.default_rng(seed)
        bodies = bodies_of(layout, rng, 120, collide=collide)
        # Some of them grow until they overlap: from none at all to most.
        bodies.radii[rng.random(120) < seed / 12.0] *= 3.0
        found = set()
        for i, j in circle_candidates(bodies):
            pairs = [tuple(sorted(pair)) for pair in zip(i.tolist(), j.tolist(), strict=True)]
            assert len(set(pairs)) == len(pairs)
            assert found.isdisjoint(pairs)
            found.update(pairs)
        depth = depths(bodies)
        assert found >= set(zip(*(k.tolist() for k in np.nonzero(depth > 0.0)), strict=True))
        assert all(depth[pair] > -np.inf for pair in found)
        deep = deepest(bodies)
        assert (deep.depth > 0.0) == (depth.max() > 0.0)
        if deep.depth > 0.0:
            assert deep.depth == depth.max() == depth[deep.a, deep.b]


@pytest.mark.parametrize('collide', [True, False])
@pytest.mark.parametrize('layout', LAYOUTS)
def test_the_candidates_grow_with_the_number_of_circles(layout, collide):
    count = 4000
    bodies = bodies_of(layout, np.random.default_rng(1), count, collide=collide)
    looked_at = sum(len(i) for i, _ in circle_candidates(bodies))
    # Radii from a fifth of the largest on: four classes, with 9 cells to look at in each.
    assert looked_at < 40 * count


def test_locked_circles_at_one_place_are_no_candidates():
    bodies = bodies_of(lattice, np.random.default_rng(1), 5000, locked=1.0)
    bodies.positions[:] = 0.0
    assert list(circle_candidates(bodies)) == []
    bodies.locked[7] = False
    assert sum(len(i) for i, _ in circle_candidates(bodies)) < 5000


@pytest.mark.filterwarnings('error')
def test_circles_at_one_place_pass_through_each_other():
    bodies = bodies_of(lattice, np.random.default_rng(1), 5000, locked=0.0, collide=False)
    bodies.positions[:] = 0.0
    assert deepest(bodies) == (-np.inf, -np.inf, -1, -1, False)
    circles = [Circle((1.0, 1.0), (k, 0.0), radius=0.1) for k in range(5000)]
    simulation = Simulation(Scene(circles, moving_circles_collide=False))
    simulation.advance_to(0.5)
    assert simulation.positions[:, 0].tolist() == [1.0 + 0.5 * k for k in range(5000)]


def test_the_search_ends_where_very_many_overlap(monkeypatch):
    monkeypatch.setattr(candidates, 'PIECE', 1 << 16)
    bodies = bodies_of(lattice, np.random.default_rng(1), 5000, locked=0.0)
    bodies.positions[:] = 0.0
    looked_at = []

    def counted(asked):
        for pairs in circle_candidates(asked):
            looked_at.append(len(pairs[0]))
            yield pairs

    monkeypatch.setattr('circle_bounce_ros.kernel.overlap.circle_candidates', counted)
    assert deepest(bodies).depth > 0.0
    assert ENOUGH < sum(looked_at) <= ENOUGH + (1 << 16)


# walls


def many_walls(rng, count, size):
    """Return short and long walls in several directions, some of them upright or level."""
    start = rng.uniform(0.0, size, (count, 2))
    angle = rng.choice([0.0, np.pi / 2.0, 0.3, 2.0, 4.0], count)
    along = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    return np.hstack((start, start + along * rng.choice([1e-3, 1.0, size], (count, 1))))


def away(places, wall):
    """Return how far places are from a wall: complex numbers, turned so that it lies along +x."""
    start, end = complex(*wall[:2]), complex(*wall[2:])
    turned = (places[:, 0] + 1j * places[:, 1] - start) * abs(end - start) / (end - start)
    beyond = np.maximum(np.maximum(-turned.real, turned.real - abs(end - start)), 0.0)
    return np.hypot(beyond, turned.imag)


@pytest.mark.parametrize('few', [0, candidates.FEW])
@pytest.mark.parametrize('layout', LAYOUTS)
def test_the_deepest_of_all_walls_is_found(layout, few, monkeypatch):
    monkeypatch.setattr(candidates, 'FEW', few)
    monkeypatch.setattr(candidates, 'PIECE', 64)
    for seed in range(6):
        rng = np.random.default_rng(seed)
        bodies = bodies_of(layout, rng, 100, walls=many_walls(rng, 40, 12.0), collide=False)
        bodies.locked[:] = False
        bodies.radii[:] *= 10.0 ** -float(rng.integers(0, 4))
        depth = np.stack(
            [bodies.radii - away(bodies.positions, wall) for wall in bodies.walls], axis=1
        )
        expected = float(depth.max())
        found = deepest(bodies).depth
        # Coordinates are up to 1e12 m in one layout: a few of their roundings, 1e-4 m.
        close = 8 * np.spacing(np.abs(bodies.positions).max() + bodies.radii.max())
        assert found == pytest.approx(expected, abs=close) or max(found, expected) <= 0.0
        pairs = {pair for k in wall_candidates(bodies) for pair in zip(*map(list, k), strict=True)}
        overlapping = set(zip(*np.nonzero(depth > close), strict=True))
        assert overlapping <= pairs


def test_many_walls_among_many_circles_are_few_candidates(monkeypatch):
    monkeypatch.setattr(candidates, 'FEW', 0)
    rng = np.random.default_rng(1)
    bodies = bodies_of(lattice, rng, 4000, locked=0.0, walls=many_walls(rng, 400, 63.0))
    bodies.walls[:, 2:] = bodies.walls[:, :2] + (bodies.walls[:, 2:] - bodies.walls[:, :2]) / 20.0
    looked_at = sum(len(circle) for circle, _ in wall_candidates(bodies))
    # Of 1,600,000 pairs. Short walls meet a few leaves, each of 8 circles.
    assert 0 < looked_at < 400 * 40
