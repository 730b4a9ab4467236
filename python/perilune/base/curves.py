"""Smooth plane curves through given points."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

_PIECES = 32
"""Straight pieces of a span, by which its length is measured: to 1e-4 in a turn of 90 degrees."""


class Curve:
    """A centripetal Catmull-Rom curve, by its length (Catmull and Rom 1974; Yuksel, Schaefer and
    Keyser 2011). It passes through all points, has no loops within a span, and is a straight line
    through two points."""

    def __init__(self, points: F64) -> None:
        """points: (n, 2), n at least 2; no two successive ones may be equal."""
        ends = 2.0 * points[:1] - points[1:2], 2.0 * points[-1:] - points[-2:-1]
        self._points = np.concatenate([ends[0], points, ends[1]])
        steps = np.sqrt(np.linalg.norm(np.diff(self._points, axis=0), axis=1))
        self._knots = np.concatenate([[0.0], np.cumsum(steps)])
        shares = np.arange(_PIECES) / _PIECES
        inner = self._knots[1:-1]
        spans = inner[:-1, None] + np.diff(inner)[:, None] * shares
        self._at = np.append(spans.ravel(), inner[-1])
        way = np.array([self._place(knot) for knot in self._at])
        lengths = np.linalg.norm(np.diff(way, axis=0), axis=1)
        self._along = np.concatenate([[0.0], np.cumsum(lengths)])
        self.points = way
        """(n, 2): points of the curve, 32 a span."""

    @property
    def length(self) -> float:
        """From the first point to the last, in the points' unit."""
        return float(self._along[-1])

    def at(self, along: float) -> tuple[F64, F64]:
        """Point (2,) and unit tangent (2,) at a length from the first point, clipped to the
        curve."""
        knot = float(np.interp(along, self._along, self._at))
        step = 1e-4 * float(self._at[-1] - self._at[0])
        low, high = max(knot - step, self._at[0]), min(knot + step, self._at[-1])
        tangent = self._place(high) - self._place(low)
        return self._place(knot), np.asarray(tangent / np.linalg.norm(tangent))

    def _place(self, knot: float) -> F64:
        """Barry and Goldman's pyramid (1988)."""
        t = self._knots
        k = int(np.clip(np.searchsorted(t, knot, "right") - 1, 1, len(t) - 3))
        level = list(self._points[k - 1 : k + 3])
        for first, reach in ((k - 1, 1), (k - 1, 2), (k, 1)):
            pairs = itertools.pairwise(level)
            level = [
                _mixed(a, b, t[first + i], t[first + i + reach], knot)
                for i, (a, b) in enumerate(pairs)
            ]
        return np.asarray(level[0])


def _mixed(a: F64, b: F64, low: float, high: float, at: float) -> F64:
    return np.asarray(((high - at) * a + (at - low) * b) / (high - low))


@lru_cache(maxsize=64)
def curve(points: Sequence[tuple[float, float]]) -> Curve:
    """The curve through points, kept for the next call."""
    return Curve(np.array(points, dtype=np.float64))
