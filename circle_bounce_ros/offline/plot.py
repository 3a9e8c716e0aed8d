"""bounce_plot: pictures of a scene, of a bag, or of a sweep."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from pyarrow import ArrowException, parquet

from circle_bounce_ros.kernel import EndlessContactsError, SceneError
from circle_bounce_ros.offline.bag_source import of_bag
from circle_bounce_ros.offline.files import begun
from circle_bounce_ros.offline.pictures import style
from circle_bounce_ros.offline.pictures.animation import FRAMES_PER_SECOND, animate
from circle_bounce_ros.offline.pictures.energy import energy
from circle_bounce_ros.offline.pictures.free_path import free_path
from circle_bounce_ros.offline.pictures.pressure import pressure
from circle_bounce_ros.offline.pictures.speeds import speeds
from circle_bounce_ros.offline.pictures.style import Picture
from circle_bounce_ros.offline.pictures.trajectories import trajectories
from circle_bounce_ros.offline.source import Source, SourceError, of_scene
from circle_bounce_ros.offline.stopping import INTERRUPTED
from circle_bounce_ros.offline.summary import SUMMARY, is_parameter
from circle_bounce_ros.scene_file import load_scene
from circle_bounce_ros.schedule.recording import LARGEST_RATE

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

# Of a bag these show all of it.
OF_A_WHOLE_BAG = ('speeds', 'free_path', 'energy')

DRAW: dict[str, Callable[[Source], Picture]] = {
    'trajectories': trajectories,
    'speeds': speeds,
    'free_path': free_path,
    'energy': energy,
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
        '--rate', type=float, help='instants a second, Hz; of a bag no more than there are'
    )
    parser.add_argument('--seed', type=int, help="in place of the scene file's own")
    parser.add_argument(
        '--namespace', help='of a bag in which more than one node was recorded: whose'
    )
    parser.add_argument('--force', action='store_true', help='write over a picture that is there')
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Draw.

    Returns
    -------
    int
        0; 1 when something is wrong; 130 after Ctrl-C.

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
    except KeyboardInterrupt:
        return INTERRUPTED
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
    # So that a full disk destroys no picture.
    with begun(path) as here:
        if chosen.picture == ANIMATION:
            return animate(open_source(chosen), here)
        if chosen.picture == PRESSURE:
            figure, numbers = draw_pressure(chosen)
        else:
            figure, numbers = DRAW[chosen.picture](open_source(chosen))
        style.write(figure, here, path.suffix.removeprefix('.'), numbers)
        return numbers


def open_source(chosen: argparse.Namespace) -> Source:
    """
    Return the scene or the bag that the command line names: a bag if there is a folder of that name.

    Raises
    ------
    SourceError, SceneError
        For what is neither, or is broken, or an option that does not go with it.

    """
    duration, rate = DEFAULTS[chosen.picture]
    folder = Path(chosen.source)
    if folder.is_dir() and chosen.duration is None and chosen.picture in OF_A_WHOLE_BAG:
        duration = math.inf
    duration = duration if chosen.duration is None else chosen.duration
    rate = rate if chosen.rate is None else chosen.rate
    if not folder.is_dir():
        if chosen.namespace is not None:
            raise SourceError('namespace: goes with a bag only')
        return of_scene(load_scene(chosen.source, chosen.seed), duration, rate)
    if chosen.seed is not None:
        raise SourceError(f'seed: goes with a scene only, got the bag {folder}')
    if not duration > 0.0:
        raise SourceError(f'duration: must be > 0 s, got {duration:g}')
    if not 0.0 < rate <= LARGEST_RATE:
        raise SourceError(f'rate: must be > 0 and at most {LARGEST_RATE:g} Hz, got {rate:g}')
    return of_bag(folder, duration, rate, chosen.namespace)


def draw_pressure(chosen: argparse.Namespace) -> Picture:
    """Draw the pressure of all runs of a sweep, each of whose parameters has all seeds."""
    for option in ('duration', 'rate', 'seed', 'namespace'):
        if getattr(chosen, option) is not None:
            raise SourceError(f'{option}: does not go with a sweep')
    folder = Path(chosen.source)
    path = folder / SUMMARY
    if not path.exists():
        raise SourceError(f'{folder}: must be the folder of a sweep with its {SUMMARY}')
    try:
        table = parquet.read_table(path)
    except (ArrowException, OSError) as error:
        raise SourceError(f'{path}: cannot be read: {error}') from None
    missing = [name for name in ('packing', 'compressibility') if name not in table.column_names]
    if missing:
        raise SourceError(f'{path}: must be from a sweep, lacks the column {", ".join(missing)}')
    parameters = [field.name for field in table.schema if is_parameter(field)]
    settings: dict[str, list[tuple[float, float]]] = {}
    for row in table.to_pylist():
        if row['packing'] is None or row['compressibility'] is None:
            raise SourceError(f'{folder}: must have a pressure in the bulk of every run')
        setting = str([row[name] for name in parameters])
        settings.setdefault(setting, []).append((row['packing'], row['compressibility']))
    if len({len(runs) for runs in settings.values()}) != 1:
        raise SourceError(f'{folder}: must have all seeds of each setting: finish the sweep first')
    found = np.array(list(settings.values()))
    return pressure(folder.name, found[:, :, 0], found[:, :, 1])


if __name__ == '__main__':
    sys.exit(main())
