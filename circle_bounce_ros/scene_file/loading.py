"""A scene file, by path or by the name of a packaged one -> Scene."""

from __future__ import annotations

import math
import os
import re
from pathlib import Path
from typing import Any

from circle_bounce_ros.installation import share_directory
from circle_bounce_ros.kernel import Circle, Scene, SceneError
from circle_bounce_ros.scene_file.groups import fill
from circle_bounce_ros.scene_file.reading import read
from circle_bounce_ros.scene_file.schema import check
from circle_bounce_ros.scene_file.walls import PlacedWall, build_walls
from circle_bounce_ros.scene_file.wording import shown

# What a ROS integer parameter holds.
LARGEST_SEED = 2**63 - 1


def load_scene(path_or_name: str | os.PathLike[str], seed: int | None = None) -> Scene:
    """
    Return the scene that a file describes.

    Parameters
    ----------
    path_or_name : str or path
        Text with '/' or ending in .yaml or .yml is a path from the working directory, as is any path object;
        other text names a packaged scene.
    seed : int, optional
        From 0 to 2**63 - 1: for the random numbers of groups, in place of the file's own `seed`.

    Returns
    -------
    Scene
        Its circles are the file's circles, then those of each group; its name is the file's without the
        ending; its seed is None when there are no groups.

    Raises
    ------
    SceneError
        For everything that is wrong with the file: `file: place: rule, value`.

    """
    path = _path(path_or_name)
    try:
        return build_scene(read(path), path.stem, seed)
    except SceneError as error:
        file = os.fspath(path_or_name)
        place = f'{file}: {error.place}' if error.place else file
        raise SceneError(place, error.problem) from None


def read_scene(path_or_name: str | os.PathLike[str]) -> Any:
    """
    Return what a scene file says, as plain data that has not been checked.

    Raises
    ------
    SceneError
        For a file that is not there or no YAML.

    """
    return read(_path(path_or_name))


def build_scene(data: dict[str, Any], name: str, seed: int | None = None) -> Scene:
    """
    Return the scene that plain data describes, as `load_scene` does for that of a file.

    Raises
    ------
    SceneError
        For everything that is wrong with it: `place: rule, value`.

    """
    if seed is not None and not _is_seed(seed):
        raise SceneError('seed', f'must be a whole number from 0 to {LARGEST_SEED}, got {seed!r}')
    check(data)
    return _scene(data, name, seed)


def scene_names() -> list[str]:
    """Return the names of the packaged scenes, sorted."""
    return sorted(path.stem for path in _packaged().glob('*.yaml'))


def _packaged() -> Path:
    return share_directory() / 'config' / 'scenes'


def _path(path_or_name: str | os.PathLike[str]) -> Path:
    name = os.fspath(path_or_name)
    if not isinstance(path_or_name, str) or '/' in name or name.endswith(('.yaml', '.yml')):
        return Path(name)
    if name in scene_names():
        return _packaged() / f'{name}.yaml'
    names = ', '.join(scene_names())
    rule = f"must be one of {names}, or a path (with '/' or ending in .yaml)"
    raise SceneError('scene', f'{rule}, got {shown(name)}')


def _is_seed(seed: Any) -> bool:
    return isinstance(seed, int) and not isinstance(seed, bool) and 0 <= seed <= LARGEST_SEED


def _scene(data: dict[str, Any], name: str, seed: int | None) -> Scene:
    circles = [_circle(item, f'circles[{i}]') for i, item in enumerate(data.get('circles', ()))]
    placed = build_walls(data.get('walls', ()))
    walls = [wall.wall for wall in placed]
    groups = data.get('groups', ())
    if seed is None:
        seed = int(data.get('seed', 0))
    for index, group in enumerate(groups):
        try:
            circles += fill(group, index, seed, circles, walls)
        except SceneError as error:
            raise error.within(f'groups[{index}]') from None
    try:
        return Scene(
            circles,
            walls,
            data.get('moving_circles_collide', True),
            name=name,
            seed=seed if groups else None,
            restart_after=data.get('restart_after', math.inf),
        )
    except SceneError as error:
        raise SceneError(error.place, _in_words_of_the_file(error.problem, placed)) from None


def _circle(item: dict[str, Any], place: str) -> Circle:
    try:
        return Circle(**item)
    except SceneError as error:
        raise error.within(place) from None


def _in_words_of_the_file(problem: str, placed: list[PlacedWall]) -> str:
    """Return the kernel's sentence with its wall numbers replaced: a box is one item here and four walls there."""
    return re.sub(r'walls\[(\d+)\]', lambda found: placed[int(found[1])].place, problem)
