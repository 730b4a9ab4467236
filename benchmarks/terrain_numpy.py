"""The fractal detail of a block of nodes by NumPy, one octave after another, each vectorised.

The numbers of its lattices are hashed as in csrc/terrain/fractal_detail.c. The strengths of octaves
are not known outside of the core: they are fitted to its heights, and what remains is rounding."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations

F64 = NDArray[np.float64]
U32 = NDArray[np.uint32]
_PRIME = 0x9E3779B1
_FNV_SEED, _FNV_PRIME = 0xCBF29CE484222325, 0x100000001B3
_COARSEST = 2  # level of the widest cells of noise


def directions(level: int, i0: int, j0: int, count: int) -> F64:
    """(count^2, 3) unit vectors to nodes of face 4 of the cube, rows of j."""
    s, t = (
        np.tan((-1.0 + 2.0 * (first + np.arange(count)) / 2**level) * np.pi / 4)
        for first in (i0, j0)
    )
    d = np.stack([*np.broadcast_arrays(-t[:, None], s), np.ones((count, count))], axis=-1)
    return np.asarray((d / np.linalg.norm(d, axis=-1, keepdims=True)).reshape(-1, 3))


def _half_mix(h: U32) -> U32:
    """All of _mix but its last step, which the high bits do not need."""
    h = (h ^ (h >> np.uint32(16))) * np.uint32(0x7FEB352D)
    return (h ^ (h >> np.uint32(15))) * np.uint32(0x846CA68B)


def _mix(h: U32) -> U32:
    h = _half_mix(h)
    return h ^ (h >> np.uint32(16))


def _key(seed: int, level: int) -> U32:
    """FNV-1a of both words, mixed."""
    word = _FNV_SEED
    for byte in seed.to_bytes(8, "little") + level.to_bytes(8, "little"):
        word = (word ^ byte) * _FNV_PRIME % 2**64
    low = _mix(np.array([word & 0xFFFFFFFF], np.uint32))
    return _mix(np.array([word >> 32], np.uint32) ^ low)


def _axes(seed: int, level: int) -> F64:
    """(3, 3): rows are the axes of the level's lattice, of a radius in cells (Shoemake 1992)."""
    key = np.array([seed, level], np.uint64)
    raw = np.random.Philox(counter=2**256 - 1, key=key).random_raw(4)
    u, v, w = (raw[:3] >> np.uint64(11)) * 2.0**-53 * [1.0, 2.0 * np.pi, 2.0 * np.pi]
    turn = [
        np.sqrt(u) * np.cos(w), np.sqrt(1 - u) * np.sin(v), np.sqrt(1 - u) * np.cos(v),
        np.sqrt(u) * np.sin(w),
    ]  # fmt: skip
    return rotations.to_matrix(np.array(turn)).T * 2.0**level * 2.0 / np.pi


class Octave:
    """One level's lattice of random numbers."""

    def __init__(self, seed: int, level: int) -> None:
        self.axes, self.key = _axes(seed, level), _key(seed, level)

    def heights(self, d: F64) -> F64:
        """(n,) heights of standard deviation 1 along directions (n, 3)."""
        places = d @ self.axes.T
        whole = np.rint(places - 0.5)
        f = places - whole
        g = 1.0 - f
        rises = (g**3, 4.0 - 3.0 * f * f * (2.0 - f), 4.0 - 3.0 * g * g * (2.0 - g), f**3)
        weights = np.stack(rises) / 6.0  # (4, n, 3)
        first = ((whole.astype(np.int64) - 1) & 0xFFFFFFFF).astype(np.uint32) * np.uint32(_PRIME)
        steps = np.arange(4, dtype=np.uint32) * np.uint32(_PRIME)
        total = np.zeros(len(d))
        for a in range(4):
            key_z = _mix(self.key + (first[:, 2] + steps[a]))
            for b in range(4):
                key_y = _mix(key_z + (first[:, 1] + steps[b]))
                row = np.zeros(len(d))
                for c in range(4):
                    number = _half_mix(key_y + (first[:, 0] + steps[c])).view(np.int32)
                    row += weights[c, :, 0] * number
                total += weights[a, :, 2] * weights[b, :, 1] * row
        return np.asarray(total / np.sqrt(2.0**64 / 12.0 * (151.0 / 315.0) ** 3))


class Detail:
    """The octaves that a lattice of some level resolves."""

    def __init__(self, seed: int, level: int) -> None:
        self.octaves = [Octave(seed, k) for k in range(_COARSEST, level + 1)]
        self.sigma_m: F64 = np.zeros(len(self.octaves))

    def fit(self, d: F64, heights_m: F64) -> float:
        """Finds the strengths; returns the largest difference that is left, m."""
        each = np.stack([octave.heights(d) for octave in self.octaves], axis=1)
        self.sigma_m = np.asarray(np.linalg.lstsq(each, heights_m, rcond=None)[0], np.float64)
        return float(np.abs(each @ self.sigma_m - heights_m).max())

    def heights(self, d: F64) -> F64:
        total = np.zeros(len(d))
        for sigma_m, octave in zip(self.sigma_m, self.octaves, strict=True):
            total += sigma_m * octave.heights(d)
        return total
