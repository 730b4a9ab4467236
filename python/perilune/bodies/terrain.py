"""The ground of a body from its section `terrain`: the core's heights, and what stands on them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base.curves import curve
from perilune.bodies.craters import crater_field
from perilune.bodies.elevation import ElevationRaster
from perilune.bodies.polar import with_patches
from perilune.bodies.rocks import RockModel, rock_field
from perilune.bodies.roughness import BEND, of_elevation
from perilune.config.terrain import Detail, Patch, Terrain
from perilune.config.tracks import Track
from perilune.orbits.ground import Ground

F64 = NDArray[np.float64]
Textures = tuple[_core.Raster | None, _core.Raster | None, _core.Raster | None]
"""Images of heights, roughness and albedo."""


def _detail(given: Detail) -> dict[str, Any]:
    """The keys of the core's detail that are given."""
    keys: dict[str, Any] = {
        "method": given.method, "seed": given.seed, "strength": given.strength
    }  # fmt: skip
    for name in ("baseline_m", "deviation_m", "longest_m", "finest_m"):
        if getattr(given, name) is not None:
            keys[name] = getattr(given, name)
    if given.hurst is not None:
        keys["ranges"] = [(0.0, given.hurst)]
    if given.ranges is not None:
        keys["ranges"] = [(row.from_m, row.hurst) for row in given.ranges]
    return keys


def _measured(model: ElevationRaster, radius_m: float) -> dict[str, Any]:
    """The keys of the core's detail for the law of a model."""
    found = of_elevation(model, radius_m)
    if found is None:
        raise ValueError(f"detail.from_elevation: {model.name}: is flat, or has too few posts")
    law = {"baseline_m": found.baseline_m, "deviation_m": found.deviation_m}
    return {"ranges": [(0.0, found.hurst)], **law}


def remarks_of(given: Terrain, radii_m: F64, rasters: Sequence[ElevationRaster]) -> list[str]:
    """Remarks on the law of detail that is taken from a model, one per line."""
    if given.detail is None or not given.detail.from_elevation:
        return []
    found = of_elevation(rasters[-1], float(radii_m[0]))
    if found is None or abs(found.bend) <= BEND:
        return []
    kind = (
        "smoothed, or flatter over longer distances" if found.bend > 0.0 else "noisy or has steps"
    )
    return [
        f"heights over 1 to 8 posts follow no power law: {rasters[-1].name} is {kind}; the Hurst "
        f"exponent of {found.hurst:.2f} may be wrong; give hurst and deviation_m instead"
    ]


def _sheets(rasters: Sequence[ElevationRaster], radius_m: float) -> list[tuple[Any, float]]:
    whole = [patch for row in rasters for patch in with_patches(row, radius_m)]
    return [(row.raster, row.border_posts) for row in whole]


def _patch(given: Patch) -> tuple[tuple[float, float, float], float]:
    lon, lat = (math.radians(angle) for angle in given.center_lon_lat_deg)
    return (
        (math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)),
        given.side_m,
    )


def core_terrain(
    given: Terrain,
    radii_m: F64,
    rasters: Sequence[ElevationRaster],
    albedo: Sequence[ElevationRaster] = (),
    roughness: Sequence[ElevationRaster] = (),
    catalogue: NDArray[np.void] | None = None,
    mask: Sequence[ElevationRaster] = (),
    geodetic: bool = False,
    textures: Sequence[Textures] = (),
    rock_models: Sequence[RockModel] = (),
) -> _core.Terrain:
    """The core's ground of a section. rasters, albedo, roughness, mask: what its keys were read
    to; those that reach a pole get a patch over it, but not masks.
    catalogue: of CATALOGUED. geodetic: the latitudes of sites. textures: what
    textures were read to. rock_models: what models of rocks were read to. Raises ValueError."""
    whole = [patch for row in rasters for patch in with_patches(row, float(radii_m[0]))]
    layers = [
        (row.raster, row.interpolation, row.border_posts, row.datum_m, row.apron_m) for row in whole
    ]
    detail = None if given.detail is None else _detail(given.detail)
    if detail is not None and given.detail is not None and given.detail.from_elevation:
        detail |= _measured(rasters[-1], float(radii_m[0]))
    radius_m = float(np.cbrt(np.prod(radii_m)))
    known, below_m = None, math.inf
    if catalogue is not None and len(catalogue) > 0:
        known = np.column_stack([catalogue["direction"], catalogue["diameter_m"]])
        below_m = float(catalogue["diameter_m"].min())
    craters = None if given.craters is None else crater_field(given.craters, radius_m, below_m)
    rocks = None if given.rocks is None else rock_field(given.rocks, radius_m, rock_models)
    sheets = tuple(_sheets(rows, float(radii_m[0])) for rows in (albedo, roughness))
    baseline_m = given.roughness_baseline_m
    masks = [(row.raster, row.border_posts) for row in mask]
    patch = None if given.patch is None else _patch(given.patch)
    return _core.Terrain(
        radii_m,
        layers,
        detail,
        craters,
        rocks,
        sheets[0],
        sheets[1],
        baseline_m,
        known,
        masks,
        patch,
        [_track(track, radii_m, geodetic) for track in given.tracks],
        [
            (*images, row.size_m, row.seed)
            for images, row in zip(textures, given.textures, strict=True)
        ],
    )


def _track(given: Track, radii_m: F64, geodetic: bool) -> tuple[Any, ...]:
    """A track of the core, on the ellipsoid."""
    ground = Ground(radii_m, geodetic)
    site, normal, north = ground.site(given)
    plane = curve(given.waypoints_m).points
    places = site + plane[:, :1] * np.cross(north, normal) + plane[:, 1:] * north
    directions = places / np.linalg.norm(places, axis=1, keepdims=True)
    grousers = given.grousers
    bars = (
        (0.0, 0.0, 0.0)
        if grousers is None
        else (grousers.spacing_m, grousers.depth_m, math.radians(grousers.angle_deg))
    )
    return (
        directions * ground.datum_m(directions)[:, None],
        given.gauge_m,
        given.wheel_width_m,
        given.depth_m,
        *bars,
        given.albedo,
    )


def ground_of(terrain: _core.Terrain, radii_m: F64, geodetic: bool) -> Ground:
    """What stands on the ground asks this: its heights with all detail."""

    def surface_m(directions: F64) -> F64:
        datum = 1.0 / np.linalg.norm(directions / radii_m, axis=-1)
        return np.asarray(datum + terrain.heights(directions))

    return Ground(radii_m, geodetic, surface_m, terrain.bounds)
