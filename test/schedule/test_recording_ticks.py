"""The ticks of a recording: their instants and stamps."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise

import pytest

from circle_bounce_ros.schedule.recording import RecordingTicks

SECOND = 10**9


@pytest.mark.parametrize('rate', [0.1, 29.97, 60.0, 999.0, 1e3 / 3])
@pytest.mark.parametrize('restart', [math.inf, 1.0, 0.37])
def test_ticks_are_whole_periods_rounded_down_and_scene_time_never_leaves_the_scene(rate, restart):
    ticks = list(RecordingTicks(rate, 30.0, restart))
    exact = Fraction(repr(rate))
    assert [t.stamp_ns for t in ticks] == [
        math.floor(k * SECOND / exact) for k in range(1, math.floor(30 * exact) + 1)
    ]
    if restart == math.inf:
        assert [t.scene_ns for t in ticks] == [t.stamp_ns for t in ticks]
    else:
        assert max(t.scene_ns for t in ticks) == restart * SECOND
        after = [b.scene_ns for a, b in pairwise(ticks) if a.scene_ns == restart * SECOND]
        assert set(after) <= {0}
