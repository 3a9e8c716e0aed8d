"""What depends on how the project was installed is found out here and nowhere else."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

PACKAGE = 'circle_bounce_ros'

# Set by the ROS packages from PyPI when they have started Python a second time.
WHEELS_STARTED = '_ROS_WHEELS_BOOTSTRAP_COMPLETE'
LIBRARY_PATH = 'LD_LIBRARY_PATH'


def share_directory() -> Path:
    """
    Return the folder that holds package.xml and config/.

    The source tree (a clone, an editable install), else what was installed beside this file, else the
    ament index.

    Raises
    ------
    FileNotFoundError
        When there is none: a broken install.

    """
    candidates = list(_share_candidates())
    for folder in candidates:
        if (folder / 'package.xml').is_file() and (folder / 'config').is_dir():
            return folder
    looked = ', '.join(str(folder) for folder in candidates)
    raise FileNotFoundError(
        f'{PACKAGE}: no folder with package.xml and config, looked in {looked}'
    )


def _share_candidates() -> Iterator[Path]:
    here = Path(__file__).resolve()
    yield here.parents[1]
    for folder in here.parents:
        yield folder / 'share' / PACKAGE
    for prefix in os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep):
        if prefix:
            yield Path(prefix) / 'share' / PACKAGE


def missing_package(error: ModuleNotFoundError, extra: str) -> str:
    """
    Return what to install where a package that only some parts need is not there, in one sentence.

    Parameters
    ----------
    error : ModuleNotFoundError
    extra : str
        The extra of setup.py that has the package.

    Raises
    ------
    ModuleNotFoundError
        Again, when the package is our own: a broken install.

    """
    if error.name is None or error.name.partition('.')[0] == PACKAGE:
        raise error
    pip = f"in a virtual environment, in a clone of {PACKAGE}: pip install '.[{extra}]'"
    if extra == 'ros':
        pip = f'install ROS 2 Jazzy with apt and source it, or {pip}'
    return f'needs {error.name}, which is not installed; {pip}'


def child_environment(**changes: str) -> dict[str, str]:
    """
    Return the environment for a child process, with changes, without what the ROS wheels leave behind.

    They put the folders of their libraries into LD_LIBRARY_PATH, start Python a second time, and set a
    variable so as not to do it again. A child with another Python would load the wrong libraries, a child
    with ROS wheels of its own would not find them.
    """
    environment = dict(os.environ)
    if environment.pop(WHEELS_STARTED, None):
        folders = environment.pop(LIBRARY_PATH, '').split(os.pathsep)
        kept = [folder for folder in folders if folder and not _belongs_to_wheels(Path(folder))]
        if kept:
            environment[LIBRARY_PATH] = os.pathsep.join(kept)
    return environment | changes


def _belongs_to_wheels(folder: Path) -> bool:
    return folder == Path(sys.prefix, 'lib') or folder.match('site-packages/ros_*.libs')
