"""How pictures look: few colours that every kind of eye tells apart, and files that are the same each time."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image
from PIL.PngImagePlugin import PngInfo

# Okabe and Ito's set; the yellow is left out, which is hard to see as a line on white.
MOVING, LOCKED = '#009E73', '#D55E00'
BLUE, ORANGE, PURPLE, SKY = '#0072B2', '#E69F00', '#CC79A7', '#56B4E9'
CYCLE = [MOVING, BLUE, PURPLE, ORANGE, SKY, '#000000']
MOVING_FILL, LOCKED_FILL = '#BFE6DA', '#FBD9C3'
OTHERS, OTHERS_FILL = '#C8C8C8', '#F4F4F4'
WALL, INK, HELP, BAND = '#5A5A5A', '#222222', '#8C8C8C', '#EDEDED'

WIDTH = 8.0  # inches, shown at the width of a README's column
DOTS_PER_INCH = 120
PALETTE = 256  # colours of a PNG: a quarter of the size of one without

Picture = tuple[Figure, dict[str, float]]

# Where a PNG keeps the numbers that it shows.
NUMBERS_KEY = 'Numbers'


def canvas(height: float, columns: int = 1, rows: int = 1, **layout: Any) -> tuple[Figure, Any]:
    """Return an empty figure, `height` inches high, and its panels."""
    mpl.rcdefaults()
    mpl.rcParams.update(
        {
            'font.family': 'DejaVu Sans',
            'font.size': 11.0,
            'mathtext.fontset': 'dejavusans',
            'axes.edgecolor': HELP,
            'axes.linewidth': 0.8,
            'axes.spines.top': False,
            'axes.spines.right': False,
            'legend.frameon': False,
            'svg.hashsalt': 'circle_bounce_ros',
            'svg.fonttype': 'path',
        }
    )
    figure = Figure(figsize=(WIDTH, height), dpi=DOTS_PER_INCH, layout='constrained')
    return figure, figure.subplots(rows, columns, **layout)


def title(axes: Axes, text: str) -> None:
    """Write above a panel what it shows."""
    axes.set_title(text, loc='left', fontsize=12.0, color=INK)


def write(figure: Figure, path: Path, form: str, numbers: Mapping[str, float]) -> None:
    """Write a figure as `png`, with its numbers beside the pixels, or as `svg`, whatever the file is called."""
    if form == 'svg':
        figure.savefig(path, format='svg', facecolor='white', metadata={'Date': None})
        return
    raw = io.BytesIO()
    figure.savefig(raw, format='png', facecolor='white')
    drawn = Image.open(raw)
    picture = with_palette(drawn, frequent_colours(drawn, PALETTE))
    info = PngInfo()
    info.add_text(NUMBERS_KEY, describe(numbers))
    picture.save(path, format='png', optimize=True, pnginfo=info)


def frequent_colours(picture: Image.Image, most: int) -> NDArray[np.uint8]:
    """Return the most frequent colours of a picture, (k, 3): those of flat areas and lines."""
    colours, _, count = _colours_of(picture)
    return colours[np.argsort(-count, kind='stable')[:most]]


def with_palette(picture: Image.Image, palette: NDArray[np.uint8]) -> Image.Image:
    """Return a picture with each pixel in the nearest of few colours, (k, 3): a colour among them stays exactly."""
    # Pillow's own search for the nearest is off by some levels, also where a colour is there.
    colours, place, _ = _colours_of(picture)
    apart = colours[:, None, :].astype(int) - palette.astype(int)
    nearest = np.square(apart).sum(axis=2).argmin(axis=1).astype(np.uint8)
    reduced = Image.fromarray(nearest[place].reshape(picture.height, picture.width))
    reduced.putpalette(palette.tobytes())
    return reduced


def _colours_of(
    picture: Image.Image,
) -> tuple[NDArray[np.uint8], NDArray[np.intp], NDArray[np.intp]]:
    """Return all colours (k, 3), which of them each pixel has, and how often they occur."""
    # As one number a pixel, which sort ten times faster than rows of three.
    packed = np.asarray(picture.convert('RGBA')).reshape(-1, 4).view('<u4').ravel()
    colours, place, count = np.unique(packed, return_inverse=True, return_counts=True)
    return colours[:, None].view(np.uint8)[:, :3], place.ravel(), count


def describe(numbers: Mapping[str, float]) -> str:
    """Return numbers as text, `contacts = 120; rate = 1.3`, to six digits."""
    return '; '.join(f'{name} = {value:.6g}' for name, value in numbers.items())
