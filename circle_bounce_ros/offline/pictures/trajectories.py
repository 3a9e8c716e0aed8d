"""The paths of a few circles over everything that stands still."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.offline.pictures.plane import (
    draw_circles,
    draw_still,
    show_plane,
    view_of,
)
from circle_bounce_ros.offline.pictures.style import (
    CYCLE,
    MOVING,
    MOVING_FILL,
    OTHERS,
    OTHERS_FILL,
    Picture,
    canvas,
    title,
)
from circle_bounce_ros.offline.source import Source, SourceError

MOST_PATHS = 6  # more hide each other
WIDTH, TALLEST = 8.0, 8.0  # inches, of the panel
LOWEST = 2.5


def trajectories(source: Source) -> Picture:
    """Draw the paths of a few circles, and all circles where they are at the end."""
    view = view_of(source)
    width, height = (high - low for low, high in zip(*view, strict=True))
    figure, axes = canvas(max(LOWEST, min(TALLEST, WIDTH * height / width)) + 0.5)
    draw_still(axes, source.scene)
    count = len(source.moving)
    # Spread over the scene, and always the same.
    chosen = np.unique(np.linspace(0, count - 1, min(MOST_PATHS, count)).round().astype(int))
    spots: list[NDArray[np.float64]] = []
    contacts, end = 0, 0.0
    last = None
    for frame in source.frames():
        spots.append(frame.positions[chosen])
        contacts += len(frame.contacts)
        end, last = frame.time, frame.positions
    if last is None or len(spots) < 2:
        raise SourceError(f'{source.name}: must have at least two instants, got {len(spots)}')
    radii = np.array([circle.radius for circle in source.moving])
    rest = np.setdiff1d(np.arange(count), chosen)
    draw_circles(axes, last[rest], radii[rest], OTHERS_FILL, OTHERS)
    draw_circles(axes, last[chosen], radii[chosen], MOVING_FILL, MOVING)
    paths = np.array(spots)
    for k in range(len(chosen)):
        color = CYCLE[k % len(CYCLE)]
        axes.plot(paths[:, k, 0], paths[:, k, 1], color=color, linewidth=1.4, zorder=3)
        axes.plot(*paths[0, k], 'o', color=color, markersize=4.0, zorder=4)
    show_plane(axes, view)
    which = f'{len(chosen)} of {count} circles' if len(chosen) < count else 'every moving circle'
    title(axes, f'{source.name}: paths of {which}, {end:.4g} s (dots: where they begin)')
    numbers = {'circles': count, 'paths': len(chosen), 'duration': end}
    return figure, numbers | ({'contacts': contacts} if source.contacts_known else {})
