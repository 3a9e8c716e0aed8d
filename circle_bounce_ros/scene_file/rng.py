"""
Random numbers for scenes, the same bits on every machine.

Python promises that `random.Random(seed).random()` never changes; it promises so for nothing else in that
module. What follows uses only that, + - * /, comparisons and the square root, which all machines round alike;
log, cos and sin differ in the last bit from one mathematics library to the next.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from random import Random

Draw = Callable[[], float]  # uniform in [0, 1)


def draws_of_group(seed: int, group: int) -> Draw:
    """
    Return the random numbers of one group of a scene.

    Group i has `random.Random(seed + i * 2**64)` for itself: what one group draws moves no number of another,
    and no two seeds (below 2**63) share any.
    """
    return Random(seed + (group << 64)).random


def uniform(draw: Draw, low: float, high: float) -> float:
    """Return a number between low and high."""
    return low + (high - low) * draw()


def direction(draw: Draw) -> tuple[float, float]:
    """Return a unit vector of random direction: a point of the unit disk, pushed to its border."""
    while True:
        x, y = 2.0 * draw() - 1.0, 2.0 * draw() - 1.0
        size_sq = x * x + y * y
        # Near the middle too few digits are left for a direction.
        if 1e-6 < size_sq <= 1.0:
            size = math.sqrt(size_sq)
            return x / size, y / size


def exponential(draw: Draw) -> float:
    """
    Return a number of the exponential distribution with mean 1.

    Von Neumann's way (1951), without a logarithm: a run of falling numbers that begins with x has odd
    length with probability exp(-x).
    """
    whole = 0
    while True:
        first = last = draw()
        length = 1
        while (following := draw()) < last:
            last = following
            length += 1
        if length % 2:
            return whole + first
        whole += 1


def maxwell(draw: Draw, deviation: float) -> tuple[float, float]:
    """
    Return a velocity whose components are normal with this standard deviation.

    Box and Muller's transform: |v|^2 / (2 s^2) is exponential, the direction uniform.
    """
    x, y = direction(draw)
    speed = deviation * math.sqrt(2.0 * exponential(draw))
    return speed * x, speed * y


def choose(draw: Draw, count: int, of: int) -> list[int]:
    """Return `count` different whole numbers below `of`, in rising order, each choice equally likely."""
    numbers = list(range(of))
    for i in range(count):
        j = i + int(draw() * (of - i))
        numbers[i], numbers[j] = numbers[j], numbers[i]
    return sorted(numbers[:count])
