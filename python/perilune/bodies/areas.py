"""Rasters of a body's areas, from files of any supported kind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from perilune import _core
from perilune.bodies.elevation import place_of
from perilune.bodies.elevation_files import read
from perilune.config.areas import AreaRaster
from perilune.config.types import Latitudes


@dataclass(frozen=True)
class Areas:
    """A raster of the numbers of areas: 0 for none, else 1 + the place in the list of names."""

    raster: _core.Raster
    remarks: tuple[str, ...]
    """Remarks for the user, one per line."""


def names_of(rasters: Sequence[AreaRaster]) -> list[str]:
    """Names of all areas of a body, in the order of their numbers."""
    return list(dict.fromkeys(name for given in rasters for name in given.classes))


def read_areas(
    given: AreaRaster,
    path: Path,
    names: Sequence[str],
    radii_m: tuple[float, float, float],
    latitudes: Latitudes,
) -> Areas:
    """Areas of a file. names: of all areas of the body; radii_m: of its ellipsoid, along its axes;
    latitudes: of its maps.

    Raises ValueError that names the key, below the section, and the file."""
    file = read(path, given.raw, given.band)
    place = place_of(given, file, path, radii_m[0], radii_m, latitudes)
    values = file.values
    if place.dy > 0.0:  # from south to north
        values, place = values[::-1], place.flipped(values.shape[0])
    numbers = np.zeros(values.shape, np.uint8)
    empty = []
    for name, (low, high) in given.classes.items():
        inside = (values >= low) & (values <= high) & (numbers == 0)
        numbers[inside] = 1 + names.index(name)
        if not inside.any():
            empty.append(f"classes.{name}: no number of the file is in it")
    try:
        raster = _core.Raster(numbers, scale=1.0, offset=0.0, **place.arguments())
    except ValueError as error:
        raise ValueError(f"projection: {path}: {error}") from None
    return Areas(raster, tuple(empty))
