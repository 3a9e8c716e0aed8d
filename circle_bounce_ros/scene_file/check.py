"""bounce_check: say of each scene file whether it is fine, and if not, why."""

from __future__ import annotations

import argparse
import io
import sys
from collections.abc import Sequence

from circle_bounce_ros.kernel import Scene, SceneError
from circle_bounce_ros.scene_file.loading import load_scene


def check_main(arguments: Sequence[str] | None = None) -> int:
    """
    Check scene files, one line of output each.

    Returns
    -------
    int
        0 when all are fine, 1 when some are not; wrong usage exits with 2.

    """
    parser = argparse.ArgumentParser(
        prog='bounce_check',
        description='Check scene files: one line each, exit status 1 if any is not fine.',
    )
    parser.add_argument(
        'scenes',
        nargs='+',
        metavar='FILE',
        help="a path (with '/' or ending in .yaml), or the name of a packaged scene",
    )
    if isinstance(sys.stdout, io.TextIOWrapper):
        # A file may have a name that no encoding knows.
        sys.stdout.reconfigure(errors='backslashreplace')
    verdicts = [_verdict(path_or_name) for path_or_name in parser.parse_args(arguments).scenes]
    return 0 if all(verdicts) else 1


def _verdict(path_or_name: str) -> bool:
    try:
        scene = load_scene(path_or_name)
    except SceneError as error:
        print(error, flush=True)
        return False
    print(f'{path_or_name}: ok, {_summary(scene)}', flush=True)
    return True


def _summary(scene: Scene) -> str:
    locked = sum(circle.locked for circle in scene.circles)
    moving = len(scene.circles) - locked
    return f'{moving} moving circle{_s(moving)}, {locked} locked, {len(scene.walls)} wall{_s(len(scene.walls))}'


def _s(count: int) -> str:
    return '' if count == 1 else 's'
