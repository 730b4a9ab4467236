"""What rasters of a body may be given by mistake: remarks on those of another body, and on those
that are hidden by later ones."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from perilune.bodies.elevation import ElevationRaster

F64 = NDArray[np.float64]
_MAP_FIT = 0.01
"""Fraction by which the sphere of a map may lie beyond the body's radii."""
_DATUM_FIT = 0.1
"""The same of the sphere that heights count from."""
_LOOKS = 24
"""Places along a side of a raster at which it is asked whether others lie over it."""


def of_another_body(
    map_m: float, datum_m: float | None, radii_m: tuple[float, float, float]
) -> tuple[str, ...]:
    """Remarks on the radius of the sphere or ellipsoid of a file's map (0: not known), and of the
    sphere that its heights are over (None: the body's ellipsoid)."""
    told = []
    km = " to ".join(f"{r / 1e3:g}" for r in sorted({min(radii_m), max(radii_m)})) + " km"
    if map_m > 0.0 and _beyond(map_m, radii_m, _MAP_FIT):
        text = f"its map is of a sphere of {map_m / 1e3:g} km"
        told.append(f"{text}, that of the body is {km}: is it of another body?")
    if datum_m is not None and _beyond(datum_m, radii_m, _DATUM_FIT):
        text = f"its heights are over a sphere of {datum_m / 1e3:g} km"
        told.append(f"{text}, that of the body is {km}: see datum_radius_km")
    return tuple(told)


def _beyond(radius_m: float, radii_m: tuple[float, float, float], fit: float) -> bool:
    low, high = min(radii_m) * (1.0 - fit), max(radii_m) * (1.0 + fit)
    return not low <= radius_m <= high


def hidden(rasters: Sequence[ElevationRaster]) -> Iterator[tuple[int, str]]:
    """Places of rasters of which nothing is seen since a coarser one lies over them, and remarks;
    rasters go from the lowest to the uppermost."""
    for k, row in enumerate(rasters):
        height, width = row.samples.shape
        across, down = (np.linspace(-0.49, side - 0.51, _LOOKS) for side in (width, height))
        posts = np.stack(np.meshgrid(across, down), axis=-1).reshape(-1, 2)
        places = row.raster.directions(posts)
        for upper, over in enumerate(rasters[k + 1 :], start=k + 1):
            finer = row.raster.spacing_m(1.0) < 0.99 * over.raster.spacing_m(1.0)
            if finer and bool((over.raster.weights(places, over.border_posts) == 1.0).all()):
                yield (
                    k,
                    f"is not seen: [{upper}], which is coarser, lies over it; put it after that",
                )
                break


def check_depth(low_m: float, radius_m: float, path: Path) -> None:
    """ValueError, with the key, for heights over this radius that go beyond the body's centre."""
    if low_m <= -radius_m:
        text = f"heights go down to {low_m:g} m, but the centre of the body is {radius_m:g} m below"
        raise ValueError(f"offset_m: {path}: {text}; see scale_m, offset_m and datum_radius_km")
