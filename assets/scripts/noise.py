"""Noise in three dimensions for the assets: gradient noise, its fractal sums, cellular noise.

Hashes are integer arithmetic and the rest is additions and products, so values agree between
machines to rounding.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
U32 = NDArray[np.uint32]

# The twelve edge directions of a cube and four repeats: Perlin, "Improving noise", 2002.
GRADIENTS = np.array(
    [
        *[(1, 1, 0), (-1, 1, 0), (1, -1, 0), (-1, -1, 0), (1, 0, 1), (-1, 0, 1)],
        *[(1, 0, -1), (-1, 0, -1), (0, 1, 1), (0, -1, 1), (0, 1, -1), (0, -1, -1)],
        *[(1, 1, 0), (-1, 1, 0), (0, -1, 1), (0, -1, -1)],
    ],
    dtype=np.float32,
)


def mixed(h: U32) -> U32:
    """The finaliser of MurmurHash3 (Appleby, 2011)."""
    with np.errstate(over="ignore"):
        h = (h ^ (h >> np.uint32(16))) * np.uint32(0x85EBCA6B)
        h = (h ^ (h >> np.uint32(13))) * np.uint32(0xC2B2AE35)
        return h ^ (h >> np.uint32(16))


def axis_hashes(x: U32, y: U32, z: U32, seed: int) -> tuple[U32, U32, U32]:
    """What the axes of lattice points add to their hash."""
    with np.errstate(over="ignore"):
        start = np.uint32((seed * 0x27D4EB2F) & 0xFFFFFFFF)
        x = x * np.uint32(0x9E3779B1) ^ start
        return x, y * np.uint32(0x85EBCA77), z * np.uint32(0xC2B2AE3D)


def lattice_hash(x: U32, y: U32, z: U32, seed: int) -> U32:
    """32 mixed bits of a lattice point."""
    a, b, c = axis_hashes(x, y, z, seed)
    return mixed(a ^ b ^ c)


def gradient_noise(points: F64, seed: int) -> F64:
    """Perlin's improved noise, about -1..1, zero on the lattice; points (n, 3)."""
    cell = np.floor(points.T)
    frac = np.ascontiguousarray((points.T - cell).astype(np.float32))
    base = cell.astype(np.int64).astype(np.uint32)
    fade = frac * frac * frac * (frac * (frac * 6 - 15) + 10)
    hashes = [axis_hashes(*(base + np.uint32(k)), seed) for k in (0, 1)]
    weights = (1 - fade, fade)
    total = np.zeros(len(points), np.float32)
    for dx in (0, 1):
        for dy in (0, 1):
            for dz in (0, 1):
                h = mixed(hashes[dx][0] ^ hashes[dy][1] ^ hashes[dz][2]) & np.uint32(15)
                weight = weights[dx][0] * weights[dy][1] * weights[dz][2]
                offset = frac - np.array([[dx], [dy], [dz]], np.float32)
                # One of the three parts is 0 and the others +-1: exact in any order.
                parts = [GRADIENTS[:, k][h] * offset[k] for k in range(3)]
                total += weight * (parts[0] + parts[1] + parts[2])
    return total.astype(float)


def fractal(points: F64, seed: int, octaves: int, gain: float = 0.5, ridged: bool = False) -> F64:
    """A sum of octaves of twice the frequency and `gain` times the height, about -1..1.

    Ridged: 1 - 2 |noise|, sharp crests instead of rolling hills.
    """
    total = np.zeros(len(points))
    height, frequency = 1.0, 1.0
    for octave in range(octaves):
        # The shift keeps the octaves' zeros from lining up at the origin.
        n = gradient_noise(points * frequency + 17.13 * octave, seed + octave)
        total += height * (1 - 2 * np.abs(n) if ridged else n)
        height, frequency = height * gain, frequency * 2.03
    return total


def cellular(points: F64, seed: int) -> tuple[F64, F64]:
    """Distances to the nearest and second nearest of one random point a lattice cell (Worley)."""
    cell = np.floor(points)
    base = cell.astype(np.int64)
    near = np.full((2, len(points)), np.inf)
    for dx in (-1, 0, 1):
        for dy in (-1, 0, 1):
            for dz in (-1, 0, 1):
                step = np.array([dx, dy, dz])
                corner = (base + step).astype(np.uint32)
                h = lattice_hash(*corner.T, seed)
                jitter = np.stack([(h >> np.uint32(s)) & np.uint32(1023) for s in (0, 10, 20)], 1)
                delta = cell + step + (jitter + 0.5) / 1024 - points
                distance = np.sqrt(np.einsum("ij,ij->i", delta, delta))
                near[1] = np.minimum(near[1], np.maximum(near[0], distance))
                near[0] = np.minimum(near[0], distance)
    return near[0], near[1]


def crumple(points: F64, seed: int, size_m: float, height_m: float) -> F64:
    """Heights of crumpled foil, m: flat facets with sharp creases `size_m` apart."""
    near, second = cellular(points / size_m, seed)
    fine, _ = cellular(points / (0.45 * size_m) + 9.7, seed + 1)
    crease = np.minimum(second - near, 0.35) / 0.35
    return height_m * (0.9 * near + 0.35 * fine - 0.35 * (1 - crease) - 0.5)
