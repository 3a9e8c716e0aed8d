"""
The engine's functions, compiled by numba as they stand.

Each function is cloned with globals in which the functions that it calls are compiled clones themselves: the
source knows nothing of numba. All but the entries are inlined by force, and reference counting is switched off:
without either every access to an array inside the world would be counted, at four times the cost.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from importlib.util import find_spec
from types import FunctionType
from typing import Any

from circle_bounce_ros.kernel.engine import code_cache
from circle_bounce_ros.kernel.engine.code_cache import CodeCache
from circle_bounce_ros.kernel.engine.prefetch import fetch
from circle_bounce_ros.kernel.engine.records import CACHE_LINE

PACKAGE = 'circle_bounce_ros.kernel'

Function = Callable[..., Any]


def is_available() -> bool:
    """Return whether numba is installed, without the time that it takes to import it."""
    return find_spec('numba') is not None


def compiled_code_is_ready() -> bool:
    """Return whether compiled code of this very source is on disk: then nobody has to wait for it."""
    return is_available() and code_cache.is_ready()


def compile_entries(code: CodeCache, *entries: Function) -> list[Function]:
    """Return compiled twins of functions, which call compiled twins of all that they call."""
    twins: dict[Function, Any] = {}
    with suppress(
        ImportError, AttributeError
    ):  # not all that it needs is part of numba's public face
        twins[fetch] = _prefetch()
    dispatchers = [_twin(entry, twins, {}) for entry in entries]
    for dispatcher in dispatchers:
        code.attach(dispatcher)
    return dispatchers


def _twin(function: Function, twins: dict[Function, Any], options: dict[str, Any]) -> Any:
    if function in twins:
        return twins[function]
    assert isinstance(function, FunctionType)
    # Inlined by force, and never called from Python: no wrappers for that, which halves the time to compile.
    inlined = {'forceinline': True, 'no_cpython_wrapper': True, 'no_cfunc_wrapper': True}
    names = dict(function.__globals__)
    for name in function.__code__.co_names:
        used = names.get(name)
        if isinstance(used, FunctionType) and used.__module__.startswith(PACKAGE):
            names[name] = _twin(used, twins, inlined)
    twin = FunctionType(function.__code__, names, function.__name__, function.__defaults__)
    twin.__module__, twin.__qualname__ = function.__module__, function.__qualname__
    twins[function] = _njit(twin, options)
    return twins[function]


def _njit(function: Function, options: dict[str, Any]) -> Any:
    numba: Any = import_module('numba')
    common = {'error_model': 'numpy', 'nogil': True, **options}
    try:
        return numba.njit(_nrt=False, **common)(function)
    except KeyError:  # a numba without this option, which is not part of its public face
        return numba.njit(**common)(function)


def _prefetch() -> Any:
    """Return `fetch` as the processor's own instruction for it."""
    ir: Any = import_module('llvmlite.ir')
    types: Any = import_module('numba.core.types')
    arrays: Any = import_module('numba.np.arrayobj')
    extending: Any = import_module('numba.extending')
    address, number, choice = ir.IntType(8).as_pointer(), ir.IntType(64), ir.IntType(32)
    read, keep, data = (choice(value) for value in (0, 3, 1))

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = arrays.make_array(signature.args[0])(context, builder, arguments[0])
        index = context.cast(builder, arguments[1], signature.args[1], types.int64)
        size = context.get_abi_sizeof(context.get_data_type(signature.args[0].dtype))
        at = builder.add(builder.ptrtoint(array.data, number), builder.mul(index, number(size)))
        kind = ir.FunctionType(ir.VoidType(), [address, choice, choice, choice])
        instruction = builder.module.declare_intrinsic('llvm.prefetch', [address], kind)
        for line in range(0, size, CACHE_LINE):
            where = builder.inttoptr(builder.add(at, number(line)), address)
            builder.call(instruction, [where, read, keep, data])
        return context.get_dummy_value()

    def fetch_twin(typing: Any, array: Any, index: Any) -> Any:
        return types.void(array, index), generate

    return extending.intrinsic(fetch_twin)
