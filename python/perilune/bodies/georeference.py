"""Where GeoTIFF files and what rasterio reads lie: their coordinate systems (OGC 19-008, PROJ)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from perilune.bodies.places import Geometry, Place, Reference

if TYPE_CHECKING:
    from tifffile import TiffPage

_PROJECTED, _GEOGRAPHIC = 1, 2
_POINT = 2
_POLAR = 15
_TRANSFORMS: dict[int, Geometry] = {
    14: "stereographic",
    _POLAR: "stereographic",
    17: "equirectangular",
    21: "orthographic",
}
"""ProjCoordTransGeoKey -> projection."""
_WGS84 = (6378137.0, 6378137.0 * (1.0 - 1.0 / 298.257223563))
_AXES = {4326: _WGS84, 4269: (6378137.0, 6378137.0 * (1.0 - 1.0 / 298.257222101))}
"""GeographicTypeGeoKey -> equatorial and polar radius, m."""
_PROJ: dict[str, Geometry] = {
    "longlat": "geographic",
    "latlong": "geographic",
    "eqc": "equirectangular",
    "stere": "stereographic",
    "ortho": "orthographic",
}
_ELLIPSOIDS = {"WGS84": _AXES[4326], "GRS80": _AXES[4269]}
_NUMBERS = ("lon_0", "lat_0", "lat_ts", "k_0", "k", "x_0", "y_0")
_SUPPORTED = "supported: geographic, equirectangular, polar stereographic, orthographic"


def of_page(page: TiffPage) -> Place | None:
    """The place of a TIFF's first image; None without GeoTIFF keys. ValueError for a reference that
    is not supported."""
    keys = page.geotiff_tags
    if not keys or "GTModelTypeGeoKey" not in keys:
        return None
    x0, y0, dx, dy = _grid(keys)
    if int(keys.get("GTRasterTypeGeoKey", 1)) != _POINT:
        x0, y0 = x0 + 0.5 * dx, y0 + 0.5 * dy
    return _reference(keys).place(x0, y0, dx, dy)


def _grid(keys: Mapping[str, Any]) -> tuple[float, float, float, float]:
    """Coordinates of the first pixel's tie point, and steps."""
    if "ModelTransformation" in keys:
        rows = [float(value) for row in keys["ModelTransformation"] for value in _flat(row)]
        if rows[1] != 0.0 or rows[4] != 0.0:
            raise ValueError("a rotated GeoTIFF; supported are those with north up")
        return rows[3], rows[7], rows[0], rows[5]
    if missing := {"ModelTiepoint", "ModelPixelScale"} - set(keys):
        raise ValueError(f"GeoTIFF keys without {', '.join(sorted(missing))}")
    column, row, _, x, y = (float(value) for value in keys["ModelTiepoint"][:5])
    dx, dy = float(keys["ModelPixelScale"][0]), -float(keys["ModelPixelScale"][1])
    return x - column * dx, y - row * dy, dx, dy


def _flat(value: Any) -> list[Any]:
    return list(value) if hasattr(value, "__len__") else [value]


def _radii(keys: Mapping[str, Any]) -> tuple[float, float]:
    code = int(keys.get("GeographicTypeGeoKey", 0))
    if "GeogSemiMajorAxisGeoKey" not in keys:
        return _AXES.get(code, (0.0, 0.0))
    equatorial_m = float(keys["GeogSemiMajorAxisGeoKey"])
    inverse = float(keys.get("GeogInvFlatteningGeoKey", 0.0))
    polar_m = equatorial_m * (1.0 - 1.0 / inverse) if inverse > 0.0 else equatorial_m
    return equatorial_m, float(keys.get("GeogSemiMinorAxisGeoKey", polar_m))


def _reference(keys: Mapping[str, Any]) -> Reference:
    def number(*names: str) -> float:
        found = [float(keys[f"Proj{name}GeoKey"]) for name in names if f"Proj{name}GeoKey" in keys]
        return found[0] if found else 0.0

    equatorial_m, polar_m = _radii(keys)
    model = int(keys["GTModelTypeGeoKey"])
    if model == _GEOGRAPHIC:
        if equatorial_m <= 0.0:
            raise ValueError("a geographic grid on an ellipsoid that the file does not define")
        return Reference("geographic", equatorial_m, polar_m)
    transform = int(keys.get("ProjCoordTransGeoKey", 0))
    geometry = _TRANSFORMS.get(transform)
    if model != _PROJECTED or geometry is None:
        name = keys.get("GTCitationGeoKey", keys.get("PCSCitationGeoKey", f"model {model}"))
        raise ValueError(f"the projection of '{name}'; {_SUPPORTED}")
    lat0_deg = number("NatOriginLat", "CenterLat")
    true_lat_deg = number("StdParallel1") if "ProjStdParallel1GeoKey" in keys else None
    if transform == _POLAR:  # the latitude of the origin is that of true scale
        true_lat_deg, lat0_deg = lat0_deg, 90.0 if lat0_deg > 0.0 else -90.0
    elif geometry == "equirectangular" and true_lat_deg is None:
        true_lat_deg, lat0_deg = lat0_deg, 0.0
    return Reference(
        geometry,
        equatorial_m,
        polar_m,
        number("StraightVertPoleLong", "NatOriginLong", "CenterLong"),
        lat0_deg,
        true_lat_deg,
        number("ScaleAtNatOrigin", "ScaleAtCenter") or 1.0,
        (number("FalseEasting", "CenterEasting"), number("FalseNorthing", "CenterNorthing")),
    )


def of_proj(words: Mapping[str, Any], transform: Any) -> Place:
    """The place by a PROJ dictionary and an affine transform (a, b, c, d, e, f) of corners."""
    a, b, c, d, e, f = (float(value) for value in tuple(transform)[:6])
    if b != 0.0 or d != 0.0:
        raise ValueError("a rotated raster; supported are those with north up")
    geometry = _PROJ.get(str(words.get("proj")))
    if geometry is None:
        raise ValueError(f"the projection '{words.get('proj')}'; {_SUPPORTED}")
    equatorial_m, polar_m = _proj_radii(words)
    if equatorial_m <= 0.0:
        raise ValueError("a coordinate system without the radii of its ellipsoid")
    unit = words.get("units", "m")
    if geometry != "geographic" and unit != "m":
        raise ValueError(f"coordinates in units of {unit}; supported: m")
    given = {key: float(words[key]) for key in _NUMBERS if key in words}
    reference = Reference(
        geometry,
        equatorial_m,
        polar_m,
        given.get("lon_0", 0.0),
        given.get("lat_0", 0.0),
        given.get("lat_ts"),
        given.get("k_0", given.get("k", 1.0)),
        (given.get("x_0", 0.0), given.get("y_0", 0.0)),
    )
    return reference.place(c + 0.5 * a, f + 0.5 * e, a, e)


def _proj_radii(words: Mapping[str, Any]) -> tuple[float, float]:
    if "R" in words:
        return float(words["R"]), float(words["R"])
    if "a" in words:
        equatorial_m = float(words["a"])
        if "rf" in words and float(words["rf"]) > 0.0:
            return equatorial_m, equatorial_m * (1.0 - 1.0 / float(words["rf"]))
        return equatorial_m, float(words.get("b", equatorial_m))
    return _ELLIPSOIDS.get(str(words.get("ellps", words.get("datum"))), (0.0, 0.0))
