"""Where rasters lie on a body: the projection and the posts of _core.Raster."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

from perilune.config.elevation import CylindricalPlace, LocalPlace, PolarPlace

Geometry = Literal["geographic", "equirectangular", "stereographic", "orthographic"]


@dataclass(frozen=True)
class Place:
    """Projection, and places of the posts, in the words of _core.Raster."""

    projection: str
    x0: float
    """Of the first column's posts: rad (cylindrical) or m."""
    y0: float
    dx: float
    dy: float
    lon0_rad: float = 0.0
    lat0_rad: float = 0.0
    radius_m: float = 0.0
    """Of the sphere of the map; of cylindrical maps only what their file says, if anything."""
    map_scale: float = 1.0
    axis_ratio: float = 1.0

    def arguments(self) -> dict[str, Any]:
        """All of them, for _core.Raster."""
        return dict(vars(self))

    def goes_round(self, columns: int) -> bool:
        """Whether so many columns cover all longitudes, as _core.Raster takes them."""
        turn = 2.0 * math.pi / abs(self.dx)
        whole = round(turn)
        return self.projection == "cylindrical" and abs(turn - whole) <= 0.01 and columns >= whole

    def flipped(self, rows: int) -> Place:
        """The place of the same raster with its rows in the opposite order."""
        return replace(self, y0=self.y0 + (rows - 1) * self.dy, dy=-self.dy)


@dataclass(frozen=True)
class Reference:
    """A coordinate reference system, of those that files name."""

    geometry: Geometry
    """geographic: degrees; others: metres."""
    equatorial_m: float = 0.0
    """Radius of the sphere, or the ellipsoid's larger; 0: not known."""
    polar_m: float = 0.0
    lon0_deg: float = 0.0
    lat0_deg: float = 0.0
    true_lat_deg: float | None = None
    """Latitude at which the map is true to scale: of equirectangular and polar maps."""
    map_scale: float = 1.0
    """At the centre, of maps without a true latitude, or with that of the pole."""
    false_m: tuple[float, float] = (0.0, 0.0)
    """Easting and northing of the origin."""

    @property
    def round(self) -> bool:
        """Whether it is of a sphere."""
        return math.isclose(self.equatorial_m, self.polar_m, rel_tol=1e-9)

    def place(self, x0: float, y0: float, dx: float, dy: float) -> Place:
        """From coordinates of the first post and steps, in degrees or metres; ValueError for what
        is not supported."""
        ratio = self.polar_m / self.equatorial_m if self.polar_m > 0.0 else 1.0
        if self.geometry == "geographic":
            x0, y0, dx, dy = (math.radians(value) for value in (x0, y0, dx, dy))
            radius_m = self.equatorial_m
            return Place("cylindrical", x0, y0, dx, dy, radius_m=radius_m, axis_ratio=ratio)
        if self.equatorial_m <= 0.0:
            raise ValueError("a projection in metres without a radius")
        x0, y0 = x0 - self.false_m[0], y0 - self.false_m[1]
        lon0, lat0 = math.radians(self.lon0_deg), math.radians(self.lat0_deg)
        if self.geometry == "equirectangular":
            down = 1.0 / self.equatorial_m
            across = down / math.cos(math.radians(self.true_lat_deg or 0.0))
            x0, y0 = lon0 + across * x0, lat0 + down * y0
            return Place(
                "cylindrical", x0, y0, across * dx, down * dy,
                radius_m=self.equatorial_m, axis_ratio=ratio,
            )  # fmt: skip
        if not self.round:
            what = f"a {self.geometry} map of an ellipsoid ({self.equatorial_m:g}"
            raise ValueError(f"{what} x {self.polar_m:g} m); supported are those of spheres")
        scale = self.map_scale
        if self.geometry == "stereographic" and abs(self.true_lat_deg or 90.0) < 90.0:
            if abs(self.lat0_deg) < 90.0:
                raise ValueError("a stereographic map with a true latitude that is not polar")
            scale = 0.5 * (1.0 + math.sin(math.radians(abs(self.true_lat_deg or 90.0))))
        return Place(self.geometry, x0, y0, dx, dy, lon0, lat0, self.equatorial_m, scale)


def given(
    section: CylindricalPlace | PolarPlace | LocalPlace,
    shape: tuple[int, int],
    radius_m: float,
    axis_ratio: float,
) -> Place:
    """The place that a configuration gives. shape: rows and columns; radius_m: of the datum;
    axis_ratio: polar over equatorial radius, if latitudes are geodetic by default."""
    height, width = shape
    if isinstance(section, CylindricalPlace):
        east = section.west_deg + 360.0 if section.east_deg is None else section.east_deg
        cells = section.edges == "cells"
        across, down = (width, height) if cells else (width - 1, height - 1)
        if across < 1 or down < 1:
            raise ValueError("projection.edges: 'posts' needs two rows and columns at least")
        dx = math.radians(east - section.west_deg) / across
        dy = -math.radians(section.north_deg - section.south_deg) / down
        x0, y0 = math.radians(section.west_deg), math.radians(section.north_deg)
        half = 0.5 if cells else 0.0
        return Place("cylindrical", x0 + half * dx, y0 + half * dy, dx, dy, axis_ratio=axis_ratio)
    step = section.post_m
    x0 = section.center_m[0] - 0.5 * (width - 1) * step
    y0 = section.center_m[1] + 0.5 * (height - 1) * step
    if isinstance(section, PolarPlace):
        lat_deg = 90.0 if section.pole == "north" else -90.0
        lon_deg, kind = section.center_lon_deg, "stereographic"
    else:
        (lon_deg, lat_deg), kind = section.center_lon_lat_deg, "orthographic"
    angles = math.radians(lon_deg), math.radians(lat_deg)
    return Place(kind, x0, y0, step, -step, *angles, radius_m)
