"""Checks of what the public functions are given: points, vectors and lengths, one or many."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[Any]


def components(value: ArrayLike, name: str) -> tuple[Array, Array]:
    """
    Return the x and y components of one vector or of many.

    Parameters
    ----------
    value : (2,) or (n, 2) float
    name : str
        What the caller calls it; errors begin with it.

    Returns
    -------
    x, y : () or (n,) float

    Raises
    ------
    ValueError
        For another shape, or numbers that are not finite.

    """
    array = np.asarray(value, dtype=np.float64)
    if array.ndim not in (1, 2) or array.shape[-1] != 2:
        raise ValueError(f'{name}: must have shape (2,) or (n, 2), got {array.shape}')
    if not np.isfinite(array).all():
        raise ValueError(f'{name}: must be finite, got {array.tolist()}')
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
        For numbers that are not finite, are negative, or are zero where `positive` is asked for.

    """
    array = np.asarray(value, dtype=np.float64)
    if array.ndim > 1:
        raise ValueError(f'{name}: must be one number or have shape (n,), got {array.shape}')
    if not np.isfinite(array).all():
        raise ValueError(f'{name}: must be finite, got {array.tolist()}')
    if positive and not (array > 0.0).all():
        raise ValueError(f'{name}: must be > 0, got {array.tolist()}')
    if not (array >= 0.0).all():
        raise ValueError(f'{name}: must be >= 0, got {array.tolist()}')
    return array


def direction(value: ArrayLike, name: str) -> tuple[Array, Array]:
    """
    Return the components of a vector whose length does not matter, as long as it is not zero.

    Scaled by a power of two, which changes no digit of a quotient, so that squares of very long or
    very short vectors neither overflow nor vanish.
    """
    x, y = components(value, name)
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
