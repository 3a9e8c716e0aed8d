"""A row of the summary says what can be worked out by hand, or what theory says of gases and billiards."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from circle_bounce_ros.kernel import ContactKind, Simulation
from circle_bounce_ros.offline import theory
from circle_bounce_ros.offline.run import perform
from circle_bounce_ros.offline.sweep_file import load_plan


@pytest.fixture
def plan_of(tmp_path):
    """Return a function that gives the plan of one run of a scene in a square box, or of a packaged scene."""

    def plan_of(groups=(), side=2.0, seed=1, circles=(), **settings):
        scene = {'walls': [{'box': {'min': [0, 0], 'max': [side, side]}}], 'circles': [*circles]}
        region = {'min': [0, 0], 'max': [side, side]}
        scene['groups'] = [group | {'region': region} for group in groups]
        scene['moving_circles_collide'] = settings.pop('collide', True)
        (tmp_path / 'box.yaml').write_text(json.dumps(scene))
        sweep = {'scene': './box.yaml', 'seeds': [seed]} | settings
        (tmp_path / 'sweep.yaml').write_text(json.dumps(sweep))
        return load_plan(tmp_path / 'sweep.yaml')

    return plan_of


@pytest.fixture
def measure(tmp_path, plan_of):
    """Return a function that gives the row of one run."""

    def measure(*args, **kwargs):
        plan = plan_of(*args, **kwargs)
        (tmp_path / 'plan.json').write_text(plan.dump())
        row = perform(str(tmp_path), plan.digest(), 0)
        assert 'error' not in row, row
        return row

    return measure


def test_a_ball_between_two_walls_has_the_numbers_worked_out_by_hand(measure):
    # 1.8 m from contact to contact at 1 m/s and 2 kg, for 90 s; from the middle, so 50 contacts.
    ball = {'position': [1, 1], 'velocity': [1, 0], 'radius': 0.1, 'mass': 2.0}
    row = measure(circles=[ball], duration=90.0, rate=20.0)
    assert (row['contacts'], row['pair_contacts'], row['circles']) == (50, 0, 1)
    assert row['contact_rate'] == pytest.approx(50 / 90)
    assert row['mean_free_path'] == pytest.approx(1.8)
    assert row['temperature'] == pytest.approx(1.0)  # m v^2 / 2
    # Each contact gives 2 m v = 4 N s, on 4 walls of 1.8 m that its centre can touch.
    assert row['pressure_walls'] == pytest.approx(50 * 4 / 90 / 7.2)
    assert row['energy_error'] < 1e-15
    assert row['measured'] == pytest.approx(90.0)


def test_what_happens_in_the_warm_up_is_not_measured(measure):
    ball = {'position': [1, 1], 'velocity': [1, 0], 'radius': 0.1}
    # Contacts at 0.9, 2.7, 4.5, ... s: three of them in the first 5 s.
    row = measure(circles=[ball], duration=90.0, warm_up=5.0, rate=20.0)
    assert row['contacts'] == 50 - 3
    assert row['measured'] == pytest.approx(85.0)


SMALL_GAS = {'count': 60, 'packing': 0.2, 'speed': {'maxwell': 1.0}}


def test_the_pressure_is_that_of_the_contacts_in_the_window(plan_of, measure):
    options = {'groups': [SMALL_GAS], 'duration': 4.0, 'warm_up': 1.0, 'rate': 20.0}
    row = measure(**options)
    plan = plan_of(**options)
    simulation = Simulation(plan.build(plan.run(0)), record_contacts=True)
    simulation.advance_to(1.0)
    simulation.drain_contacts()
    radius = simulation.radii[0]
    rim = min(10 * radius, 0.5)
    kinetic, inside_count = [], []
    for k in range(21, 81):
        simulation.advance_to(k / 20)
        x, y = simulation.positions.T
        inside = (np.abs(x - 1) < 1 - rim) & (np.abs(y - 1) < 1 - rim)
        kinetic.append(0.5 * np.square(simulation.velocities[inside]).sum())
        inside_count.append(inside.sum())
    log = simulation.drain_contacts()
    pairs = log[log['kind'] == ContactKind.CIRCLE]
    near = (np.abs(pairs['x'] - 1) < 1 - rim) & (np.abs(pairs['y'] - 1) < 1 - rim)
    area = (2 - 2 * rim) ** 2
    # P A = N kT + sum(2 r J) / (2 T)
    expected = (np.mean(kinetic) + radius * pairs['impulse'][near].sum() / 3.0) / area
    assert row['pressure'] == pytest.approx(expected, rel=1e-9)  # roundings
    packing = np.mean(inside_count) * math.pi * radius**2 / area
    assert row['packing'] == pytest.approx(packing, rel=1e-9)


def test_an_ideal_gas_has_the_pressure_n_kt_on_its_walls_and_the_free_path_of_its_box(measure):
    # Circles that pass through each other, 0.1 m: their centres have a box of 9.8 m.
    gas = {'count': 1000, 'radius': 0.1, 'speed': {'maxwell': 1.0}}
    row = measure([gas], side=10.0, collide=False, duration=40.0, rate=10.0)
    assert row['pair_contacts'] == 0
    # 16,000 contacts with the walls, of which each speed comes again: 1 / sqrt(1,000), of equal walls.
    ideal = 1000 * row['temperature'] / 9.8**2
    assert row['pressure_walls'] == pytest.approx(ideal, rel=0.03)
    assert row['pressure'] == pytest.approx(ideal, rel=0.03)
    assert row['compressibility'] == pytest.approx(1.0, abs=1e-12)  # by its definition
    # pi A / P of a square of 9.8 m; the directions of 1,000 circles scatter by 0.5 %.
    assert row['mean_free_path'] == pytest.approx(math.pi * 9.8 / 4.0, rel=0.015)


@pytest.fixture(scope='module')
def gas_row(tmp_path_factory):
    folder = tmp_path_factory.mktemp('gas')
    sweep = {'scene': 'gas', 'seeds': [1], 'duration': 30.0, 'warm_up': 5.0, 'rate': 20.0}
    (folder / 'gas.yaml').write_text(json.dumps(sweep))
    plan = load_plan(folder / 'gas.yaml')
    (folder / 'plan.json').write_text(plan.dump())
    radius = plan.build(plan.run(0)).circles[0].radius
    return perform(str(folder), plan.digest(), 0), radius


def test_a_gas_has_the_pressure_of_the_virial_series(gas_row):
    row, _ = gas_row
    # One run of 25 s in a window scatters by 0.5 %: three times that.
    assert row['compressibility'] == pytest.approx(theory.virial_series(row['packing']), rel=0.015)


def test_a_gas_presses_on_its_walls_as_on_itself(gas_row):
    row, _ = gas_row
    # Mechanical equilibrium; each of both scatters by 0.5 %.
    assert row['pressure_walls'] == pytest.approx(row['pressure'], rel=0.02)


def test_a_gas_has_the_path_and_diffusion_of_enskog(gas_row):
    row, radius = gas_row
    packing, thermal = row['packing'], math.sqrt(row['temperature'])
    # Over the whole box, whose rim has fewer pairs but walls to touch.
    assert row['mean_free_path'] == pytest.approx(theory.mean_free_path(radius, packing), rel=0.05)
    # Enskog's first order is known to be low by up to a tenth at this packing; 300 circles, 60 times.
    diffusion = theory.diffusion(radius, packing, thermal)
    assert 0.95 * diffusion < row['diffusion'] < 1.2 * diffusion


REACH, SIDE, LOCKED = 0.3, 140.0, 4900


@pytest.fixture(scope='module')
def lorentz_rows(tmp_path_factory):
    """Return rows of balls of 1 m/s among locked points, which are 0.0225 to a square of the ball's radius."""
    region = {'min': [0.0, 0.0], 'max': [SIDE, SIDE]}
    point = 1e-3
    scene = {
        'moving_circles_collide': False,
        'walls': [{'box': region}],
        'groups': [
            {'count': LOCKED, 'radius': point, 'locked': True, 'region': region},
            {'count': 2000, 'radius': REACH - point, 'speed': 1.0, 'region': region},
        ],
    }
    folder = tmp_path_factory.mktemp('lorentz')
    (folder / 'lorentz.yaml').write_text(json.dumps(scene))
    sweep = {'scene': './lorentz.yaml', 'duration': 400.0, 'warm_up': 20.0, 'rate': 2.0}
    (folder / 'sweep.yaml').write_text(json.dumps(sweep | {'seeds': {'first': 1, 'count': 4}}))
    plan = load_plan(folder / 'sweep.yaml')
    (folder / 'plan.json').write_text(plan.dump())
    return [perform(str(folder), plan.digest(), number) for number in range(4)]


def test_a_lorentz_gas_has_the_diffusion_of_kinetic_theory(lorentz_rows):
    density = LOCKED / SIDE**2
    boltzmann = 3.0 / (16.0 * density * REACH)
    # Van Leeuwen and Weijland, Physica 36 (1967): its first correction, 10 % here; the next terms are
    # of the size of n a^2, 2 %, and a run scatters by 2 %.
    thin = density * REACH**2
    expected = boltzmann / (1.0 - 4.0 / 3.0 * thin * math.log(thin))
    found = np.mean([row['diffusion'] for row in lorentz_rows])
    assert found == pytest.approx(expected, rel=0.04)


def test_a_lorentz_gas_has_the_free_path_of_points_thrown_at_random(lorentz_rows):
    density = LOCKED / SIDE**2
    among_points = 1.0 / (2.0 * density * REACH)
    # Balls touch points and walls, whose rates add: P / (pi A) for those of the box.
    rate = 1.0 / among_points + 4.0 / (math.pi * (SIDE - 2 * REACH))
    # Points that are too near to each other for a ball to be between hide each other: their areas n pi a^2
    # overlap as by chance, which makes the border smaller by as much as the free area, 1 % left.
    found = np.mean([row['mean_free_path'] for row in lorentz_rows])
    assert found == pytest.approx(1.0 / rate, rel=0.02)


def test_no_diffusion_is_claimed_where_walls_turn_circles_back_or_nothing_was_warmed_up(measure):
    thin = {'count': 20, 'radius': 0.01, 'speed': {'maxwell': 1.0}}
    assert measure([thin], duration=50.0, warm_up=5.0, rate=20.0)['diffusion'] is None
    dense = {'count': 1000, 'packing': 0.3, 'speed': {'maxwell': 1.0}}
    options = {'groups': [dense], 'side': 10.0, 'rate': 20.0, 'duration': 4.0}
    assert measure(**options)['diffusion'] is None
    assert measure(warm_up=1.0, **options)['diffusion'] > 0.0


def test_the_virial_coefficients_that_have_a_closed_form_have_its_value():
    # Of disks: Tonks 1936 for the third, Rowlinson 1964 and Hemmer 1965 for the fourth.
    third = 4.0 / 3.0 - math.sqrt(3.0) / math.pi
    fourth = 2.0 - 9.0 * math.sqrt(3.0) / (2.0 * math.pi) + 10.0 / math.pi**2
    assert theory.VIRIAL[:2] == (1.0, pytest.approx(third, abs=5e-9))  # half of the last digit
    assert theory.VIRIAL[2] == pytest.approx(fourth, abs=5e-9)
    assert len(theory.VIRIAL) == 9


def test_the_virial_coefficients_are_those_of_the_source():
    # Table 1 of Clisby and McCoy 2006, two dimensions, as it is printed: errors of the last digits in brackets.
    printed = (
        '0.782004... 0.53223180... 0.33355604(1) 0.1988425(42) 0.1148728(43) 0.0649930(34) '
        '0.0362193(35) 0.0199537(80)'
    )
    for coefficient, text in zip(theory.VIRIAL[1:], printed.split(), strict=True):
        digits = text.rstrip('.').partition('(')[0]
        last = 10.0 ** -len(digits.removeprefix('0.'))
        assert coefficient == pytest.approx(float(digits), abs=last), text


def test_the_resummed_series_is_the_series_where_that_converges_quickly():
    for packing in (0.001, 0.01, 0.05):
        terms = [b * (2.0 * packing) ** n for n, b in enumerate(theory.VIRIAL, start=1)]
        # The first term left out is of tenth order, its coefficient near to one.
        assert theory.virial_series(packing) == pytest.approx(
            1.0 + sum(terms), rel=(2.0 * packing) ** 10 + 1e-15
        )


def test_hendersons_formula_is_as_good_as_it_says():
    # Its second coefficient is exact, its third one 25 / 32 of 0.78200.
    slope = (theory.compressibility(1e-6) - 1.0) / 1e-6
    assert slope == pytest.approx(2.0, rel=1e-5)
    for packing, error in ((0.3, 5e-4), (0.4, 2e-3), (0.5, 6e-3), (0.6, 1.3e-2)):
        series = theory.virial_series(packing)
        assert theory.compressibility(packing) == pytest.approx(series, rel=error)
