"""Builds earth_like.jpg: the colours of a fictional Earth-like planet, an equirectangular map.

Everything is a function of the direction from the planet's centre, sampled in three dimensions, so
the map has neither seam nor pinched poles. Centre column: longitude 0; top row: north.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from noise import fractal, gradient_noise
from numpy.typing import NDArray

F64 = NDArray[np.float64]

WIDTH, HEIGHT = 4096, 2048
SEED = 2026
SEA_LEVEL = 0.16  # of the height below; leaves about a third of the surface as land
QUALITY = 66

# sRGB, by eye after photographs from low orbit (the Blue Marble and astronauts').
ABYSS, OCEAN, SHELF = (7, 20, 52), (11, 35, 78), (28, 84, 112)
RAINFOREST, GRASS, STEPPE = (38, 66, 30), (82, 98, 48), (138, 124, 80)
DESERT, RED_DESERT, ROCK = (192, 164, 120), (166, 122, 86), (112, 98, 84)
TAIGA, TUNDRA, SNOW, SEA_ICE = (42, 58, 38), (116, 110, 90), (238, 242, 246), (214, 226, 234)
CLOUD = (246, 248, 250)


def save(path: Path) -> None:
    """Writes the map as a JPEG; needs Pillow."""
    from PIL import Image

    rows = [colors(directions(WIDTH, HEIGHT, row, row + 64)) for row in range(0, HEIGHT, 64)]
    image = np.concatenate(rows).reshape(HEIGHT, WIDTH, 3)
    Image.fromarray(image).save(path, quality=QUALITY, subsampling=2, optimize=True)


def directions(width: int, height: int, first_row: int, last_row: int) -> F64:
    """Unit vectors of the pixel centres of some rows; z north, x at longitude 0."""
    lon = ((np.arange(width) + 0.5) / width - 0.5) * 2 * np.pi
    lat = (0.5 - (np.arange(first_row, last_row) + 0.5) / height) * np.pi
    lat, lon = np.meshgrid(lat, lon, indexing="ij")
    return np.stack(
        [np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=-1
    ).reshape(-1, 3)


def colors(d: F64) -> NDArray[np.uint8]:
    """sRGB colours (n, 3) of the planet seen from above in directions d (n, 3), unit."""
    height = relief(d)
    ground = np.where((height > 0)[:, None], land(d, height), sea(d, height))
    cover = clouds(d)[:, None]
    shown = ground * (1 - cover) + np.array(CLOUD) * cover
    return np.clip(np.round(shown), 0, 255).astype(np.uint8)


def warp(d: F64, scale: float, amount: float, seed: int, octaves: int = 3) -> F64:
    """Bends directions by noise, which turns round blobs into coasts and streaks."""
    shift = np.stack([fractal(d * scale + 31.7 * k, seed + 50 * k, octaves) for k in range(3)], 1)
    return d + amount * shift


def relief(d: F64) -> F64:
    """Height above the sea in arbitrary units; about -1..1."""
    bent = warp(d, 2.1, 0.22, SEED)
    continents = fractal(bent * 1.25 + 4.2, SEED + 7, 9, gain=0.54)
    ridges = fractal(bent * 2.7, SEED + 90, 7, gain=0.55, ridged=True)
    height = continents - SEA_LEVEL
    inland = smooth(height, 0.0, 0.25)
    return height + inland * 0.18 * np.clip(ridges - 0.7, 0, None)


def smooth(x: F64, low: float, high: float) -> F64:
    """0 below `low`, 1 above `high`, a cubic between."""
    t = np.clip((x - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def mix(start: F64 | tuple[int, ...], end: F64 | tuple[int, ...], share: F64) -> F64:
    return np.asarray(start) * (1 - share[:, None]) + np.asarray(end) * share[:, None]


def sea(d: F64, height: F64) -> F64:
    """Deep to shallow, and ice at the poles."""
    depth = -height + 0.03 * fractal(d * 6, SEED + 200, 4)
    color = mix(SHELF, OCEAN, smooth(depth, 0.0, 0.07))
    color = mix(color, ABYSS, smooth(depth, 0.12, 0.55))
    floe = fractal(d * 14, SEED + 210, 5)
    edge = np.abs(d[:, 2]) + 0.035 * fractal(d * 3, SEED + 220, 4) + 0.015 * floe
    return mix(color, SEA_ICE, smooth(edge, 0.935, 0.955))


def land(d: F64, height: F64) -> F64:
    """Colour by temperature and moisture, as biomes are (Whittaker's diagram)."""
    latitude = np.arcsin(np.clip(d[:, 2], -1, 1))
    texture = fractal(d * 24, SEED + 300, 6, gain=0.62)
    blotch = fractal(d * 5, SEED + 310, 6, gain=0.6)
    warmth = np.cos(latitude) ** 1.1 - 0.75 * np.clip(height - 0.12, 0, None) + 0.05 * blotch
    # Rising air at the equator and near 50 degrees brings rain; the tropics between are dry.
    belts = 0.42 + 0.40 * np.cos(6.6 * latitude) * np.exp(-np.abs(latitude))
    moisture = belts + 0.40 * fractal(d * 2.2, SEED + 320, 5) - 0.25 * smooth(height, 0.05, 0.5)
    moisture = moisture + 0.10 * texture
    desert = mix(DESERT, RED_DESERT, smooth(blotch + 0.3 * texture, -0.1, 0.6))
    color = mix(desert, STEPPE, smooth(moisture, 0.20, 0.36))
    color = mix(color, GRASS, smooth(moisture, 0.32, 0.46))
    color = mix(color, RAINFOREST, smooth(moisture, 0.42, 0.62))
    cold = mix(TUNDRA, TAIGA, smooth(moisture, 0.35, 0.6))
    color = mix(cold, color, smooth(warmth, 0.50, 0.70))
    color = mix(color, ROCK, 0.7 * smooth(height, 0.42, 0.62))
    color = color * (1 + 0.22 * texture + 0.10 * blotch)[:, None]
    snow = smooth(warmth + 0.13 * texture, 0.24, 0.42)
    return mix(SNOW, color, snow)


def clouds(d: F64) -> F64:
    """Opacity of thin cloud: streaks along the trade winds, fronts at middle latitudes."""
    bent = warp(d * np.array([1.0, 1.0, 1.5]), 2.6, 0.30, SEED + 400, octaves=4)
    fronts = fractal(bent * 2.4, SEED + 410, 8, gain=0.58)
    puffs = fractal(bent * 11, SEED + 420, 5, gain=0.6)
    belt = 0.10 * np.cos(6.0 * np.arcsin(np.clip(d[:, 2], -1, 1)))
    sparse = gradient_noise(d * 1.7 + 8.8, SEED + 430)
    amount = fronts + 0.22 * puffs + belt + 0.35 * sparse
    return 0.94 * smooth(amount, 0.14, 0.92)
