"""The packaged scenes: fine as they stand, and what their comments say is so."""

import math
from pathlib import Path

import numpy as np
import pytest

from circle_bounce_ros.installation import share_directory
from circle_bounce_ros.kernel import ContactKind, Simulation, deepest_overlap
from circle_bounce_ros.scene_file import load_scene, scene_names

SECONDS = 6.0

OUTLINES = {
    'lesson': [(-2, -1.5), (2, -1.5), (2, 1.5), (-2, 1.5)],
    'pegboard': [
        (-2.4, -0.8),
        (0, -1.8),
        (2.4, -0.8),
        (2, 1.6),
        (1.3, 2.3),
        (-1.3, 2.3),
        (-2, 1.6),
    ],
    'gas': [(-5, -5), (5, -5), (5, 5), (-5, 5)],
    'mixed': [(-4, -3), (4, -3), (4, 3), (-4, 3)],
    'break': [(-1.12, -0.56), (1.12, -0.56), (1.12, 0.56), (-1.12, 0.56)],
    'billiard': [(-1, -1), (1, -1), (1, 1), (-1, 1)],
}


def depth_inside(points, corners):
    """Return how far each point is inside a convex polygon, negative outside."""
    corners = np.array(corners, dtype=float)
    along = np.roll(corners, -1, axis=0) - corners
    inward = np.column_stack((-along[:, 1], along[:, 0])) / np.hypot(*along.T)[:, None]
    return np.einsum('pwk,wk->pw', points[:, None] - corners[None], inward).min(axis=1)


@pytest.mark.parametrize('name', scene_names())
def test_a_packaged_scene_runs_without_overlap_and_nothing_leaves_it(name):
    simulation = Simulation(load_scene(name))
    for time in np.linspace(0.0, SECONDS, 13):
        simulation.advance_to(time)
        # Overlaps are rounding only; the smallest radius is 0.025 m.
        assert deepest_overlap(simulation) < 1e-12
        if name in OUTLINES:
            inside = depth_inside(simulation.positions, OUTLINES[name])
            assert (inside > simulation.radii - 1e-12).all()


def test_every_closed_scene_has_an_outline_here():
    assert set(OUTLINES) == set(scene_names()) - {'digits_of_pi'}


@pytest.mark.parametrize('name', scene_names())
def test_a_packaged_scene_tells_editors_its_schema_and_people_what_it_is(name):
    path = share_directory() / 'config' / 'scenes' / f'{name}.yaml'
    first, *rest = path.read_text(encoding='utf-8').splitlines()
    label = '# yaml-language-server: $schema='
    assert first.startswith(label)
    assert (path.parent / Path(first.removeprefix(label))).resolve().is_file()
    assert sum(line.startswith('# ') for line in rest) >= 3


def test_lesson_has_a_green_circle_that_moves_and_a_red_one_that_is_locked():
    green, red = load_scene('lesson').circles
    assert (green.name, green.locked) == ('green', False)
    assert (red.name, red.locked) == ('red', True)
    assert load_scene('lesson').restart_after == math.inf


def test_lesson_hits_the_red_circle_within_a_second_and_again_and_again():
    simulation = Simulation(load_scene('lesson'), record_contacts=True)
    simulation.advance_to(600.0)
    contacts = simulation.drain_contacts()
    on_red = contacts[contacts['kind'] == ContactKind.LOCKED]
    assert on_red['time'][0] < 1.0
    assert 0.2 < len(on_red) / len(contacts) < 0.5
    assert np.diff(on_red['time']).max() < 30.0
    # Angles of contact all around the red circle: in each of eight sectors.
    sectors = np.floor(np.arctan2(on_red['ny'], on_red['nx']) / (math.pi / 4))
    assert len(set(sectors)) == 8


def test_gas_is_a_thousand_equal_disks_at_packing_0_3():
    scene = load_scene('gas')
    radii = np.array([circle.radius for circle in scene.circles])
    assert len(radii) == 1000
    assert len(set(radii)) == 1
    # Rounding of a sum of a thousand terms.
    assert math.pi * (radii**2).sum() / 100.0 == pytest.approx(0.3, rel=1e-13)


def test_gas_asks_for_fewer_contacts_than_plain_python_carries():
    simulation = Simulation(load_scene('gas'))
    simulation.advance_to(2.0)
    assert 5_000 < simulation.contact_count / 2.0 < 8_000


def test_digits_of_pi_makes_314_contacts_before_it_restarts():
    scene = load_scene('digits_of_pi')
    simulation = Simulation(scene)
    simulation.advance_to(8.0)
    assert simulation.contact_count == 314
    simulation.advance_to(scene.restart_after)
    assert simulation.contact_count == 314
    simulation.advance_to(1e6)
    assert simulation.contact_count == 314


def test_mixed_has_radii_and_masses_two_to_one():
    scene = load_scene('mixed')
    moving = {(circle.radius, circle.mass) for circle in scene.circles if not circle.locked}
    (small, light), (large, heavy) = sorted(moving)
    assert large / small == 2.0
    assert heavy / light == 2.0
    assert any(circle.locked for circle in scene.circles)


def test_break_starts_with_fifteen_balls_that_do_not_touch():
    scene = load_scene('break')
    assert [circle.name for circle in scene.circles] == ['cue'] + 15 * [None]
    positions = np.array([circle.position for circle in scene.circles])
    gaps = np.hypot(*(positions[:, None] - positions[None]).transpose(2, 0, 1))
    np.fill_diagonal(gaps, np.inf)
    radius = scene.circles[0].radius
    assert 1e-4 < gaps.min() - 2.0 * radius < 1e-3
    assert math.isfinite(scene.restart_after)


def test_pegboard_has_balls_pegs_and_walls_at_a_tilt():
    scene = load_scene('pegboard')
    locked = [circle.locked for circle in scene.circles]
    assert locked.count(False) >= 100
    assert locked.count(True) >= 20
    tilted = [w for w in scene.walls if w.start[0] != w.end[0] and w.start[1] != w.end[1]]
    assert len(tilted) >= 6
