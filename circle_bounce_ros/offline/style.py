"""How pictures look: few colours that every kind of eye tells apart, and files that are the same each time."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image
from PIL.PngImagePlugin import PngInfo

# Okabe and Ito's set; the yellow is left out, which is hard to see as a line on white.
MOVING, LOCKED = '#009E73', '#D55E00'
BLUE, ORANGE, PURPLE, SKY = '#0072B2', '#E69F00', '#CC79A7', '#56B4E9'
CYCLE = [MOVING, BLUE, PURPLE, ORANGE, SKY, '#000000']
MOVING_FILL, LOCKED_FILL = '#BFE6DA', '#FBD9C3'
WALL, INK, HELP = '#5A5A5A', '#222222', '#8C8C8C'

WIDTH = 8.0  # inches, shown at the width of a README's column
DOTS_PER_INCH = 120
PALETTE = 192  # colours of a PNG: a third of the size of one without

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


def write(figure: Figure, path: Path, numbers: Mapping[str, float]) -> None:
    """Write a PNG, with its numbers beside the pixels, or an SVG."""
    if path.suffix == '.svg':
        figure.savefig(path, format='svg', facecolor='white', metadata={'Date': None})
        return
    raw = io.BytesIO()
    figure.savefig(raw, format='png', facecolor='white')
    picture = Image.open(raw).convert('RGB')
    # This method keeps a colour that few pixels have: a thin line's.
    picture = picture.quantize(PALETTE, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    info = PngInfo()
    info.add_text(NUMBERS_KEY, describe(numbers))
    picture.save(path, optimize=True, pnginfo=info)


def describe(numbers: Mapping[str, float]) -> str:
    """Return numbers as text, `contacts = 120; rate = 1.3`, to six digits."""
    return '; '.join(f'{name} = {value:.6g}' for name, value in numbers.items())
