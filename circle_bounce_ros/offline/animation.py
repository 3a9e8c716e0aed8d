"""A moving picture as GIF, drawn with Pillow: a hundred frames of a thousand circles in seconds."""

from __future__ import annotations

from pathlib import Path

from PIL import Image, ImageDraw

from circle_bounce_ros.kernel import Scene
from circle_bounce_ros.offline.observables import Window
from circle_bounce_ros.offline.pictures import view_of
from circle_bounce_ros.offline.sources import Frame, Source
from circle_bounce_ros.offline.style import LOCKED, LOCKED_FILL, MOVING, MOVING_FILL, WALL

LONGER_SIDE = 480  # px
FINER = 3  # drawn so much larger and then reduced: smooth borders
COLOURS = 32
FRAMES_PER_SECOND = 20.0  # a GIF counts in hundredths of a second


def animate(source: Source, path: Path) -> dict[str, float]:
    """Write the frames of a source, which come at `FRAMES_PER_SECOND`, and return how many."""
    view = view_of(source)
    still = _Drawing(view)
    still.draw_still(source.scene)
    radii = [circle.radius for circle in source.moving]
    pictures = [still.with_circles(frame, radii) for frame in source.frames()]
    # One palette for all, or colours would flicker.
    palette = pictures[0].quantize(COLOURS)
    reduced = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    reduced[0].save(
        path,
        save_all=True,
        append_images=reduced[1:],
        duration=round(1000.0 / FRAMES_PER_SECOND),
        loop=0,
        optimize=False,
    )
    return {'frames': len(pictures), 'circles': len(radii)}


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
