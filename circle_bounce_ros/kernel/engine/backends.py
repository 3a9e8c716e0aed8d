"""
Two ways to run the same functions: as they stand, or compiled by numba where it is installed.

Compiled code works on numpy's records. Plain Python is several times faster on small objects with the same fields
and on lists, and for a handful of circles faster than a call into compiled code. Both give the same bits.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from types import SimpleNamespace
from typing import Any, NamedTuple, cast
from warnings import warn

import numpy as np
from numpy.typing import NDArray

from circle_bounce_ros.kernel.engine import compilation, records
from circle_bounce_ros.kernel.engine.build import build
from circle_bounce_ros.kernel.engine.code_cache import CodeCache
from circle_bounce_ros.kernel.engine.independent import run_independent, run_independent_in_order
from circle_bounce_ros.kernel.engine.loop import run
from circle_bounce_ros.kernel.engine.motion import read_positions
from circle_bounce_ros.kernel.engine.records import World
from circle_bounce_ros.kernel.scene import Circle, Scene

# For so few moving circles plain code is the faster one.
PLAIN_UP_TO = 4


# It carries out the events of a world up to a time, but so many at most.
Entry = Callable[[World, float, int], int]


class Backend(NamedTuple):
    """The engine's entries, and whether they take a world of arrays or one of objects."""

    run: Entry
    run_independent: Callable[[World, float], int]
    run_independent_in_order: Entry
    read_positions: Callable[[Any, Any, float, NDArray[np.float64]], None]
    takes_arrays: bool


PLAIN = Backend(run, run_independent, run_independent_in_order, read_positions, takes_arrays=False)


@lru_cache(maxsize=1)
def compiled() -> Backend:
    """
    Return the compiled backend: read from disk, or compiled now and kept there.

    Raises
    ------
    ImportError
        Where numba is not installed.

    """
    code = CodeCache()
    together, alone, in_order, read = compilation.compile_entries(
        code, run, run_independent, run_independent_in_order, read_positions
    )
    backend = Backend(together, alone, in_order, read, takes_arrays=True)
    for collide in (True, False):
        two = [Circle((x, 0.0), (1.0, 0.0), radius=0.1) for x in (0.0, 1.0)]
        world = build(Scene(two, moving_circles_collide=collide), keep_log=False)
        if collide:
            backend.run(world, 1.0, 100)
        else:
            backend.run_independent(world, 1.0)
            backend.run_independent_in_order(world, 2.0, 100)
        backend.read_positions(world.moving, world.state, 1.0, np.empty((2, 2)))
    code.save()
    return backend


@lru_cache(maxsize=1)
def fastest() -> Backend:
    """Return the compiled backend, or the plain one with a warning where numba is missing parts or fails."""
    try:
        return compiled()
    except Exception as error:  # numba and LLVM have no common kind
        warn(f'the engine runs plain, numba fails: {error!r}', RuntimeWarning, stacklevel=2)
        return PLAIN


def compile_ahead() -> bool:
    """
    Compile the engine now and keep it on disk, so that the first simulation need not wait.

    Returns
    -------
    bool
        Whether there is compiled code from here on: False where numba is not installed.

    """
    return compilation.is_available() and fastest() is not PLAIN


def choose(count: int, wanted: bool | None) -> Backend:
    """Return the backend for so many moving circles; `wanted` None: the faster one that there is."""
    if wanted is None:
        return fastest() if count > PLAIN_UP_TO and compilation.is_available() else PLAIN
    return compiled() if wanted else PLAIN


# ------------------------------------------------------------------ worlds of objects


def to_objects(world: World) -> World:
    """Return a world of arrays as one of objects and lists."""
    world = world._replace(prefetches=False)
    parts = (_to_list(part) if isinstance(part, np.ndarray) else part for part in world)
    return cast(World, _PlainWorld(*parts))


def to_arrays(world: World, like: World) -> World:
    """Return a world of objects and lists as one of arrays; `like` tells their types."""
    parts = []
    for name in World._fields:
        part, model = getattr(world, name), getattr(like, name)
        if isinstance(model, np.ndarray):
            if model.dtype.names is not None:
                part = [tuple(getattr(row, field) for field in model.dtype.names) for row in part]
            part = np.array(part, model.dtype)
        parts.append(part)
    return World(*parts)


def columns(array: NDArray[Any]) -> Any:
    """Return the fields of a record array as attributes: (n,) views."""
    return SimpleNamespace(**{name: array[name] for name in array.dtype.names or ()})


def _to_list(array: NDArray[Any]) -> list[Any]:
    """Return a list of objects with the fields of a record array, or of plain numbers."""
    if array.dtype.names is None:
        return cast(list[Any], array.tolist())
    kind = _KINDS[array.dtype.names]
    return [kind(*row) for row in array.tolist()]


def _slotted(name: str, fields: tuple[str, ...]) -> type:
    """Return a class of objects that have just these attributes and are made from them in this order."""

    def __init__(self: Any, *values: Any) -> None:  # noqa: N807 - it becomes the method
        for field, value in zip(fields, values, strict=True):
            setattr(self, field, value)

    return type(name, (), {'__slots__': fields, '__init__': __init__})


_KINDS = {
    cast(tuple[str, ...], layout.names): _slotted(name, cast(tuple[str, ...], layout.names))
    for name, layout in records.LAYOUTS.items()
}
_PlainWorld = _slotted('PlainWorld', World._fields)
