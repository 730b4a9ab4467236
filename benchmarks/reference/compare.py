"""Images in digital numbers, and how far two are apart beyond the noise of both."""

from __future__ import annotations

import numpy as np
from scipy import stats

from .scene import Array

BLOCK = 4


def encode(radiance: Array, white: float) -> Array:
    """Display values of 255, sRGB (IEC 61966-2-1), not rounded."""
    x = np.clip(np.asarray(radiance, dtype=float) / white, 0.0, 1.0)
    low = x <= 0.0031308
    return np.asarray(
        255.0 * np.where(low, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)
    )


def apart(a: Array, b: Array, white: float) -> Array:
    """(H, W) mean square difference of the bands, DN^2, of (runs, H, W, 3) radiance.

    Without what noise adds: products of the differences of independent halves, so that single
    pixels may be below 0. What is left of noise is that the display's curve is no straight line."""
    half_a = [encode(a[k::2].mean(0), white) for k in (0, 1)]
    half_b = [encode(b[k::2].mean(0), white) for k in (0, 1)]
    return np.asarray(((half_a[0] - half_b[0]) * (half_a[1] - half_b[1])).mean(-1))


def rms(a: Array, b: Array, white: float) -> float:
    """DN, of images of two runs or more."""
    return float(np.sqrt(max(0.0, apart(a, b, white).mean())))


def blocks(images: Array) -> Array:
    """(runs, rows, columns, 3): means of blocks of pixels."""
    runs, height, width, bands = images.shape
    tiles = images.reshape(runs, height // BLOCK, BLOCK, width // BLOCK, BLOCK, bands)
    return np.asarray(tiles.mean(axis=(2, 4), dtype=float))


def differing(a: Array, b: Array, false_alarm: float = 1e-3) -> Array:
    """(rows, columns): blocks whose means differ by Welch's t-test of the runs, in any band.

    false_alarm: chance that any block of two like images is among them (Sidak's correction)."""
    x, y = blocks(a), blocks(b)
    noise_x, noise_y = x.var(0, ddof=1) / len(x), y.var(0, ddof=1) / len(y)
    floor = (1e-4 * max(float(x.max()), 1e-30)) ** 2  # rounding, and samples on one lattice
    total = noise_x + noise_y
    freedom = (total + floor) ** 2 / (
        noise_x**2 / (len(x) - 1) + noise_y**2 / (len(y) - 1) + 1e-300
    )
    t = np.abs(x.mean(0) - y.mean(0)) / np.sqrt(total + floor)
    p = 2.0 * stats.t.sf(t, np.minimum(freedom, 1e6))
    return np.asarray((p < -np.expm1(np.log1p(-false_alarm) / p.size)).any(-1))
