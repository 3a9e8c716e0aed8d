"""Times in whole nanoseconds, and how they relate to the seconds that people write and the kernel takes."""

from __future__ import annotations

import math
from fractions import Fraction

SECOND = 10**9  # ns

# Messages cannot carry later times: their seconds are int32.
LAST_INSTANT = 2**31 * SECOND - 1  # ns

SECONDS_PER_NS = 1e-9


def exact_decimal(value: float) -> Fraction:
    """
    Return the decimal number that somebody wrote, exactly.

    A rate of 0.1 Hz then has a period of 10 s and not of 9.99999999999999944 s.
    """
    return Fraction(repr(float(value)))


def period_of(rate: float) -> Fraction:
    """Return the exact period of a rate in Hz, ns."""
    return SECOND / exact_decimal(rate)


def instant_of(seconds: float) -> int:
    """Return an instant after the first, ns, at most LAST_INSTANT; `inf` is LAST_INSTANT (in 68 years)."""
    if seconds < LAST_INSTANT / SECOND:
        return max(1, round(exact_decimal(seconds) * SECOND))
    return LAST_INSTANT


def kernel_time(scene_ns: int) -> float:
    """Return the time that the kernel is asked for at a scene time, s."""
    return scene_ns * SECONDS_PER_NS


def last_ns_before(seconds: float) -> int:
    """Return the last whole nanosecond whose `kernel_time` is not after this time."""
    after = first_ns_after(seconds)
    return after if kernel_time(after) <= seconds else after - 1


def first_ns_after(seconds: float) -> int:
    """Return the first whole nanosecond whose `kernel_time` is not before this time."""
    scene_ns = math.ceil(seconds / SECONDS_PER_NS)
    while kernel_time(scene_ns) < seconds:
        scene_ns += 1
    while scene_ns > 0 and kernel_time(scene_ns - 1) >= seconds:
        scene_ns -= 1
    return scene_ns
