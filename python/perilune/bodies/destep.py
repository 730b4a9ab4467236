"""Smooths terraces of heights that were rounded to whole numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
_SWEEPS = 32
"""Steps per level; wider terraces are smoothed by the coarser levels."""
_STEP = 0.24
"""Of descents along the curvature's energy; below 1/4 they converge."""
_SIDE_MIN = 8


def destepped(values: NDArray[Any], around: bool) -> NDArray[np.float32]:
    """Whole numbers (rows, columns) without terraces; no number moves by more than half.

    Of all surfaces that round to these numbers the result is nearly that of least curvature.
    around: whether columns wrap around the body."""
    exact = values.astype(np.float64)
    smooth = _relaxed(exact, exact - 0.5, exact + 0.5, around).astype(np.float32)
    # In float32 the limits hold, too, as far as they can be written in it.
    low, high = (exact + by for by in (-0.5, 0.5))
    return np.clip(smooth, low.astype(np.float32), high.astype(np.float32))


def _relaxed(start: F64, low: F64, high: F64, around: bool) -> F64:
    """Lessens curvature within limits, from coarse to fine."""
    height, width = start.shape
    if min(height, width) >= 2 * _SIDE_MIN:
        change = _relaxed(_halved(start), _halved(low), _halved(high), around) - _halved(start)
        start = np.clip(start + _doubled(change, start.shape, around), low, high)
    last = start
    for step in range(_SWEEPS):  # accelerated as by Nesterov
        ahead = start + (step / (step + 3.0)) * (start - last)
        bent = _bend(_bend(ahead, around), around)
        last, start = start, np.clip(ahead - _STEP * bent, low, high)
    return start


def _bend(values: F64, around: bool) -> F64:
    """Mean of the four neighbours, less the value."""
    edged = np.pad(values, 1, mode="edge")
    if around:
        edged[1:-1, 0], edged[1:-1, -1] = values[:, -1], values[:, 0]
    beside = edged[1:-1, :-2] + edged[1:-1, 2:] + edged[:-2, 1:-1] + edged[2:, 1:-1]
    return np.asarray(0.25 * beside - values)


def _halved(values: F64) -> F64:
    """Means of 2 by 2 cells; the last of an odd side counts twice."""
    height, width = values.shape
    even = np.pad(values, ((0, height % 2), (0, width % 2)), mode="edge")
    return np.asarray(even.reshape(-(-height // 2), 2, -(-width // 2), 2).mean(axis=(1, 3)))


def _doubled(values: F64, shape: tuple[int, ...], around: bool) -> F64:
    """Bilinear interpolation at the cells of twice the size."""
    edged = np.pad(values, 1, mode="edge")
    if around:
        edged[1:-1, 0], edged[1:-1, -1] = values[:, -1], values[:, 0]
    for axis in (0, 1):
        fine = np.repeat(edged, 2, axis=axis)
        edged = 0.75 * fine + 0.25 * np.where(
            _odd(fine, axis), np.roll(fine, -1, axis), np.roll(fine, 1, axis)
        )
    return np.asarray(edged[2 : 2 + shape[0], 2 : 2 + shape[1]])


def _odd(values: F64, axis: int) -> NDArray[np.bool_]:
    odd = np.arange(values.shape[axis]) % 2 == 1
    return np.asarray(odd[:, np.newaxis] if axis == 0 else odd[np.newaxis])
