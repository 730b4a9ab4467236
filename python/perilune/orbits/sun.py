"""Where the Sun is."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.config.schema import Config
from perilune.config.sun import SiteSun
from perilune.orbits import solar_system
from perilune.orbits.almanac import almanac
from perilune.orbits.ground import foot, north_of, spherical
from perilune.orbits.riding import body_axes
from perilune.orbits.setting import Setting, ephemeris_name, radii_m
from perilune.orbits.solar_system import Date

F64 = NDArray[np.float64]


def sun_position_m(config: Config, epoch: Date, t_s: float) -> F64:
    """Position (3,) of the Sun's centre in the root frame, t_s seconds after the epoch."""
    distance_m = config.sun.distance_au * solar_system.AU_M
    if config.sun.at is not None:
        return _over_site(config, config.sun.at, epoch, t_s, distance_m)
    if config.sun.direction is not None:
        return np.array(config.sun.direction) * distance_m
    origin = ephemeris_name(config, config.root)
    assert origin is not None  # the root always has one
    return almanac(config).relative_m("sun", origin, epoch.after(t_s))


def _over_site(config: Config, at: SiteSun, epoch: Date, t_s: float, distance_m: float) -> F64:
    body = config.bodies[config.root]
    geodetic = body.is_geodetic if at.latitudes is None else at.latitudes == "geodetic"
    direction = spherical(math.radians(at.lon_deg), math.radians(at.lat_deg))
    place, up = foot(radii_m(body), direction, geodetic)
    north = north_of(up, at.lon_deg)
    azimuth, elevation = math.radians(at.azimuth_deg), math.radians(at.elevation_deg)
    flat = math.cos(azimuth) * north + math.sin(azimuth) * np.cross(north, up)
    way = math.cos(elevation) * flat + math.sin(elevation) * up
    alone = Setting(config, epoch, 0, lambda text, _: Path(text), lambda _: 0.0)
    (axes,) = body_axes(alone, config.root, np.array([t_s]))
    return rotations.rotate(axes, place + distance_m * way)
