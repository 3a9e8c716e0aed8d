"""Make the drawings: `python -m docs.figures [--into FOLDER] [NAME ...]`, from the root of the source tree."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from . import bounce, contact, laws, scenes
from .style import describe, write

IMAGES = Path(__file__).resolve().parents[1] / 'images'

Drawing = Callable[[], tuple[Figure, dict[str, float]]]

DRAWINGS: dict[str, Drawing] = {
    'distance': contact.distance_between_centres,
    'contact_test': contact.contact_test,
    'squares': contact.squares,
    'contact_point': contact.point_and_normal,
    'first_touch': contact.first_touch,
    'wall': contact.wall_and_ends,
    'reflection': bounce.reflection,
    'angles': bounce.angles,
    'exchange': bounce.exchange_of_velocities,
    'next_events': laws.next_events,
    'digits_of_pi': laws.digits_of_pi,
    'free_path': laws.free_path,
    'speeds': laws.speeds,
    **{name: partial(scenes.trajectories, name) for name in scenes.SCENES},
}


def main(arguments: Sequence[str] | None = None) -> None:
    """Draw what is asked for and print the numbers of each image."""
    parser = argparse.ArgumentParser(prog='docs.figures', description=__doc__)
    parser.add_argument('names', nargs='*', metavar='NAME', help=', '.join(DRAWINGS))
    parser.add_argument('--into', type=Path, default=IMAGES, metavar='FOLDER')
    chosen = parser.parse_args(arguments)
    unknown = set(chosen.names) - set(DRAWINGS)
    if unknown:
        parser.error(
            f'NAME: must be one of {", ".join(DRAWINGS)}, got {", ".join(sorted(unknown))}'
        )
    chosen.into.mkdir(parents=True, exist_ok=True)
    for name in chosen.names or DRAWINGS:
        figure, numbers = DRAWINGS[name]()
        write(figure, chosen.into / f'{name}.png', numbers)
        print(f'{name}.png: {describe(numbers)}')


if __name__ == '__main__':
    main()
