"""
Files that are whole as soon as they have their names.

Until then they have a name that no reader takes for data: it begins with a dot and does not end like the name of a
picture or a table, for some readers take every file of a folder that ends so.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

ENDING = '.begun'


def is_utf8(text: str | Path) -> bool:
    """Return whether an argument of a command was UTF-8: pyarrow takes no other path, a message no other text."""
    try:
        str(text).encode()
    except UnicodeEncodeError:
        return False
    return True


@contextmanager
def begun(path: Path, folder: Path | None = None) -> Iterator[Path]:
    """
    Give a file that is written in here its name at the end, or remove it after an error.

    Parameters
    ----------
    path : Path
        Its name; what has it is replaced.
    folder : Path, optional
        Where it lies until then, on the same file system; by default where it will be.

    """
    here = (folder or path.parent) / f'.{path.name}{ENDING}'
    try:
        yield here
        here.replace(path)
    except BaseException:
        here.unlink(missing_ok=True)
        raise


def remove_begun(folder: Path) -> None:
    """Remove what kill -9 has left in a folder."""
    for path in folder.glob(f'.*{ENDING}'):
        path.unlink(missing_ok=True)


def replace(path: Path, text: str) -> None:
    """Write a text file."""
    with begun(path) as here:
        here.write_text(text)
