"""Images of textures of the ground, from files and made by the core."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.bodies.elevation_files import read
from perilune.config.ground_textures import Clods, GroundTexture, Mottling

_RADIUS_M = 1e9
"""Rasters of textures have no place on a body: they lie in the plane of an orthographic map."""


def read_texture(path: Path, low: float, high: float) -> _core.Raster:
    """Grey levels from low (black) to high (white); arrays of floats from low (0) to high (1).

    Raises ValueError that names the key `file`."""
    values = read(path, None).values
    if values.ndim != 2 or min(values.shape) < 8:
        raise ValueError(f"file: {path}: must be an image of grey levels of 8 by 8 or more")
    full = 1.0 if values.dtype.kind == "f" else float(np.iinfo(values.dtype).max)
    numbers = (low + (high - low) * (values / full)).astype(np.float32)
    if not np.isfinite(numbers).all():
        raise ValueError(f"file: {path}: holds numbers that are not finite")
    return _raster(numbers)


def clods_of(texture: GroundTexture, given: Clods) -> _core.Raster:
    """Heights in m. Raises ValueError that names the key within `clods`."""
    settings: _core.ClodSettings = {
        "seed": texture.seed,
        "pixels": given.pixels,
        "size_m": texture.size_m,
        "min_diameter_m": given.min_diameter_m,
        "max_diameter_m": given.max_diameter_m,
        "density_per_m2": given.density_per_m2,
        "exponent": given.exponent,
    }
    return _raster(_core.clods(settings))


def mottling_of(texture: GroundTexture, given: Mottling) -> _core.Raster:
    """Factors on the albedo, of a mean of 1."""
    settings: _core.MottlingSettings = {
        "seed": texture.seed,
        "pixels": given.pixels,
        "cover": given.cover,
        "border": given.border,
        "hurst": given.hurst,
    }
    return _raster(1.0 + np.float32(given.contrast) * _core.mottling(settings))


def _raster(numbers: NDArray[np.float32]) -> _core.Raster:
    return _core.Raster(
        np.ascontiguousarray(numbers), "orthographic", 0.0, 0.0, 1.0, -1.0, radius_m=_RADIUS_M
    )
