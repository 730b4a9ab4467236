"""Builds the colours of a fictional Earth-like planet and the cover of its clouds, two
equirectangular maps.

Everything is a function of the direction from the planet's centre, sampled in three dimensions, so
the map has neither seam nor pinched poles. Centre column: longitude 0; top row: north.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from noise import fractal
from numpy.typing import NDArray

F64 = NDArray[np.float64]

WIDTH, HEIGHT = 6144, 3072
CLOUD_WIDTH, CLOUD_HEIGHT = 4096, 2048
SEED = 2026
SEA_LEVEL = 0.16  # of the height below; leaves about a third of the surface as land
QUALITY = 82

# sRGB, by eye after photographs from low orbit (the Blue Marble and astronauts'), without the air.
ABYSS, OCEAN, SHELF = (5, 15, 40), (8, 24, 56), (20, 76, 92)
RAINFOREST, GRASS, STEPPE = (40, 56, 26), (84, 88, 48), (140, 122, 82)
DESERT, RED_DESERT, ROCK = (200, 168, 122), (172, 122, 84), (108, 94, 80)
TAIGA, TUNDRA, SNOW, SEA_ICE = (42, 52, 36), (112, 104, 86), (236, 240, 244), (206, 218, 226)


def save(path: Path) -> None:
    """Writes the map of colours as a JPEG; needs Pillow."""
    write(path, colors, WIDTH, HEIGHT, QUALITY)


def save_clouds(path: Path) -> None:
    """Writes the map of clouds as a grey JPEG; needs Pillow."""

    def grey(d: F64) -> NDArray[np.uint8]:
        return np.round(255.0 * cover(d)).astype(np.uint8)

    write(path, grey, CLOUD_WIDTH, CLOUD_HEIGHT, 70)


def write(
    path: Path, look: Callable[[F64], NDArray[np.uint8]], width: int, height: int, quality: int
) -> None:
    from PIL import Image

    step = 32
    rows = [look(directions(width, height, row, row + step)) for row in range(0, height, step)]
    pixels = np.concatenate(rows)
    image = pixels.reshape(height, width, *pixels.shape[1:])
    Image.fromarray(image).save(path, quality=quality, subsampling=2, optimize=True)


def directions(width: int, height: int, first_row: int, last_row: int) -> F64:
    """Unit vectors of the pixel centres of some rows; z north, x at longitude 0."""
    lon = ((np.arange(width) + 0.5) / width - 0.5) * 2 * np.pi
    lat = (0.5 - (np.arange(first_row, last_row) + 0.5) / height) * np.pi
    lat, lon = np.meshgrid(lat, lon, indexing="ij")
    return np.stack(
        [np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=-1
    ).reshape(-1, 3)


def colors(d: F64) -> NDArray[np.uint8]:
    """sRGB colours (n, 3) of the cloudless planet seen from above in directions d (n, 3), unit."""
    height = relief(d)
    shown = np.where((height > 0)[:, None], land(d, height), sea(d, height))
    return np.clip(np.round(shown), 0, 255).astype(np.uint8)


def warp(d: F64, scale: float, amount: float, seed: int, octaves: int = 3) -> F64:
    """Bends directions by noise, which turns round blobs into coasts and streaks."""
    shift = np.stack([fractal(d * scale + 31.7 * k, seed + 50 * k, octaves) for k in range(3)], 1)
    return d + amount * shift


def relief(d: F64) -> F64:
    """Height above the sea in arbitrary units; about -1..1."""
    bent = warp(d, 2.1, 0.22, SEED)
    ragged = warp(bent, 26.0, 0.012, SEED + 40, octaves=4)
    continents = fractal(ragged * 1.25 + 4.2, SEED + 7, 11, gain=0.58)
    ridges = fractal(bent * 2.7, SEED + 90, 9, gain=0.56, ridged=True)
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
    color = mix(SHELF, OCEAN, smooth(depth, -0.01, 0.03) ** 0.5)
    color = mix(color, ABYSS, smooth(depth, 0.08, 0.45))
    floe = fractal(d * 14, SEED + 210, 5)
    edge = np.abs(d[:, 2]) + 0.035 * fractal(d * 3, SEED + 220, 4) + 0.015 * floe
    return mix(color, SEA_ICE, smooth(edge, 0.935, 0.955))


def land(d: F64, height: F64) -> F64:
    """Colour by temperature and moisture, as biomes are (Whittaker's diagram)."""
    latitude = np.arcsin(np.clip(d[:, 2], -1, 1))
    texture = fractal(d * 24, SEED + 300, 6, gain=0.78)
    blotch = fractal(d * 5, SEED + 310, 6, gain=0.6)
    warmth = np.cos(latitude) ** 1.1 - 0.75 * np.clip(height - 0.12, 0, None) + 0.05 * blotch
    # Rising air at the equator and near 50 degrees brings rain; the tropics between are dry.
    belts = 0.42 + 0.40 * np.cos(6.6 * latitude) * np.exp(-np.abs(latitude))
    moisture = belts + 0.40 * fractal(d * 2.2, SEED + 320, 5) - 0.25 * smooth(height, 0.05, 0.5)
    moisture = moisture + 0.15 * texture
    desert = mix(DESERT, RED_DESERT, smooth(blotch + 0.3 * texture, -0.1, 0.6))
    color = mix(desert, STEPPE, smooth(moisture, 0.20, 0.36))
    color = mix(color, GRASS, smooth(moisture, 0.32, 0.46))
    color = mix(color, RAINFOREST, smooth(moisture, 0.42, 0.62))
    cold = mix(TUNDRA, TAIGA, smooth(moisture, 0.35, 0.6))
    color = mix(cold, color, smooth(warmth, 0.50, 0.70))
    color = mix(color, ROCK, 0.7 * smooth(height, 0.42, 0.62))
    # Valleys are darker than crests: forests, water, shade.
    folds = fractal(d * 60, SEED + 340, 5, gain=0.75, ridged=True) - 1.6
    color = color * np.clip(1 + 0.40 * texture + 0.12 * blotch + 0.22 * folds, 0.3, 1.7)[:, None]
    snow = smooth(warmth + 0.13 * texture, 0.24, 0.42)
    return mix(SNOW, color, snow)


def storms() -> list[tuple[F64, float, float]]:
    """Cyclones: their centres, radii in radians, and by how much they wind up what is there."""
    rng = np.random.default_rng(SEED)
    found = []
    for k in range(26):
        tropical = k % 5 == 4
        lat = np.radians(rng.uniform(10, 22) if tropical else rng.uniform(36, 64)) * (-1) ** k
        lon = 2 * np.pi * (k * 0.618034 + rng.uniform(0.0, 0.05))
        centre = np.array([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
        radius = rng.uniform(0.05, 0.08) if tropical else rng.uniform(0.10, 0.24)
        found.append((centre, radius, float(np.sign(lat) * rng.uniform(1.4, 2.8))))
    return found


def wound(d: F64) -> tuple[F64, F64]:
    """Directions turned about the storms, and how much of a storm is there: (n, 3), (n,)."""
    inside = np.zeros(len(d))
    for centre, radius, turns in storms():
        distance = np.arccos(np.clip(d @ centre, -1.0, 1.0)) / radius
        share = np.exp(-(distance**2))
        angle = (turns * share)[:, None]
        across = np.cross(centre, d)
        along = (d @ centre)[:, None] * centre
        d = along + (d - along) * np.cos(angle) + across * np.sin(angle)
        # The arms lie about a clear eye, and thin out.
        inside = np.maximum(inside, share * smooth(distance, 0.03, 0.12))
    return d, inside


def cover(d: F64) -> F64:
    """Part of each place that clouds cover: fronts and storms at middle latitudes, towers along the
    equator, streaks and puffs in the trade winds, few in the dry belts between."""
    sine = d[:, 2]
    latitude = np.arcsin(np.clip(sine, -1, 1))
    turned, storm = wound(d)
    bent = warp(turned * np.array([1.0, 1.0, 1.7]), 2.3, 0.34, SEED + 400, octaves=5)
    fronts = fractal(bent * 2.2, SEED + 410, 10, gain=0.62)
    wisps = fractal(bent * 4.1, SEED + 420, 8, gain=0.6, ridged=True) - 1.0
    streets = fractal(warp(d, 9.0, 0.06, SEED + 440) * 26, SEED + 430, 6, gain=0.68)
    rain = 0.30 * np.exp(-(((latitude - 0.10) / 0.10) ** 2))
    belts = 0.20 * smooth(np.abs(latitude), 0.50, 0.85) - 0.16 * np.exp(
        -(((np.abs(latitude) - 0.40) / 0.17) ** 2)
    )
    amount = fronts + 0.22 * wisps + 0.24 * streets + rain + belts + 0.38 * storm
    return smooth(amount, -0.22, 1.05)
