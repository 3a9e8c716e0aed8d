"""Checks of what the encoders are given: cheap ones, for they run with every message."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def floats(values: ArrayLike, shape: tuple[int, ...], place: str) -> NDArray[np.float64]:
    """
    Return the values as an array.

    Raises
    ------
    ValueError
        For another shape than the one asked for, which numpy might stretch silently.

    """
    array = np.asarray(values, np.float64)
    if array.shape != shape:
        raise ValueError(f'{place}: must have shape {shape}, got {array.shape}')
    return array


def lengths(values: ArrayLike, place: str) -> NDArray[np.float64]:
    """
    Return n lengths, m, as an array.

    Raises
    ------
    ValueError
        For another shape than (n,), or a length that is not finite and greater than 0.

    """
    array = np.asarray(values, np.float64)
    if array.ndim != 1:
        raise ValueError(f'{place}: must have shape (n,), got {array.shape}')
    wrong = np.flatnonzero(~(np.isfinite(array) & (array > 0.0)))
    if wrong.size:
        first = wrong[0]
        raise ValueError(f'{place}[{first}]: must be finite and > 0 m, got {array[first]}')
    return array
