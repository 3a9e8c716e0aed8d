"""What several tests of the lesson's formulas measure by: exact arithmetic, and distances of points."""

import math
import re
from decimal import Decimal, localcontext
from fractions import Fraction

ULP = 2.0**-52  # of 1: the spacing of floats there


def exactly(message):
    """Return a pattern for `pytest.raises` that accepts this text and no other."""
    return rf'\A{re.escape(message)}\Z'


def refusal(place_and_rule):
    """Return a pattern that accepts a refusal of this place and rule, however it goes on to show the value."""
    return rf'\A{re.escape(place_and_rule)}(, .*)?\Z'


def exact_root(value):
    """Return the root of a fraction to 60 digits."""
    with localcontext() as context:
        context.prec = 80
        return Fraction((Decimal(value.numerator) / Decimal(value.denominator)).sqrt())


def exact_time_to_touch(offset, velocity, reach):
    """
    Return the first touch by the textbook's formula, in arithmetic that loses nothing.

    Returns
    -------
    time : float, s
        The smaller root of a t^2 + 2 b t + c = 0; `inf` if there is none, or none to come.
    slant : float
        Cosine of the angle between the velocity and the normal at the touch: near 0 for a near
        graze, where the touch itself is ill-conditioned.

    """
    dx, dy, du, dv, r = map(Fraction, (*offset, *velocity, reach))
    a, b, c = du * du + dv * dv, dx * du + dy * dv, dx * dx + dy * dy - r * r
    disc = b * b - a * c
    if b >= 0 or disc <= 0 or a == 0:
        return math.inf, 0.0
    root = exact_root(disc)
    return max(float((-b - root) / a), 0.0), float(root / exact_root(a)) / reach


def distance_to_segment(point, start, end):
    """Return the distance of a point from the nearest point of a segment."""
    px, py = point[0] - start[0], point[1] - start[1]
    ex, ey = end[0] - start[0], end[1] - start[1]
    share = min(max((px * ex + py * ey) / (ex * ex + ey * ey), 0.0), 1.0)
    return math.hypot(px - share * ex, py - share * ey)
