"""What theory says about the free path in a scene, for the two kinds of scene with a closed form."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from circle_bounce_ros.kernel import Circle, Scene
from circle_bounce_ros.offline import theory
from circle_bounce_ros.offline.observables import open_border


class Expected(NamedTuple):
    """
    What is expected of each moving circle.

    Attributes
    ----------
    path : float, m
        Between two contacts, on average.
    rate : float, 1/s
        Contacts per second.
    path_formula, rate_formula : str
        How to call it, for a legend.
    given : dict
        The numbers that it follows from.

    """

    path: float
    rate: float
    path_formula: str
    rate_formula: str
    given: dict[str, float]


def of_gas(moving: list[Circle], packing: float) -> Expected:
    """Return Enskog's free path of equal circles that hit each other, at a packing fraction."""
    radius = moving[0].radius
    squares = np.square([circle.velocity for circle in moving]).sum(axis=1)
    thermal = math.sqrt(float(squares.mean()) / 2.0)
    return Expected(
        theory.mean_free_path(radius, packing),
        theory.contact_rate(radius, packing, thermal),
        r'Enskog, $1 / (2\sqrt{2}\, n d \chi)$',
        r'Enskog, $2 n d \chi \sqrt{\pi kT / m}$',
        {'packing': packing},
    )


def of_billiard(scene: Scene, collide: bool) -> Expected | None:
    """Return the free path in a billiard; None where there is no closed form."""
    billiard = billiard_of(scene, collide)
    if not billiard:
        return None
    area, border = billiard
    path = theory.billiard_free_path(area, border)
    speeds = [math.hypot(*circle.velocity) for circle in scene.circles if not circle.locked]
    return Expected(
        path,
        float(np.mean(speeds)) / path,
        r'$\pi A / P$',
        r'$v P / (\pi A)$',
        {'area': area, 'border': border},
    )


def billiard_of(scene: Scene, collide: bool) -> tuple[float, float] | None:
    """
    Return the area open to centres and its border, for equal circles that do not hit each other in one upright box.

    None where locked circles reach into each other's or a wall's reach: there is no closed form.
    """
    moving = [circle for circle in scene.circles if not circle.locked]
    if len({circle.radius for circle in moving}) != 1:
        return None
    if collide and len(moving) > 1:
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
