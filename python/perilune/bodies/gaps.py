"""Fills gaps in maps of numbers from their neighbours."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
_SWEEPS = 16
"""Jacobi iterations per level, which smooth what the coarser level left uneven."""


def filled(values: NDArray[Any], missing: NDArray[np.bool_]) -> F64:
    """Numbers (height, width) around a whole body, with missing ones interpolated.

    The result is smooth (nearly a solution of Laplace's equation) and within the range of the known
    numbers. Columns wrap around; at least one number must be known."""
    return _level(np.where(missing, 0.0, values).astype(np.float64), missing)


def _level(values: F64, missing: NDArray[np.bool_]) -> F64:
    """Fills `values` from a level of half the size, then smooths the filled numbers."""
    if not missing.any():
        return values
    known = (~missing).astype(np.float64)
    weight = _halved(known)
    total = _halved(np.where(missing, 0.0, values))
    coarse = _level(total / np.where(weight > 0.0, weight, 1.0), weight == 0.0)
    rows, columns = np.nonzero(missing)
    values[rows, columns] = coarse[rows // 2, columns // 2]
    height, width = values.shape
    above, below = np.maximum(rows - 1, 0), np.minimum(rows + 1, height - 1)
    west, east = (columns - 1) % width, (columns + 1) % width
    for _ in range(_SWEEPS):
        beside = values[rows, west] + values[rows, east]
        values[rows, columns] = 0.25 * (beside + values[above, columns] + values[below, columns])
    return values


def _halved(values: F64) -> F64:
    """Sums of 2 by 2 cells; the last of an odd side is alone."""
    height, width = values.shape
    even = np.pad(values, ((0, height % 2), (0, width % 2)))
    return np.asarray(even.reshape(-(-height // 2), 2, -(-width // 2), 2).sum(axis=(1, 3)))
