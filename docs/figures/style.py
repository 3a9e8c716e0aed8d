"""
How the drawings look: one colour and one mark for one meaning, and how an image is written.

Moving circles are green with a solid border, locked ones red and hatched, walls thick and grey: told apart without
colour too. Velocities before a contact are solid arrows, those after it dashed ones.
"""

from __future__ import annotations

import io
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, FancyArrowPatch, Polygon, Rectangle
from numpy.typing import NDArray
from PIL import Image
from PIL.PngImagePlugin import PngInfo

# Told apart by the colour-blind: the Okabe-Ito set, some of them darkened for thin lines.
MOVING, MOVING_FILL = '#00785A', '#BFE6DA'
LOCKED, LOCKED_FILL = '#C04A00', '#FBD9C3'
WALL = '#5A5A5A'
NORMAL = '#0067A5'
AFTER = '#7A3E9D'
INK = '#222222'
HELP = '#8C8C8C'
SHADE = '#EDEDED'

POINTS_PER_INCH = 72.0
DOTS_PER_INCH = 150
WIDTH = 8.0  # inches: 800 px at the width of a README's column, drawn at 1,200
TEXT = 11.0  # points
TITLE_ROOM = 0.11  # of a panel's height
PALETTE = 96  # colours of an image: a third of the size of one without

# Where an image keeps the numbers that it was drawn from.
NUMBERS_KEY = 'Numbers'

Point = Sequence[float] | NDArray[np.float64]
Dashes = str | tuple[float, tuple[float, ...]]


def canvas(height: float, *widths: float) -> tuple[Figure, list[Axes]]:
    """Return an empty figure, `height` inches high, and its panels from left to right."""
    mpl.rcdefaults()
    mpl.rcParams.update(
        {
            'font.family': 'DejaVu Sans',
            'font.size': TEXT,
            'mathtext.fontset': 'dejavusans',
            'hatch.linewidth': 0.7,
            'axes.edgecolor': HELP,
            'axes.linewidth': 0.8,
            'axes.spines.top': False,
            'axes.spines.right': False,
            'xtick.color': INK,
            'ytick.color': INK,
        }
    )
    figure = Figure(figsize=(WIDTH, height), dpi=DOTS_PER_INCH, layout='constrained')
    grid = figure.add_gridspec(1, len(widths), width_ratios=widths)
    return figure, [figure.add_subplot(grid[0, k]) for k in range(len(widths))]


def plane(axes: Axes, x: tuple[float, float], y: tuple[float, float], title: str = '') -> None:
    """Make a panel a piece of the plane: metres alike in x and y, no frame."""
    axes.set_xlim(*x)
    axes.set_ylim(y[0], y[1] + (TITLE_ROOM * (y[1] - y[0]) if title else 0.0))
    axes.set_aspect('equal')
    axes.axis('off')
    axes.text(0.5, 0.995, title, ha='center', va='top', color=INK, transform=axes.transAxes)


def caption(axes: Axes, text: str) -> None:
    """Write a line or two at the bottom of a panel."""
    axes.text(0.5, 0.01, text, ha='center', va='bottom', transform=axes.transAxes, fontsize=10.0)


def pointer(axes: Axes, tip: Point, tail: Point) -> None:
    """Draw the line from a label to what it names."""
    line(axes, tail, tip, HELP, zorder=7)


def write(figure: Figure, path: Path, numbers: Mapping[str, float]) -> None:
    """Write an image with few colours, no date and no version, and its numbers beside the pixels."""
    raw = io.BytesIO()
    figure.savefig(raw, format='png', facecolor='white')
    picture = Image.open(raw).convert('RGB').quantize(PALETTE, dither=Image.Dither.NONE)
    info = PngInfo()
    info.add_text(NUMBERS_KEY, describe(numbers))
    picture.save(path, optimize=True, pnginfo=info)


def describe(numbers: Mapping[str, float]) -> str:
    """Return numbers as text, `D = 1.30; r1 + r2 = 1.00`, to six digits."""
    return '; '.join(f'{name} = {value:.6g}' for name, value in numbers.items())


def moving(
    axes: Axes, center: Point, radius: float, faint: bool = False, border: float = 1.6
) -> None:
    """Draw a moving circle; faint for where it was or would be."""
    style = (
        {'facecolor': 'none', 'linestyle': (0, (4, 2))} if faint else {'facecolor': MOVING_FILL}
    )
    axes.add_patch(
        Circle(
            (center[0], center[1]), radius, edgecolor=MOVING, linewidth=border, zorder=2, **style
        )
    )


def locked(axes: Axes, center: Point, radius: float) -> None:
    """Draw a locked circle."""
    axes.add_patch(
        Circle(
            (center[0], center[1]),
            radius,
            facecolor=LOCKED_FILL,
            edgecolor=LOCKED,
            hatch='////',
            linewidth=1.6,
            zorder=2,
        )
    )


def wall(axes: Axes, start: Point, end: Point) -> None:
    """Draw a wall."""
    line(axes, start, end, WALL, width=4.0, zorder=2)


def line(
    axes: Axes,
    start: Point,
    end: Point,
    color: str = HELP,
    style: Dashes = '-',
    width: float = 1.0,
    zorder: float = 3,
) -> None:
    """Draw a straight line."""
    axes.plot(
        [start[0], end[0]],
        [start[1], end[1]],
        color=color,
        linestyle=style,
        linewidth=width,
        zorder=zorder,
        solid_capstyle='round',
    )


def dot(axes: Axes, at: Point, color: str = INK, size: float = 4.0) -> None:
    """Mark a point."""
    axes.plot([at[0]], [at[1]], 'o', color=color, markersize=size, zorder=6)


def star(axes: Axes, at: Point) -> None:
    """Mark a contact point."""
    axes.plot(
        [at[0]], [at[1]], '*', color='#FFD23F', markeredgecolor=INK, markersize=13, zorder=7,
        markeredgewidth=0.8,
    )  # fmt: skip


def arrow(
    axes: Axes,
    start: Point,
    vector: Point,
    color: str = MOVING,
    style: Dashes = '-',
    width: float = 2.0,
    head: float = 14.0,
) -> None:
    """Draw a vector from where it starts."""
    axes.add_patch(
        FancyArrowPatch(
            (start[0], start[1]),
            (start[0] + vector[0], start[1] + vector[1]),
            arrowstyle='-|>',
            mutation_scale=head,
            linewidth=width,
            linestyle=style,
            color=color,
            shrinkA=0,
            shrinkB=0,
            zorder=5,
        )
    )


def before(axes: Axes, start: Point, vector: Point) -> None:
    """Draw a velocity before the contact."""
    arrow(axes, start, vector, MOVING)


def after(axes: Axes, start: Point, vector: Point) -> None:
    """Draw a velocity after the contact."""
    arrow(axes, start, vector, AFTER, style=(0, (3.5, 1.5)))


def normal(axes: Axes, start: Point, vector: Point) -> None:
    """Draw a normal."""
    arrow(axes, start, vector, NORMAL, width=1.6, head=12.0)


def measure(axes: Axes, start: Point, end: Point, color: str = INK) -> None:
    """Draw a length: a line with a head at both ends."""
    axes.add_patch(
        FancyArrowPatch(
            (start[0], start[1]),
            (end[0], end[1]),
            arrowstyle='<|-|>',
            mutation_scale=8.0,
            linewidth=1.2,
            color=color,
            shrinkA=0,
            shrinkB=0,
            zorder=4,
        )
    )


def angle(
    axes: Axes, vertex: Point, start: float, turn: float, radius: float, color: str
) -> tuple[float, float]:
    """
    Draw an angle as an arc with a head, from the direction `start` on by `turn`, both in radians.

    Returns
    -------
    (float, float)
        The middle of the arc, for a label.

    """
    low, high = sorted((start, start + turn))
    axes.add_patch(
        Arc(
            (vertex[0], vertex[1]),
            2 * radius,
            2 * radius,
            theta1=math.degrees(low),
            theta2=math.degrees(high),
            color=color,
            linewidth=1.4,
            zorder=4,
        )
    )
    end = start + turn
    tip = (vertex[0] + radius * math.cos(end), vertex[1] + radius * math.sin(end))
    back = end - math.copysign(0.05, turn) / radius
    tail = (vertex[0] + radius * math.cos(back), vertex[1] + radius * math.sin(back))
    arrow(axes, tail, (tip[0] - tail[0], tip[1] - tail[1]), color, width=1.4, head=9.0)
    middle = start + turn / 2.0
    return vertex[0] + radius * math.cos(middle), vertex[1] + radius * math.sin(middle)


def square(axes: Axes, center: Point, half: float, color: str) -> None:
    """Draw the bounding square of a circle."""
    axes.add_patch(
        Rectangle(
            (center[0] - half, center[1] - half),
            2 * half,
            2 * half,
            facecolor='none',
            edgecolor=color,
            linestyle='--',
            linewidth=1.2,
            zorder=3,
        )
    )


def area(axes: Axes, corners: Sequence[tuple[float, float]], color: str) -> None:
    """Fill a polygon, behind everything."""
    axes.add_patch(Polygon(corners, closed=True, facecolor=color, edgecolor='none', zorder=1))


def label(
    axes: Axes, at: Point, text: str, color: str = INK, align: str = 'center', size: float = TEXT
) -> None:
    """Write text at a point, on white so that lines behind it do not disturb."""
    axes.text(
        at[0],
        at[1],
        text,
        color=color,
        fontsize=size,
        ha=align,
        va='center',
        zorder=8,
        bbox={'facecolor': 'white', 'edgecolor': 'none', 'alpha': 0.75, 'pad': 0.8},
    )
