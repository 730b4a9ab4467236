"""Finds gaps in maps of numbers, and fills them from their neighbours."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
_SWEEPS = 16
"""Jacobi iterations per level, which smooth what the coarser level left uneven."""


_ENDLESS = 1e30
"""Larger numbers are no heights but markers of missing values."""


def missing_in(values: NDArray[Any], no_data: float | None) -> NDArray[np.bool_]:
    """Which numbers are no-data: not finite or beyond 1e30, the lowest of int16 and int32, and
    those that equal no_data."""
    if values.dtype.kind == "f":
        missing = ~(np.abs(values) < _ENDLESS)
    elif values.dtype.kind == "i" and values.dtype.itemsize in (2, 4):
        missing = values == np.iinfo(values.dtype).min
    else:
        missing = np.zeros(values.shape, np.bool_)
    if no_data is not None:
        exact = values.dtype.type(no_data) if values.dtype.kind == "f" else no_data
        missing |= values == exact
    return np.asarray(missing)


def share(missing: NDArray[np.bool_], what: str) -> str:
    """How many of `what` are missing, as the start of a sentence."""
    count = int(missing.sum())
    return f"{count} of {missing.size} {what} ({100.0 * count / missing.size:.2g} %) are"


def filled(values: NDArray[Any], missing: NDArray[np.bool_], around: bool = True) -> F64:
    """Numbers (height, width) with missing ones interpolated.

    The result is smooth (nearly a solution of Laplace's equation) and within the range of the known
    numbers, of which there must be one at least. around: whether columns wrap around the body."""
    return _level(np.where(missing, 0.0, values).astype(np.float64), missing, around)


def _level(values: F64, missing: NDArray[np.bool_], around: bool) -> F64:
    """Fills `values` from a level of half the size, then smooths the filled numbers."""
    if not missing.any():
        return values
    known = (~missing).astype(np.float64)
    weight = _halved(known)
    total = _halved(np.where(missing, 0.0, values))
    coarse = _level(total / np.where(weight > 0.0, weight, 1.0), weight == 0.0, around)
    rows, columns = np.nonzero(missing)
    values[rows, columns] = coarse[rows // 2, columns // 2]
    height, width = values.shape
    above, below = np.maximum(rows - 1, 0), np.minimum(rows + 1, height - 1)
    if around:
        west, east = (columns - 1) % width, (columns + 1) % width
    else:
        west, east = np.maximum(columns - 1, 0), np.minimum(columns + 1, width - 1)
    for _ in range(_SWEEPS):
        beside = values[rows, west] + values[rows, east]
        values[rows, columns] = 0.25 * (beside + values[above, columns] + values[below, columns])
    return values


def _halved(values: F64) -> F64:
    """Sums of 2 by 2 cells; the last of an odd side is alone."""
    height, width = values.shape
    even = np.pad(values, ((0, height % 2), (0, width % 2)))
    return np.asarray(even.reshape(-(-height // 2), 2, -(-width // 2), 2).sum(axis=(1, 3)))
