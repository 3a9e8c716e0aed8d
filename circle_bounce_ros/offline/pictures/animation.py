"""A moving picture as GIF, drawn with Pillow: a hundred frames of a thousand circles in seconds."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from circle_bounce_ros.kernel import Scene
from circle_bounce_ros.offline.observables import Window
from circle_bounce_ros.offline.pictures.plane import view_of
from circle_bounce_ros.offline.pictures.style import (
    LOCKED,
    LOCKED_FILL,
    MOVING,
    MOVING_FILL,
    WALL,
    frequent_colours,
    with_palette,
)
from circle_bounce_ros.offline.source import Frame, Source, SourceError

LONGER_SIDE = 480  # px
FINER = 3  # drawn so much larger and then reduced: smooth borders
COLOURS = 32
FRAMES_PER_SECOND = 20.0
TICK = 10  # ms: a GIF counts in hundredths of a second
SHORTEST = 2  # of them, or browsers slow it down


def animate(source: Source, path: Path) -> dict[str, float]:
    """Write all frames of a source as a GIF, each as long as it takes, and return how many there are."""
    still = _Drawing(view_of(source))
    still.draw_still(source.scene)
    radii = [circle.radius for circle in source.moving]
    times: list[float] = []
    pictures: list[Image.Image] = []
    palette: NDArray[np.uint8] | None = None
    for frame in source.frames():
        picture = still.with_circles(frame, radii)
        # One palette for all, or colours would flicker.
        palette = frequent_colours(picture, COLOURS) if palette is None else palette
        pictures.append(with_palette(picture, palette))
        times.append(frame.time)
    if len(times) < 2:
        raise SourceError(f'{source.name}: must have at least two instants, got {len(times)}')
    pictures[0].save(
        path,
        format='gif',
        save_all=True,
        append_images=pictures[1:],
        duration=durations(times),
        loop=0,
        optimize=False,
    )
    return {'frames': len(pictures), 'circles': len(radii), 'duration': times[-1]}


def durations(times: list[float]) -> list[int]:
    """Return how long each frame is shown, ms: until the next one, the last one as long as that before."""
    ends = [round(time * 1000.0 / TICK) for time in times]
    shown = [max(SHORTEST, later - sooner) * TICK for sooner, later in pairwise(ends)]
    return [*shown, shown[-1]]


class _Drawing:
    """A picture of a piece of the plane."""

    def __init__(self, view: Window) -> None:
        width, height = (high - low for low, high in zip(*view, strict=True))
        self._left, self._top = view.low[0], view.high[1]
        self._scale = FINER * LONGER_SIDE / max(width, height)
        self._size = (round(width * self._scale / FINER), round(height * self._scale / FINER))
        large = (self._size[0] * FINER, self._size[1] * FINER)
        self._image = Image.new('RGB', large, 'white')

    def _spot(self, x: float, y: float) -> tuple[float, float]:
        return (x - self._left) * self._scale, (self._top - y) * self._scale

    def _circle(
        self, draw: ImageDraw.ImageDraw, x: float, y: float, r: float, fill: str, border: str
    ) -> None:
        px, py = self._spot(x, y)
        size = max(r * self._scale, 1.5 * FINER)
        box = (px - size, py - size, px + size, py + size)
        draw.ellipse(box, fill=fill, outline=border, width=FINER)

    def draw_still(self, scene: Scene) -> None:
        """Draw walls and locked circles."""
        draw = ImageDraw.Draw(self._image)
        for circle in scene.circles:
            if circle.locked:
                self._circle(draw, *circle.position, circle.radius, LOCKED_FILL, LOCKED)
        for wall in scene.walls:
            ends = [self._spot(*wall.start), self._spot(*wall.end)]
            draw.line(ends, fill=WALL, width=2 * FINER)

    def with_circles(self, frame: Frame, radii: list[float]) -> Image.Image:
        """Return the picture with the moving circles of a frame in it."""
        image = self._image.copy()
        draw = ImageDraw.Draw(image)
        for (x, y), radius in zip(frame.positions.tolist(), radii, strict=True):
            self._circle(draw, x, y, radius, MOVING_FILL, MOVING)
        return image.resize(self._size, Image.Resampling.BOX)
