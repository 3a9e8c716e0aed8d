"""Known curves of the hard-disk fluid, to compare with."""

from __future__ import annotations

import math

# B_n of the virial series Z = 1 + sum(b_n phi^(n - 1)), n = 2 ... 10, in powers of the packing fraction.
VIRIAL = (
    2.0,
    3.12801775,
    4.25785446,
    5.33689664,
    6.36302684,
    7.352080,
    8.318668,
    9.272360,
    10.216318,
)


def contact_value(packing: float) -> float:
    """
    Return how much likelier two disks touch than if the others were not there (Henderson 1975).

    chi = (1 - 7 phi / 16) / (1 - phi)^2, good to half a percent up to a packing fraction of 0.6.
    """
    return (1.0 - 7.0 * packing / 16.0) / (1.0 - packing) ** 2


def compressibility(packing: float) -> float:
    """Return Z = P / (n kT) of equal hard disks, 1 + 2 phi chi."""
    return 1.0 + 2.0 * packing * contact_value(packing)


def virial_series(packing: float) -> float:
    """Return Z of equal hard disks from the first ten virial coefficients."""
    return 1.0 + math.fsum(b * packing ** (n + 1) for n, b in enumerate(VIRIAL))


def mean_free_path(radius: float, packing: float) -> float:
    """
    Return the mean way of a disk between two contacts with others (Enskog), m.

    1 / (2 sqrt(2) n d chi) with the number density n = phi / (pi r^2) and the diameter d = 2 r.
    """
    density = packing / (math.pi * radius**2)
    return 1.0 / (2.0 * math.sqrt(2.0) * density * 2.0 * radius * contact_value(packing))


def contact_rate(radius: float, packing: float, thermal_speed: float) -> float:
    """
    Return how often a disk touches another one (Enskog), 1/s.

    The mean speed of Maxwell's law, sqrt(pi / 2) s, over the mean free path; s is the standard deviation
    of a component of the velocity, m/s.
    """
    return math.sqrt(math.pi / 2.0) * thermal_speed / mean_free_path(radius, packing)
