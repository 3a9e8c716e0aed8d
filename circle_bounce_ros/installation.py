"""What depends on how the project was installed is found out here and nowhere else."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

PACKAGE = 'circle_bounce_ros'


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
    raise FileNotFoundError(f'{PACKAGE}: no folder with package.xml and config, looked in {looked}')


def _share_candidates() -> Iterator[Path]:
    here = Path(__file__).resolve()
    yield here.parents[1]
    for folder in here.parents:
        yield folder / 'share' / PACKAGE
    for prefix in os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep):
        if prefix:
            yield Path(prefix) / 'share' / PACKAGE
