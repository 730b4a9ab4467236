"""Elevation models of bodies: heights over the ellipsoid, from files of any supported kind."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.bodies import places
from perilune.bodies.destep import destepped
from perilune.bodies.elevation_files import ElevationFile, read
from perilune.bodies.gaps import filled, missing_in, share
from perilune.bodies.places import Place
from perilune.bodies.raster_doubts import check_depth, of_another_body
from perilune.config.areas import AreaRaster
from perilune.config.elevation import Elevation, SurfaceRaster
from perilune.config.types import Latitudes

F64 = NDArray[np.float64]
_SAMPLES = (np.uint8, np.int16, np.uint16, np.float32)
"""Types of _core.Raster."""
_MARK = -32768.0
"""Lowest of int16, which marks missing heights in files of floats, too."""
_UNITS_M = dict.fromkeys(("", "m", "metre", "metres", "meter", "meters"), 1.0) | dict.fromkeys(
    ("km", "kilometre", "kilometres", "kilometer", "kilometers"), 1e3
)
_BLOCK = 1 << 22
"""Numbers that are looked at together."""


@dataclass(frozen=True, eq=False)
class ElevationRaster:
    """Heights along lines from a body's centre: scale_m * sample + offset_m; or other numbers of
    its ground, without metres.

    Equal only to itself."""

    samples: NDArray[Any]
    """(rows, columns) of uint8, int16, uint16 or float32, finite; may be a memory map."""
    place: Place
    scale_m: float
    offset_m: float
    name: str
    """The file."""
    interpolation: str = "bilinear"
    border_posts: float = 0.0
    apron_m: float = 0.0
    """Width of the ground around it that is raised or lowered to meet its edges."""
    datum_m: float = 0.0
    """Radius of the sphere that heights are over; 0: over the body's ellipsoid."""
    missing: float = 0.0
    """Fraction of the heights that were filled."""
    remarks: tuple[str, ...] = ()
    """Remarks for the user, one per line."""

    @cached_property
    def raster(self) -> _core.Raster:
        """The core's raster of these heights."""
        scale, offset = self.scale_m, self.offset_m
        return _core.Raster(self.samples, scale=scale, offset=offset, **self.place.arguments())

    def heights(self, directions: F64) -> F64:
        """(n,) heights over the datum, m, in directions (n, 3); NaN outside."""
        return self.raster.values(directions, self.interpolation)


def read_elevation(
    given: Elevation,
    path: Path,
    radii_m: tuple[float, float, float],
    latitudes: Latitudes = "geocentric",
) -> ElevationRaster:
    """Heights of a file. radii_m: of the body's ellipsoid, along its axes; latitudes: of its maps.

    Raises ValueError that names the key, below the section, and the file."""
    file = read(path, given.raw)
    if given.scale_m is None and file.scale_m is None and path.suffix.lower() == ".png":
        raise ValueError(f"scale_m: {path}: is a PNG; give the metres of one of its levels")
    datum_m = file.datum_m if given.datum_radius_km is None else 1e3 * given.datum_radius_km
    place = place_of(given, file, path, datum_m or radii_m[0], radii_m, latitudes)
    values = file.values
    if place.dy > 0.0:  # from south to north
        values, place = values[::-1], place.flipped(values.shape[0])
    values, missing, remarks = complete(values, given, file, path, place)
    if given.destep:
        if file.values.dtype.kind == "f":
            raise ValueError(f"destep: {path}: holds floats, which have no steps")
        values = destepped(values, place.goes_round(values.shape[1]))
    unit_m = _unit_m(given, file, path)
    scale_m = first_of(given.scale_m, unit_m * first_of(file.scale_m, 1.0))
    offset_m = first_of(given.offset_m, unit_m * first_of(file.offset_m, 0.0))
    samples, mean = samples_of(values)
    offset_m += scale_m * mean
    remarks += of_another_body(file_radius_m(given, place), datum_m, radii_m)
    if datum_m is not None and max(radii_m) - min(radii_m) <= 1e-12 * max(radii_m):
        offset_m, datum_m = offset_m + (datum_m - radii_m[0]), None  # over the body's own sphere
    found = ElevationRaster(
        samples, place, scale_m, offset_m, str(path), given.interpolation, given.border_posts,
        given.apron_m, datum_m or 0.0, missing, remarks,
    )  # fmt: skip
    try:
        low_m, _ = found.raster.bounds()  # of which the place is checked, too
    except ValueError as error:
        raise ValueError(f"projection: {path}: {error}") from None
    if given.apron_m > 0.0 and place.goes_round(samples.shape[1]):
        raise ValueError(f"apron_m: {path}: goes around the body: there is no ground beside it")
    check_depth(low_m, found.datum_m or min(radii_m), path)
    return found


def file_radius_m(given: Elevation | SurfaceRaster, place: Place) -> float:
    """Radius of the sphere that a file says its map is of; 0: it says none."""
    return place.radius_m if given.projection is None else 0.0


def _unit_m(given: Elevation, file: ElevationFile, path: Path) -> float:
    """Metres of the unit that a file states; ValueError for one that is not known, unless the
    configuration has numbers of its own."""
    unit = file.unit.strip().lower()
    if given.scale_m is None and unit not in _UNITS_M:
        raise ValueError(f"scale_m: {path}: is in '{file.unit}'; give the metres of its numbers")
    return _UNITS_M.get(unit, 1.0)


def first_of(*values: float | None) -> float:
    """The first that is given."""
    return next(value for value in values if value is not None)


def place_of(
    given: Elevation | SurfaceRaster | AreaRaster,
    file: ElevationFile,
    path: Path,
    radius_m: float,
    radii_m: tuple[float, float, float],
    latitudes: Latitudes,
) -> Place:
    """Where a raster lies, by its section or its file."""
    if given.projection is None:
        if file.place is None:
            why = file.misplaced or "does not say where it lies"
            raise ValueError(f"projection: {path}: {why}; give projection")
        return file.place
    wanted = getattr(given.projection, "latitudes", None) or latitudes
    ratio = radii_m[2] / math.sqrt(radii_m[0] * radii_m[1]) if wanted == "geodetic" else 1.0
    rows, columns = file.values.shape
    return places.given(given.projection, (rows, columns), radius_m, ratio)


def missing_of(
    values: NDArray[Any], given: Elevation | SurfaceRaster, file: ElevationFile
) -> NDArray[np.bool_] | None:
    """Which numbers of a file are missing, None without any."""
    marks = [file.no_data, given.missing, _MARK if values.dtype.kind == "f" else None]
    return _missing(values, marks)


def complete(
    values: NDArray[Any],
    given: Elevation | SurfaceRaster,
    file: ElevationFile,
    path: Path,
    place: Place,
) -> tuple[NDArray[Any], float, tuple[str, ...]]:
    """The numbers without gaps, the fraction that was filled, and remarks."""
    missing = missing_of(values, given, file)
    heights = isinstance(given, Elevation)
    noun = "heights" if heights else "numbers"
    if missing is None:
        of_heights = heights and given.missing is None
        return values, 0.0, _holes(values, place) if of_heights else ()
    if missing.all():
        raise ValueError(f"missing: {path}: holds no {noun}: all of its numbers are no-data")
    remark = f"{share(missing, noun)} no-data: filled from those around them"
    whole = filled(values, missing, place.goes_round(values.shape[1]))
    exact = values.dtype.newbyteorder("=").type in _SAMPLES  # float32 holds the known ones
    return whole.astype(np.float32) if exact else whole, float(missing.mean()), (remark,)


def _missing(values: NDArray[Any], marks: list[float | None]) -> NDArray[np.bool_] | None:
    """Which numbers are missing, None without any; by blocks, since a file may be larger than the
    memory."""
    height, width = values.shape
    rows = max(1, _BLOCK // width)
    found: NDArray[np.bool_] | None = None
    for start in range(0, height, rows):
        block = values[start : start + rows]
        missing = np.logical_or.reduce([missing_in(block, mark) for mark in marks])
        if missing.any():
            found = np.zeros((height, width), np.bool_) if found is None else found
            found[start : start + rows] = missing
    return found


def _holes(values: NDArray[Any], place: Place) -> tuple[str, ...]:
    """A remark on rows about a pole that are mostly zeros, in a raster that has few: some grids
    have zeros where orbits left no data."""
    if not place.goes_round(values.shape[1]):
        return ()
    ends = values[:2], values[-2:]
    zeros = np.concatenate([np.count_nonzero(rows == 0, axis=1) for rows in ends])
    most = int(zeros.max())
    if most < 0.3 * values.shape[1] or values.size - np.count_nonzero(values) > 0.02 * values.size:
        return ()
    text = f"{most} of {values.shape[1]} heights of a row about a pole are exactly 0"
    return (f"{text}: if they are missing, give missing: 0",)


def samples_of(values: NDArray[Any]) -> tuple[NDArray[Any], float]:
    """The numbers in a type of the core, and a number to be added to them; a copy only where it is
    needed. Of wider types the mean is taken away, which would cost 32-bit floats precision."""
    native = values.dtype.newbyteorder("=")
    dense = values.strides[1] == values.itemsize and values.strides[0] >= 0
    if native.type in _SAMPLES:
        if dense and values.dtype.isnative and values.flags.aligned:
            return values, 0.0
        return np.ascontiguousarray(values, native), 0.0
    wide = values.astype(np.float64)
    mean = float(np.rint(wide.mean()))
    return (wide - mean).astype(np.float32), mean
