"""Patches over the poles of cylindrical elevation models.

At a pole all columns meet. A raster has a different height there in each column, and its columns
are far closer than its rows, which would show as spokes. A patch in polar stereographic projection
has one height at the pole, and the same detail in all directions."""

from __future__ import annotations

import math
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from perilune.bodies.elevation import ElevationRaster
from perilune.bodies.places import Place

F64 = NDArray[np.float64]
_CLOSE = 1.0 / 10.0
"""Sine of the distance from the pole up to which a patch counts in full: by this factor columns are
closer than rows."""
_INSIDE_MAX = 320
"""Posts from the pole that count in full, at most: patches of fine rasters are smaller."""
_ROWS_MIN = 64
"""Coarser rasters are refined to at least as many rows before a patch is made of them."""
_ROWS_FINE = 1500
"""Rasters with fewer rows are refined, and their patches have two posts a row, to keep more of the
relief."""
_FIT = 0.01
_PER_POST = 4
"""Means along a row, per post."""


_PATCHES: WeakKeyDictionary[ElevationRaster, tuple[ElevationRaster, ...]] = WeakKeyDictionary()
"""What was made before."""


def with_patches(found: ElevationRaster, radius_m: float) -> tuple[ElevationRaster, ...]:
    """A raster, and patches over the poles that it reaches, which belong over it; made once.
    radius_m: of the body, for the scale of the patches only."""
    if found not in _PATCHES:
        _PATCHES[found] = _patches(found, radius_m)
    return (found, *_PATCHES[found])


def _patches(found: ElevationRaster, radius_m: float) -> tuple[ElevationRaster, ...]:
    rows, columns = found.samples.shape
    place = found.place
    if not place.goes_round(columns):
        return ()
    patches = []
    for sign, edge in ((1.0, 0), (-1.0, rows - 1)):
        beyond = (0.5 * math.pi - sign * (place.y0 + edge * place.dy)) / abs(place.dy)
        if min(abs(beyond), abs(beyond - 0.5)) <= _FIT:
            patches.append(_patch(found, sign, radius_m))
    return tuple(patches)


def _patch(found: ElevationRaster, sign: float, radius_m: float) -> ElevationRaster:
    """The patch over the north pole (sign 1) or south pole (-1). Its posts are means over about one
    and a half of them."""
    rows = found.samples.shape[0]
    parts = 3 if rows <= _ROWS_FINE else 1  # odd: the rows themselves are among the parts
    while parts * rows < _ROWS_MIN:
        parts += 2
    step = abs(found.place.dy) * (1.5 / parts if parts > 1 else 1.0)
    inside = min(max(2, math.ceil(_CLOSE / step)), _INSIDE_MAX)
    border = max(2, inside // 4)
    half = inside + border
    reach = (math.sqrt(2.0) * half + 3.0) * step
    lon, colatitude, heights, areas = _points(found, sign, parts, step, reach)
    mean = float(np.average(heights, weights=areas))
    rho = 2.0 * np.tan(0.5 * colatitude) / step
    x, y = rho * np.sin(lon), -sign * rho * np.cos(lon)
    fitted = _fitted(x, -y, heights - mean, areas, half)
    extent = step * radius_m * half
    place = Place(
        "stereographic", -extent, extent, step * radius_m, -step * radius_m,
        lat0_rad=sign * 0.5 * math.pi, radius_m=radius_m,
    )  # fmt: skip
    name = f"{found.name} ({'north' if sign > 0.0 else 'south'} pole)"
    return ElevationRaster(
        fitted.astype(np.float32),
        place,
        1.0,
        mean,
        name,
        found.interpolation,
        float(border),
        found.datum_m,
    )


def _points(
    found: ElevationRaster, sign: float, parts: int, step: float, reach: float
) -> tuple[F64, F64, F64, F64]:
    """Heights around a pole up to a distance of `reach`, rad, about `step` / 4 apart along rows:
    longitudes, distances from the pole (rad), heights, and areas (any unit)."""
    columns, place = found.samples.shape[1], found.place
    found_rows = []
    for row in _rows(found, sign, parts, reach):
        colatitude = 0.5 * math.pi - sign * (place.y0 + row * place.dy)
        wanted = max(8, math.ceil(2.0 * math.pi * math.sin(colatitude) / step * _PER_POST))
        if parts == 1 and wanted < columns:
            starts = np.arange(wanted) * columns // wanted
            ends = np.append(starts[1:], columns)
            sums = np.add.reduceat(found.samples[round(row)].astype(np.float64), starts)
            heights = found.scale_m * sums / (ends - starts) + found.offset_m
            lon = place.x0 + 0.5 * (starts + ends - 1) * place.dx
        else:
            lon = place.x0 + np.arange(wanted) * (2.0 * math.pi / wanted)
            posts = np.stack([(lon - place.x0) / place.dx, np.full(wanted, row)], axis=1)
            heights = found.heights(found.raster.directions(posts))
        area = max(math.sin(colatitude), step / 8.0) / len(lon)
        found_rows.append((lon, np.full(len(lon), colatitude), heights, np.full(len(lon), area)))
    lons, colatitudes, heights, areas = (
        np.concatenate(part) for part in zip(*found_rows, strict=True)
    )
    return lons, colatitudes, heights, areas


def _rows(found: ElevationRaster, sign: float, parts: int, reach: float) -> F64:
    """Rows, in `parts` parts each, from a pole outwards up to a distance of `reach`, rad."""
    rows, place = found.samples.shape[0], found.place
    outer = 0.0 if sign > 0.0 else rows - 1.0
    beyond = (0.5 * math.pi - sign * (place.y0 + outer * place.dy)) / abs(place.dy)
    count = math.ceil(parts * min(reach / abs(place.dy), rows - 1.0 + 2.0 * beyond))
    first = -beyond + (0.5 / parts if parts > 1 else beyond)
    return outer + sign * (first + np.arange(count) / parts)


def _fitted(x: F64, y: F64, values: F64, areas: F64, half: int) -> F64:
    """(2 half + 1, 2 half + 1) values at whole x and y, from points around them: the weighted plane
    through those within a post and a half."""
    side = 2 * half + 1
    moments = np.zeros((9, side * side))
    column, row = np.rint(x).astype(np.int64), np.rint(y).astype(np.int64)
    for i in (-1, 0, 1):
        for j in (-1, 0, 1):
            at_x, at_y = column + i, row + j
            inside = (np.abs(at_x) <= half) & (np.abs(at_y) <= half)
            u, v = (x - at_x)[inside], (y - at_y)[inside]
            weight, z = _spline(u) * _spline(v) * areas[inside], values[inside]
            index = (at_y[inside] + half) * side + at_x[inside] + half
            terms = (np.ones_like(u), u, v, u * u, u * v, v * v, z, u * z, v * z)
            for moment, term in zip(moments, terms, strict=True):
                moment += np.bincount(index, weight * term, side * side)
    w, wu, wv, wuu, wuv, wvv, *right = moments
    tiny = 1e-9 * w
    matrices = np.array([[w, wu, wv], [wu, wuu + tiny, wuv], [wv, wuv, wvv + tiny]])
    solved = np.linalg.solve(matrices.transpose(2, 0, 1), np.array(right).T[:, :, np.newaxis])
    return np.asarray(solved[:, 0, 0].reshape(side, side))


def _spline(t: F64) -> F64:
    """The quadratic B-spline."""
    far = np.abs(t)
    return np.where(far < 0.5, 0.75 - far * far, 0.5 * np.maximum(1.5 - far, 0.0) ** 2)
