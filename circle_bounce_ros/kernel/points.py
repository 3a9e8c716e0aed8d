"""
Checks of what the public functions are given: points, vectors and lengths, one or many.

Numbers are real. Lengths and masses, and the larger component of a vector, are 0 or between 1e-60 and 1e60, as in
a scene (ranges.py): squares of squares of these neither overflow nor vanish. A direction may have any length.
"""

from __future__ import annotations

from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[Any]

# Of lengths, speeds and masses. Squares of squares of these are still far from overflow and underflow.
LARGEST = 1e60
SMALLEST = 1e-60

# Characters of a value in an error.
SHOWN = 500


def shown(value: Any) -> str:
    """Return a value as errors show it: Python refuses to write integers of thousands of digits."""
    try:
        text = repr(value).replace('\n', ' ')
    except ValueError:
        return f'{type(value).__name__} with too many digits'
    return text if len(text) <= SHOWN else f'{text[:SHOWN]}...'


def _reals(value: ArrayLike, name: str) -> Array:
    """Return what is given as an array of finite floats; text, times, truths and complex numbers are none."""
    try:
        array = np.asarray(value)
        real = array.dtype.kind in 'iuf' or (
            array.dtype.kind == 'O'
            and all(isinstance(n, Real) and not isinstance(n, bool) for n in array.flat)
        )
        if not real or np.ma.is_masked(value):
            raise TypeError
        with np.errstate(over='ignore'):
            array = array.astype(np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f'{name}: must be real numbers, got {shown(value)}') from None
    if not np.isfinite(array).all():
        raise ValueError(f'{name}: must be finite, got {shown(array.tolist())}')
    return array


def in_range(array: Array, name: str) -> Array:
    """Return the array if its numbers are 0 or of the sizes that a scene may have."""
    size = np.abs(array)
    wrong = (size > LARGEST) | ((size < SMALLEST) & (size > 0.0))
    if wrong.any():
        rule = f'must be 0 or between {SMALLEST:g} and {LARGEST:g} in size'
        raise ValueError(f'{name}: {rule}, got {array[wrong][0]:g}')
    return array


def components(value: ArrayLike, name: str, *, any_size: bool = False) -> tuple[Array, Array]:
    """
    Return the x and y components of one vector or of many.

    Parameters
    ----------
    value : (2,) or (n, 2) float
    name : str
        What the caller calls it; errors begin with it.
    any_size : bool
        Of a direction: numbers may be out of range.

    Returns
    -------
    x, y : () or (n,) float

    Raises
    ------
    ValueError
        For another shape, or numbers that are not real, not finite or out of range.

    """
    array = _reals(value, name)
    if array.ndim not in (1, 2) or array.shape[-1] != 2:
        raise ValueError(f'{name}: must have shape (2,) or (n, 2), got {array.shape}')
    if not any_size:
        in_range(np.abs(array).max(axis=-1), name)
    return array[..., 0], array[..., 1]


def point(value: ArrayLike, name: str) -> tuple[float, float]:
    """Return the components of what must be one point, not many."""
    x, y = components(value, name)
    if x.ndim != 0:
        raise ValueError(f'{name}: must have shape (2,), got {np.shape(value)}')
    return float(x), float(y)


def quantity(value: ArrayLike, name: str, *, positive: bool = False) -> Array:
    """
    Return a length or a mass, one () or many (n,), as an array.

    Raises
    ------
    ValueError
        For numbers that are not real, not finite or out of range, are negative, or are zero where
        `positive` is asked for.

    """
    array = _reals(value, name)
    if array.ndim > 1:
        raise ValueError(f'{name}: must be one number or have shape (n,), got {array.shape}')
    if positive and not (array > 0.0).all():
        raise ValueError(f'{name}: must be > 0, got {shown(array.tolist())}')
    if not (array >= 0.0).all():
        raise ValueError(f'{name}: must be >= 0, got {shown(array.tolist())}')
    return in_range(array, name)


def direction(value: ArrayLike, name: str) -> tuple[Array, Array]:
    """
    Return the components of a vector whose length does not matter, as long as it is not zero.

    Scaled by a power of two, which changes no digit of a quotient, so that squares of very long or
    very short vectors neither overflow nor vanish.
    """
    x, y = components(value, name, any_size=True)
    longer = np.maximum(abs(x), abs(y))
    if not longer.all():
        raise ValueError(f'{name}: must not be the zero vector')
    exponent = np.frexp(longer)[1]
    return np.ldexp(x, -exponent), np.ldexp(y, -exponent)


def vectors(x: ArrayLike, y: ArrayLike) -> Array:
    """Put components together again: (2,) from numbers, (n, 2) from arrays."""
    return np.stack(np.broadcast_arrays(x, y), axis=-1)


def plain(value: Array) -> Any:
    """Return a number for one result, the array for many."""
    return value.item() if np.ndim(value) == 0 else value
