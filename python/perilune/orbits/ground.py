"""The ground of a body: its points, heights, and how something stands on it. Body axes, metres."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from perilune.base.curves import curve
from perilune.config.standing import Place, Way

F64 = NDArray[np.float64]
Surface = Callable[[F64], F64]
"""Unit directions (n, 3) from a body's centre -> distance of its ground from there (n,)."""

_MARCH = 1024
_GRID = 5
"""Heights along each side of a footprint."""


def surface(radii_m: F64, normal: F64) -> F64:
    """The point of an ellipsoid whose outward normal is the unit vector `normal`, body axes.

    The gradient of sum (x_i / r_i)^2 is along `normal` where x_i is r_i^2 n_i over the root of
    sum (r_i n_i)^2; for two equal axes this is the usual geodetic formula.
    """
    return np.asarray(radii_m**2 * normal / np.linalg.norm(radii_m * normal))


def foot(radii_m: F64, direction: F64, geodetic: bool) -> tuple[F64, F64]:
    """The point of an ellipsoid at a longitude and latitude, and its normal, body axes."""
    if geodetic:
        return surface(radii_m, direction), direction
    point = direction / np.linalg.norm(direction / radii_m)
    return point, vertical(radii_m, point)


def vertical(radii_m: F64, point: F64) -> F64:
    """The unit normal of the ellipsoid through a point that is like the body's."""
    gradient = point / radii_m**2
    return np.asarray(gradient / np.linalg.norm(gradient))


def spherical(lon: float, lat: float) -> F64:
    """Unit vector of a longitude and latitude, radians."""
    return np.array([math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)])


def north_of(normal: F64, lon_deg: float) -> F64:
    """The unit vector across `normal` that points to the north pole; at a pole away from the
    longitude, as on its meridian."""
    lon = math.radians(lon_deg)
    east = np.array([-math.sin(lon), math.cos(lon), 0.0])
    east -= (east @ normal) * normal  # none, but of three axes
    return np.asarray(np.cross(normal, east / np.linalg.norm(east)))


@dataclass(frozen=True)
class Stance:
    """A place on the ground, in body axes."""

    point_m: F64
    """(3,)"""
    axes: F64
    """(3, 3), columns: forward, left, up."""


def _through(origin: F64, direction: F64, radii_m: F64) -> tuple[float, float] | None:
    """Distances at which a line enters and leaves an ellipsoid; None if it misses."""
    p, d = origin / radii_m, direction / radii_m
    a, b = float(d @ d), float(p @ d)
    nearest = p - d * (b / a)
    inside = 1.0 - float(nearest @ nearest)
    if inside < 0.0:
        return None
    half = math.sqrt(inside / a)
    return -b / a - half, -b / a + half


@dataclass(frozen=True, eq=False)
class Ground:
    """The ellipsoid of a body, and what lies over it. Compared by identity, so that what follows
    from it can be kept."""

    radii_m: F64
    geodetic: bool
    """Whether latitudes are geodetic unless a section says otherwise."""
    surface_m: Surface | None = None
    """The true ground; None for a smooth ellipsoid."""
    bounds_m: tuple[float, float] | None = None
    """Bounds of the heights of a terrain over the ellipsoid; None for a shape or a smooth
    ellipsoid."""

    def datum_m(self, directions: F64) -> F64:
        """Distance (n,) of the ellipsoid from the centre along unit directions (n, 3)."""
        return np.asarray(1.0 / np.linalg.norm(directions / self.radii_m, axis=-1))

    def ground_m(self, directions: F64) -> F64:
        """Distance (n,) of the ground from the centre along unit directions (n, 3)."""
        return self.datum_m(directions) if self.surface_m is None else self.surface_m(directions)

    def height_m(self, point: F64, above: str | None = None) -> float:
        """Height of a point over the ground, or above: datum over the ellipsoid, radially."""
        distance = float(np.linalg.norm(point))
        direction = (point / distance if distance > 0.0 else np.eye(3)[0])[np.newaxis]
        base = self.datum_m if above == "datum" else self.ground_m
        return distance - float(base(direction)[0])

    def hit_m(self, origin: F64, direction: F64) -> float | None:
        """Distance to a terrain along a ray of unit direction (3,); None without a hit, 0 from
        below it.

        Heights are asked for at places along the ray that get closer towards its origin: hills
        narrower than 1/500 of their distance may be missed."""
        assert self.bounds_m is not None  # of a terrain only
        low, high = self.bounds_m
        if self.height_m(origin) <= 0.0:
            return 0.0
        span = _through(origin, direction, self.radii_m + high)
        if span is None or span[1] <= 0.0:
            return None
        start, end = max(span[0], 0.0), span[1]
        inner = _through(origin, direction, self.radii_m + low)
        if inner is not None and inner[0] > start:
            end = min(end, inner[0])
        steps = np.concatenate(
            [[0.0], np.geomspace(min(0.01, 0.5 * (end - start)), end - start, _MARCH)]
        )
        along = start + np.union1d(steps, np.linspace(0.0, end - start, _MARCH))
        below = np.flatnonzero(self._heights_m(origin + along[:, None] * direction) <= 0.0)
        if not len(below):
            return None if inner is None or inner[0] <= start else end
        k = max(int(below[0]), 1)
        a, b = float(along[k - 1]), float(along[k])
        for _ in range(60):
            middle = 0.5 * (a + b)
            under = self.height_m(origin + middle * direction) <= 0.0
            a, b = (a, middle) if under else (middle, b)
        return b

    def _heights_m(self, points: F64) -> F64:
        distances = np.linalg.norm(points, axis=1)
        return np.asarray(distances - self.ground_m(points / distances[:, None]))

    def over(self, place: F64, normal: F64) -> float:
        """Height of the ground over a point of the ellipsoid, along its normal."""
        height = 0.0
        for _ in range(8 if self.surface_m is not None else 0):
            at = place + height * normal
            size = float(np.linalg.norm(at))
            miss = float(self.ground_m((at / size)[np.newaxis])[0]) - size
            height += miss * size / float(at @ normal)
            if abs(miss) < 1e-9 * size:
                break
        return height

    def site(self, spec: Place) -> tuple[F64, F64, F64]:
        """Point of the ellipsoid at a site, the vertical there, and the unit vector to the
        north."""
        geodetic = self.geodetic if spec.latitudes is None else spec.latitudes == "geodetic"
        direction = spherical(math.radians(spec.lon_deg), math.radians(spec.lat_deg))
        place, normal = foot(self.radii_m, direction, geodetic)
        return place, normal, north_of(normal, spec.lon_deg)

    def stance(
        self,
        toward: F64,
        forward: F64,
        footprint_m: tuple[float, float] | None,
        level: bool = False,
        datum: bool = False,
    ) -> Stance:
        """How something stands on the ground in a direction (3,) from the centre.

        forward: (3,), its heading, which need not be horizontal. footprint_m: length along the
        heading and width, under which the ground is taken for the plane that fits best; None: the
        ground's height at one point, and no tilt. level: up is the vertical. datum: on the
        ellipsoid instead."""
        base = self.datum_m if datum else self.ground_m
        toward = toward / np.linalg.norm(toward)
        up = vertical(self.radii_m, toward * self.datum_m(toward[np.newaxis])[0])
        ahead = forward - (forward @ up) * up
        ahead /= np.linalg.norm(ahead)
        left = np.cross(up, ahead)
        if footprint_m is None:
            return Stance(toward * base(toward[np.newaxis])[0], np.column_stack([ahead, left, up]))
        at = toward * base(toward[np.newaxis])[0]
        shares = np.linspace(-0.5, 0.5, _GRID)
        x, y = (grid.ravel() for grid in np.meshgrid(*(side * shares for side in footprint_m)))
        around = at + x[:, None] * ahead + y[:, None] * left
        around /= np.linalg.norm(around, axis=1)[:, None]
        around = around * base(around)[:, None] - at
        x, y, z = around @ ahead, around @ left, around @ up
        design = np.column_stack([np.ones_like(x), x, y])
        (raised, slope, tilt), *_ = np.linalg.lstsq(design, z, rcond=None)
        at = at + raised * up
        if not level:
            ahead, up = ahead + slope * up, up - slope * ahead - tilt * left
            ahead /= np.linalg.norm(ahead)
            up /= np.linalg.norm(up)
            left = np.cross(up, ahead)
        return Stance(at, np.column_stack([ahead, left, up]))


def way_stance(
    ground: Ground, spec: Way, along_m: float, footprint_m: tuple[float, float] | None
) -> Stance:
    """How something stands on a way at a length from its start, clipped to the way."""
    site, normal, north = ground.site(spec)
    (east_m, north_m), (east_t, north_t) = curve(spec.waypoints_m).at(along_m)
    east = np.cross(north, normal)
    place = site + east_m * east + north_m * north
    ahead = east_t * east + north_t * north
    datum = spec.altitude_above == "datum"
    return ground.stance(place, ahead, footprint_m, spec.level, datum)


@lru_cache(maxsize=64)
def smooth(radii_m: tuple[float, float, float], geodetic: bool) -> Ground:
    """The ground of a body without relief: the same object for the same ellipsoid."""
    return Ground(np.array(radii_m), geodetic)
