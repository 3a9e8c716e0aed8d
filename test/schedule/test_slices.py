"""Work in slices: it blocks nobody for long, whatever the scene."""

import pytest

from circle_bounce_ros.kernel import Circle, EndlessContactsError, Scene, Simulation, Wall
from circle_bounce_ros.schedule import slices


def rattling(speed, clearance=1e-9):
    """Return a circle in a slot that is hardly wider, with `speed / clearance` contacts a second."""
    height = 0.2 + clearance
    walls = [Wall((-5.0, y), (5.0, y)) for y in (0.0, height)]
    return Simulation(Scene([Circle((0.0, height / 2), (speed, speed), radius=0.1)], walls))


def test_work_that_is_cut_short_ends_at_a_whole_nanosecond():
    simulation = rattling(speed=1.0)
    reached = slices.advance(simulation, 1_000_000, lambda: False)
    assert 0 < reached < 1_000_000
    assert simulation.time == reached / 1e9


def test_too_much_work_within_a_nanosecond_is_an_error_and_never_a_hang(monkeypatch):
    monkeypatch.setattr(slices, 'MOST_STEPS_A_NANOSECOND', 1_000)
    simulation = rattling(speed=1e4)  # 10,000 contacts a nanosecond
    with pytest.raises(EndlessContactsError, match='within a nanosecond'):
        slices.advance(simulation, 1_000_000, lambda: False)
    assert 1_000 < simulation.contact_count < 2_000
    assert 0.0 < simulation.time < 1e-9
