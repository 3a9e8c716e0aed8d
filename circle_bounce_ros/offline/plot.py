"""bounce_plot: pictures of a scene, of a bag, or of a sweep."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from pyarrow import parquet

from circle_bounce_ros.kernel import EndlessContactsError, SceneError
from circle_bounce_ros.offline import pictures, style
from circle_bounce_ros.offline.animation import FRAMES_PER_SECOND, animate
from circle_bounce_ros.offline.pictures import Picture
from circle_bounce_ros.offline.sources import Source, SourceError, open_source
from circle_bounce_ros.offline.sweep import SUMMARY

COMMAND = 'bounce_plot'
ANIMATION, PRESSURE = 'animation', 'pressure'

# What each picture is of, in s and Hz, unless the command line says otherwise.
DEFAULTS: dict[str, tuple[float, float]] = {
    'trajectories': (10.0, 120.0),
    ANIMATION: (5.0, FRAMES_PER_SECOND),
    'speeds': (20.0, 20.0),
    'free_path': (60.0, 10.0),
    'energy': (60.0, 10.0),
}

DRAW: dict[str, Callable[[Source], Picture]] = {
    'trajectories': pictures.trajectories,
    'speeds': pictures.speeds,
    'free_path': pictures.free_path,
    'energy': pictures.energy,
}


def arguments_of(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Return the parsed command line."""
    parser = argparse.ArgumentParser(
        prog=COMMAND, description='Draw a scene, a bag that holds `bodies`, or a sweep.'
    )
    parser.add_argument('picture', choices=[*DEFAULTS, PRESSURE])
    parser.add_argument(
        'source', help='name of a packaged scene, path of a scene file, folder of a bag or a sweep'
    )
    parser.add_argument('-o', '--output', type=Path, help='.png or .svg; .gif for an animation')
    parser.add_argument('--duration', type=float, help='s; of a bag its first so many')
    parser.add_argument(
        '--rate', type=float, help='instants a second, Hz; those of a bag are there'
    )
    parser.add_argument('--seed', type=int, help="in place of the scene file's own")
    parser.add_argument('--force', action='store_true', help='write over a picture that is there')
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Draw.

    Returns
    -------
    int
        0; 1 when something is wrong.

    """
    chosen = arguments_of(arguments)
    try:
        path = output_of(chosen)
        numbers = draw(chosen, path)
    except (SourceError, SceneError, EndlessContactsError) as error:
        print(f'{COMMAND}: {error}', file=sys.stderr)
        return 1
    except OSError as error:
        print(f'{COMMAND}: {error.filename or ""}: {error.strerror or error}', file=sys.stderr)
        return 1
    print(f'{path}: {style.describe(numbers)}')
    return 0


def output_of(chosen: argparse.Namespace) -> Path:
    """
    Return where the picture goes.

    Raises
    ------
    SourceError
        When something is there already, or no such picture can be written.

    """
    kinds = ['.gif'] if chosen.picture == ANIMATION else ['.png', '.svg']
    path: Path = chosen.output or Path(f'{chosen.picture}{kinds[0]}')
    if path.suffix not in kinds:
        raise SourceError(f'output: must end in {" or ".join(kinds)}, got {path}')
    if path.exists() and not chosen.force:
        raise SourceError(f'{path}: exists already, nothing was touched (--force writes over it)')
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def draw(chosen: argparse.Namespace, path: Path) -> dict[str, float]:
    """Draw what the command line says and return the numbers that the picture shows."""
    # Beside its place and renamed, so that a full disk destroys no picture.
    begun = path.with_name(f'.{path.name}{path.suffix}')
    try:
        if chosen.picture == PRESSURE:
            numbers = finish(draw_pressure(Path(chosen.source)), begun)
        else:
            duration, rate = DEFAULTS[chosen.picture]
            source = open_source(
                chosen.source, chosen.duration or duration, chosen.rate or rate, chosen.seed
            )
            if chosen.picture == ANIMATION:
                numbers = animate(source, begun)
            else:
                numbers = finish(DRAW[chosen.picture](source), begun)
        begun.replace(path)
    finally:
        begun.unlink(missing_ok=True)
    return numbers


def finish(picture: Picture, path: Path) -> dict[str, float]:
    """Write a picture and return its numbers."""
    figure, numbers = picture
    style.write(figure, path, numbers)
    return numbers


def draw_pressure(folder: Path) -> Picture:
    """Draw the pressure of all runs of a sweep, each of whose parameters has all seeds."""
    path = folder / SUMMARY
    if not path.exists():
        raise SourceError(f'{folder}: must be the folder of a sweep with its {SUMMARY}')
    rows = parquet.read_table(path).to_pylist()
    seeds = len({row['seed'] for row in rows})
    values = [(row['packing'], row['compressibility']) for row in rows]
    if not values or any(value is None for pair in values for value in pair):
        raise SourceError(f'{folder}: must have a pressure in the bulk of every run')
    if len(values) % seeds:
        raise SourceError(f'{folder}: runs are missing, finish the sweep first')
    table = np.array(values).reshape(-1, seeds, 2)
    return pictures.pressure(folder.name, table[:, :, 0], table[:, :, 1])


if __name__ == '__main__':
    sys.exit(main())
