"""What a picture is made of: a scene, and its states one after the other."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.kernel import Circle, Scene, Simulation
from circle_bounce_ros.offline.recording import moments
from circle_bounce_ros.schedule.recording import RecordingTicks
from circle_bounce_ros.schedule.times import kernel_time

# A stamp is rounded down to a nanosecond: so little too early is in time.
ROUNDING = 1e-8  # s


class SourceError(ValueError):
    """Why a picture cannot be made of something, in one sentence."""


class Frame(NamedTuple):
    """
    One instant.

    Attributes
    ----------
    time : float, s
    positions : (n, 2) float, m
    velocities : (n, 2) float, m/s
    contacts : (k,) structured array
        Since the last frame, with at least `x`, `y` and `kind`.

    """

    time: float
    positions: NDArray[np.float64]
    velocities: NDArray[np.float64]
    contacts: NDArray[np.void]


@dataclass(frozen=True)
class Source:
    """
    What a picture is made of.

    Attributes
    ----------
    name : str
    scene : Scene
        What stands still, radii and masses. Of a bag without its scene, circles are where they were first
        seen and have 1 kg.
    frames : callable
        Returns the frames from the first on.
    digits : float
        Relative error of one number in a frame.
    collide : bool
        Whether moving circles hit each other, as far as is known.
    masses_known : bool
    contacts_known : bool
        Without them, those of a frame are always none.

    """

    name: str
    scene: Scene
    frames: Callable[[], Iterator[Frame]]
    digits: float
    collide: bool
    masses_known: bool = True
    contacts_known: bool = True

    @property
    def moving(self) -> list[Circle]:
        """The circles that move."""
        return [circle for circle in self.scene.circles if not circle.locked]

    @property
    def masses(self) -> NDArray[np.float64]:
        """(n,), kg."""
        return np.array([circle.mass for circle in self.moving])

    def check_masses(self, picture: str) -> None:
        """
        Make sure that circles of unknown mass may be taken as equal.

        Raises
        ------
        SourceError
            When their radii differ, so that their masses may too.

        """
        if not self.masses_known and len({circle.radius for circle in self.moving}) > 1:
            raise SourceError(
                f'{self.name}: {picture} needs the masses, which a bag of the node does not say; '
                'bounce_record writes them beside its bags'
            )


def of_scene(scene: Scene, duration: float, rate: float) -> Source:
    """
    Return a scene as a source, run whenever its frames are asked for.

    Raises
    ------
    SourceError
        For a duration or a rate out of range.

    """
    try:
        ticks = RecordingTicks(rate, duration, scene.restart_after)
    except ValueError as error:
        raise SourceError(str(error)) from None

    def frames() -> Iterator[Frame]:
        simulation = Simulation(scene, record_contacts=True)
        nothing = simulation.drain_contacts()
        yield Frame(0.0, simulation.positions, simulation.velocities, nothing)
        for moment in moments(simulation, ticks):
            state = moment.state
            time = kernel_time(moment.stamp_ns)
            yield Frame(time, state.positions, state.velocities, state.contacts)

    digits = float(np.finfo(np.float64).eps)
    return Source(scene.name, scene, frames, digits, scene.moving_circles_collide)


def thinned(frames: Iterator[Frame], rate: float) -> Iterator[Frame]:
    """Return at most `rate` frames a second, Hz, each with all contacts since the one before."""
    due, contacts = -math.inf, []
    for frame in frames:
        contacts.append(frame.contacts)
        if frame.time + ROUNDING >= due:
            yield frame._replace(contacts=np.concatenate(contacts))
            due, contacts = (math.floor((frame.time + ROUNDING) * rate) + 1) / rate, []
