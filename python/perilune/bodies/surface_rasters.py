"""Rasters of the surface of terrain, albedo and roughness, from files of any supported kind."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.bodies.elevation import (
    ElevationRaster,
    complete,
    file_radius_m,
    first_of,
    missing_of,
    place_of,
    samples_of,
)
from perilune.bodies.elevation_files import ElevationFile, read
from perilune.bodies.raster_doubts import of_another_body
from perilune.config.elevation import SurfaceRaster
from perilune.config.types import Latitudes


@dataclass(frozen=True)
class Quantity:
    """What the numbers of rasters are."""

    name: str
    """Key of `terrain`."""
    most: float
    """Greatest number; the least is 0."""
    unit: float
    """What 1 is in the core."""


ALBEDO = Quantity("albedo", 10.0, 1.0)
MASK = Quantity("mask", 65535.0, 1.0)
ROUGHNESS = Quantity("roughness", 60.0, math.pi / 180.0)


def _names(
    values: NDArray[Any], given: SurfaceRaster, file: ElevationFile, path: Path
) -> NDArray[np.uint16]:
    """The whole numbers of a mask; 0 where the file has none."""
    missing = missing_of(values, given, file)
    scale = first_of(given.scale, file.scale_m, 1.0)
    numbers = values * scale + first_of(given.offset, file.offset_m, 0.0)
    if missing is not None:
        numbers = np.where(missing, 0.0, numbers)
    wrong = ~((numbers == np.rint(numbers)) & (numbers >= 0.0) & (numbers <= MASK.most))
    if wrong.any():
        raise ValueError(
            f"file: {path}: holds {numbers[wrong][0]:.6g}; allowed: whole numbers from 0 to "
            f"{MASK.most:g}"
        )
    return numbers.astype(np.uint16)


def read_surface(
    given: SurfaceRaster,
    path: Path,
    quantity: Quantity,
    radii_m: tuple[float, float, float],
    latitudes: Latitudes = "geocentric",
) -> ElevationRaster:
    """Numbers of a file. radii_m: of the body's ellipsoid, along its axes; latitudes: of its maps.

    Raises ValueError that names the key, below the section, and the file."""
    file = read(path, given.raw, given.band)
    if (
        quantity is not MASK
        and given.scale is None
        and file.scale_m is None
        and path.suffix.lower() == ".png"
    ):
        raise ValueError(f"scale: {path}: is a PNG; give what one of its levels stands for")
    place = place_of(given, file, path, radii_m[0], radii_m, latitudes)
    values = file.values
    if place.dy > 0.0:  # from south to north
        values, place = values[::-1], place.flipped(values.shape[0])
    doubts = of_another_body(file_radius_m(given, place), None, radii_m)
    if quantity is MASK:
        names = _names(values, given, file, path)
        return ElevationRaster(names, place, 1.0, 0.0, str(path), border_posts=0.0, remarks=doubts)
    values, missing, remarks = complete(values, given, file, path, place)
    scale = first_of(given.scale, file.scale_m, 1.0)
    samples, mean = samples_of(values)
    offset = first_of(given.offset, file.offset_m, 0.0) + scale * mean
    found = ElevationRaster(
        samples, place, scale * quantity.unit, offset * quantity.unit, str(path),
        border_posts=given.border_posts, missing=missing, remarks=remarks + doubts,
    )  # fmt: skip
    try:
        low, high = (number / quantity.unit for number in found.raster.bounds())
    except ValueError as error:
        raise ValueError(f"projection: {path}: {error}") from None
    if low < 0.0 or high > quantity.most:
        allowed = f"allowed: 0 to {quantity.most:g}"
        raise ValueError(
            f"scale: {path}: with scale {scale:g} and offset {offset - scale * mean:g} its numbers "
            f"go from {low:.6g} to {high:.6g}; {allowed}"
        )
    return found
