"""
Compiled code on disk, for the next start: one file for this very source, numba, Python and processor.

A file is written under another name and renamed, and begins with a checksum of its content. What is cut short or
damaged is therefore never handed to LLVM, which would end the process: it is compiled and written again.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import re
import shutil
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import Any
from warnings import warn

KERNEL = Path(__file__).resolve().parents[1]
CHECKSUM = hashlib.sha256
CHECKSUM_SIZE = CHECKSUM().digest_size  # bytes
UNUSED = 30 * 86400.0  # s after its last use a file of older sources is removed
# What is ours in a cache folder: also what a killed process has left, and the folders of 0.1.0.
OURS = re.compile(r'[0-9a-f]{16}(\.code.*)?')


class CodeCache:
    """The compiled functions that are on disk; those that are compiled now are added by `save`."""

    def __init__(self) -> None:
        self._payloads: dict[Any, Any] = {}
        self._complete = False
        self._problem = ''
        path, content = find()
        if content is not None:
            try:
                self._payloads = dict(pickle.loads(content))
                self._complete = True
            except Exception as error:  # of any kind: pickle promises none
                self._problem = f'{path} cannot be read ({error!r}), so it was compiled again'
        elif path is not None:
            self._problem = f'{path} was damaged, so it was compiled again'

    def attach(self, dispatcher: Any) -> None:
        """Let one of numba's dispatchers look here before it compiles."""
        dispatcher._cache = _Lookup(self, dispatcher.py_func.__qualname__)

    def load(self, key: Any, rebuild: Callable[[Any], Any]) -> Any:
        """Return what `rebuild` makes of the code under a key; None when it has to be compiled."""
        if key not in self._payloads:
            return None
        try:
            return rebuild(self._payloads[key])
        except Exception as error:  # whatever numba meets in it, compiling is the answer
            self._problem = f'it cannot be used ({error!r}), so it was compiled again'
            return None

    def add(self, key: Any, payload: Any) -> None:
        self._payloads[key] = payload
        self._complete = False

    def save(self) -> None:
        """Write what was added, where it can be written, and warn once of what went wrong."""
        if not self._complete:
            serialize: Any = import_module('numba.core.serialize')
            failure = write(serialize.dumps(self._payloads))
            self._complete = (
                True  # what is compiled from here on is rare, and not worth another file
            )
            if failure:
                self._problem += (
                    f'{self._problem and "; "}it is not kept for the next start: {failure}'
                )
        self._payloads = {}
        if self._problem:
            warn(f'compiled code of the engine: {self._problem}', RuntimeWarning, stacklevel=3)
            self._problem = ''


class _Lookup:
    """What a dispatcher asks for the code of one signature; in place of numba's own cache."""

    cache_path = ''  # a dispatcher's statistics ask for one

    def __init__(self, code: CodeCache, name: str) -> None:
        self._code = code
        self._name = name

    def load_overload(self, signature: Any, target: Any) -> Any:
        rebuild: Any = import_module('numba.core.compiler').CompileResult._rebuild
        target.refresh()
        key = self._key(signature, target.codegen())
        return self._code.load(key, lambda payload: rebuild(target, *payload))

    def save_overload(self, signature: Any, result: Any) -> None:
        if not result.library.has_dynamic_globals:  # addresses, which differ in the next process
            self._code.add(self._key(signature, result.library.codegen), result._reduce())

    def flush(self) -> None:
        """Numba asks for this when a function is compiled anew: nothing is read twice here."""

    def _key(self, signature: Any, codegen: Any) -> Any:
        return self._name, str(signature), codegen.magic_tuple()


def is_ready() -> bool:
    """Return whether there is undamaged code of this very source on disk."""
    return find()[1] is not None


def find() -> tuple[Path | None, bytes | None]:
    """Return the file with compiled code and its content: None for a damaged one; (None, None) where none is."""
    damaged = None
    for folder in folders():
        path = folder / file_name()
        try:
            if not os.path.lexists(path) or not _is_ours(folder):
                continue
            content = path.read_bytes() if _is_ours(path) else b''
        except OSError:
            content = b''
        checksum, content = content[:CHECKSUM_SIZE], content[CHECKSUM_SIZE:]
        if checksum == CHECKSUM(content).digest():
            with suppress(OSError):
                os.utime(path)  # used today
            return path, content
        damaged = path
    return damaged, None


def write(content: bytes) -> str:
    """Write the file into the first folder that takes it; return what went wrong, if none does."""
    failures = ['no folder for it']
    for folder in folders():
        temporary = ''
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            if not _is_ours(folder):
                raise PermissionError(f'{folder} belongs to somebody else')
            descriptor, temporary = tempfile.mkstemp(prefix=f'{file_name()}.', dir=folder)
            with open(descriptor, 'wb') as file:
                file.write(CHECKSUM(content).digest() + content)
            path = folder / file_name()
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path)
            os.replace(temporary, path)
        except OSError as error:
            failures.append(str(error))
            with suppress(OSError):
                os.unlink(temporary)
            continue
        with suppress(OSError):
            remove_unused(folder, path.stat().st_mtime)
        return ''
    return failures[-1]


def remove_unused(folder: Path, now: float) -> None:
    """Remove what older sources have left in a folder and nobody has used for long."""
    for path in folder.iterdir():
        if OURS.fullmatch(path.name) and path.lstat().st_mtime < now - UNUSED:
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink(missing_ok=True)


def folders() -> list[Path]:
    """Return where compiled code may be kept; the package's own folder may be read-only, and is not touched."""
    user = os.environ.get('XDG_CACHE_HOME') or os.path.expanduser('~/.cache')
    places = [
        Path(user) / 'circle_bounce_ros',
        Path(tempfile.gettempdir()) / f'circle_bounce_ros_{os.getuid()}',
    ]
    return [place for place in places if place.is_absolute()]


@lru_cache(maxsize=1)
def file_name() -> str:
    """Return the name of the file for all that the compiled code follows from."""
    settings = sorted(item for item in os.environ.items() if item[0].startswith('NUMBA_'))
    digest = CHECKSUM(f'{version("numba")} {sys.version} {settings} {_processor()}'.encode())
    for file in sorted(KERNEL.rglob('*.py')):
        digest.update(file.read_bytes())
    return f'{digest.hexdigest()[:16]}.code'


def _processor() -> list[str]:
    """Return what Linux says about the first processor: a home may be shared by machines that differ in it."""
    with suppress(OSError, UnicodeError):
        lines = Path('/proc/cpuinfo').read_text().partition('\n\n')[0].splitlines()
        return [
            line for line in lines if line.startswith(('model name', 'flags', 'CPU', 'Features'))
        ]
    return []


def _is_ours(path: Path) -> bool:
    """Return whether nobody else can have put code there; in the temporary folder anybody could have made it."""
    state = path.stat()
    return state.st_uid == os.getuid() and not state.st_mode & 0o002
