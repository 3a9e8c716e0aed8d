"""What a simulation starts from: circles and walls, frozen, and checked when they are made."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from circle_bounce_ros.kernel.overlap import Bodies, Overlap, deepest
from circle_bounce_ros.kernel.points import LARGEST, SMALLEST, shown
from circle_bounce_ros.kernel.ranges import first_fault

# A circle's name becomes part of a ROS topic. Checked here without `re`, so that the rule reads as one line.
NAME_RULE = 'must be a letter followed by letters, digits or single underscores'

# Circles of a scene may overlap by this fraction of the smaller radius: rounding, not a fault.
ALLOWED_OVERLAP = 1e-12

# And by so many units of 2.2e-16 of the largest coordinate or radius of the two: places that touch are computed from
# others, and each of the coordinates is rounded.
ALLOWED_ROUNDINGS = 8.0


class SceneError(ValueError):
    """
    What is wrong with a scene: the place, the rule and the value, in one sentence.

    Attributes
    ----------
    place : str
        For instance `circles[2].radius`; empty for the scene as a whole.
    problem : str
        For instance `must be > 0 m, got -0.1`.

    """

    def __init__(self, place: str, problem: str) -> None:
        super().__init__(f'{place}: {problem}' if place else problem)
        self.place = place
        self.problem = problem

    def __reduce__(self) -> tuple[type[SceneError], tuple[str, str]]:
        """Let the error travel between processes: its arguments are not its text."""
        return type(self), (self.place, self.problem)

    def within(self, outer: str) -> SceneError:
        """Return the same error seen from the thing that holds the place."""
        return SceneError(f'{outer}.{self.place}' if self.place else outer, self.problem)


@dataclass(frozen=True)
class Circle:
    """
    A circle, moving or locked in place.

    Attributes
    ----------
    position : (float, float), m
    velocity : (float, float), m/s
        Zero for a locked circle.
    radius : float, m
        Greater than 0.
    mass : float, kg
        Greater than 0; of no effect for a locked circle.
    locked : bool
        A locked circle never moves, whatever hits it.
    name : str or None
        A letter, then letters, digits and single underscores: it becomes part of a topic name.

    """

    position: tuple[float, float]
    velocity: tuple[float, float] = (0.0, 0.0)
    radius: float = field(kw_only=True)
    mass: float = field(kw_only=True, default=1.0)
    locked: bool = field(kw_only=True, default=False)
    name: str | None = field(kw_only=True, default=None)

    def __post_init__(self) -> None:
        object.__setattr__(self, 'position', _point(self.position, 'position', 'm'))
        object.__setattr__(self, 'velocity', _point(self.velocity, 'velocity', 'm/s'))
        object.__setattr__(self, 'radius', _positive(self.radius, 'radius', 'm'))
        object.__setattr__(self, 'mass', _positive(self.mass, 'mass', 'kg'))
        object.__setattr__(self, 'locked', _truth(self.locked, 'locked'))
        if self.locked and self.velocity != (0.0, 0.0):
            raise SceneError(
                'velocity', f'must be (0, 0) for a locked circle, got {self.velocity}'
            )
        speed = math.hypot(*self.velocity)
        if 0.0 < speed < SMALLEST:
            raise SceneError('velocity', f'must be 0 or at least {SMALLEST:g} m/s, got {speed:g}')
        if self.name is not None and not is_legal_name(self.name):
            raise SceneError('name', f'{NAME_RULE}, got {shown(self.name)}')


@dataclass(frozen=True)
class Wall:
    """
    A straight wall without thickness; circles bounce off both sides and off its ends.

    Attributes
    ----------
    start, end : (float, float), m
        Two different points.

    """

    start: tuple[float, float]
    end: tuple[float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, 'start', _point(self.start, 'start', 'm'))
        object.__setattr__(self, 'end', _point(self.end, 'end', 'm'))
        if math.dist(self.start, self.end) < SMALLEST:
            raise SceneError('end', f'must differ from start, got {self.end} for both')


@dataclass(frozen=True)
class Scene:
    """
    Circles and walls at time zero. A circle's id is its index here; walls are numbered on their own.

    Attributes
    ----------
    circles : sequence of Circle
        At least one of them moves.
    walls : sequence of Wall
    moving_circles_collide : bool
        False: moving circles pass through each other and bounce off what is locked only.
    name : str
        What to call the scene; of no effect here.
    seed : int or None
        Which random numbers it was filled with, if any; of no effect here.
    restart_after : float, s
        When whoever shows the scene starts it again, `inf` for never; of no effect here.

    """

    circles: Sequence[Circle]
    walls: Sequence[Wall] = ()
    moving_circles_collide: bool = True
    name: str = field(kw_only=True, default='')
    seed: int | None = field(kw_only=True, default=None)
    restart_after: float = field(kw_only=True, default=math.inf)

    def __post_init__(self) -> None:
        object.__setattr__(self, 'circles', _all_of(Circle, self.circles, 'circles'))
        object.__setattr__(self, 'walls', _all_of(Wall, self.walls, 'walls'))
        collide = _truth(self.moving_circles_collide, 'moving_circles_collide')
        object.__setattr__(self, 'moving_circles_collide', collide)
        restart_after = _number(self.restart_after, 'restart_after')
        if not restart_after > 0.0:
            raise SceneError('restart_after', f'must be > 0 s, got {self.restart_after}')
        object.__setattr__(self, 'restart_after', restart_after)
        if all(circle.locked for circle in self.circles):
            got = f'{len(self.circles)}, all locked' if self.circles else 'none'
            raise SceneError('circles', f'at least one must move, got {got}')
        self._check_names()
        bodies = Bodies.of_scene(self)
        self._check_ranges(bodies)
        self._check_overlaps(bodies)

    def label(self, index: int) -> str:
        """Return how errors call a circle: its index, and its name if it has one."""
        name = self.circles[index].name
        return f'circles[{index}]' + (f' ({name})' if name else '')

    def _check_names(self) -> None:
        first: dict[str, int] = {}
        for index, circle in enumerate(self.circles):
            if circle.name is None:
                continue
            if circle.name in first:
                problem = (
                    f'must be unique, got {circle.name!r} as for circles[{first[circle.name]}]'
                )
                raise SceneError(f'circles[{index}].name', problem)
            first[circle.name] = index

    def _check_ranges(self, bodies: Bodies) -> None:
        fault = first_fault(self, bodies)
        if fault is not None:
            raise SceneError(*fault)

    def _check_overlaps(self, bodies: Bodies) -> None:
        found = deepest(bodies, ALLOWED_OVERLAP, ALLOWED_ROUNDINGS)
        if found.excess > 0.0:
            raise SceneError('', self._describe(found))

    def _describe(self, found: Overlap) -> str:
        other = f'walls[{found.b}]' if found.b_is_wall else self.label(found.b)
        return f'{self.label(found.a)} and {other}: must not overlap, got {found.depth:.6g} m'


def is_legal_name(name: Any) -> bool:
    """Return whether a name may become part of a ROS topic name."""
    if not isinstance(name, str) or not name.isascii() or not name[:1].isalpha():
        return False
    return name.replace('_', 'a').isalnum() and '__' not in name


def _truth(value: Any, place: str) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise SceneError(place, f'must be true or false, got {shown(value)}')
    return bool(value)


def _number(value: Any, place: str) -> float:
    # NumPy makes floats of these, and Python of a bytearray.
    no_number = (bool, np.bool_, str, bytes, bytearray, np.timedelta64, np.datetime64)
    if isinstance(value, no_number) or np.ma.is_masked(value):
        raise SceneError(place, f'must be a number, got {shown(value)}')
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise SceneError(place, f'must be a number, got {shown(value)}') from None


def _finite(value: Any, place: str, unit: str) -> float:
    number = _number(value, place)
    if not math.isfinite(number):
        raise SceneError(place, f'must be finite, got {number}')
    if abs(number) > LARGEST:
        raise SceneError(place, f'must be at most {LARGEST:g} {unit} in size, got {number:g}')
    return number


def _positive(value: Any, place: str, unit: str) -> float:
    number = _finite(value, place, unit)
    if not number > 0.0:
        raise SceneError(place, f'must be > 0 {unit}, got {number:g}')
    if number < SMALLEST:
        raise SceneError(place, f'must be at least {SMALLEST:g} {unit}, got {number:g}')
    return number


def _point(value: Any, place: str, unit: str) -> tuple[float, float]:
    try:
        x, y = value
    except (TypeError, ValueError):
        raise SceneError(place, f'must be two numbers, got {shown(value)}') from None
    return _finite(x, f'{place}[0]', unit), _finite(y, f'{place}[1]', unit)


def _all_of(kind: type, values: Iterable[Any], place: str) -> tuple[Any, ...]:
    items = tuple(values)
    for index, item in enumerate(items):
        if not isinstance(item, kind):
            problem = f'must be a {kind.__name__}, got {type(item).__name__}'
            raise SceneError(f'{place}[{index}]', problem)
    return items
