"""hover: above a point of a body's surface, looking down or obliquely."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.camera.trajectories.view import distance_noise_m, finished, uniform
from perilune.config.trajectory import Hover
from perilune.orbits.ground import foot, spherical
from perilune.world import World

F64 = NDArray[np.float64]


def _ground_m(world: World, name: str, place: F64, normal: F64) -> float:
    """Height of the ground over a point of the ellipsoid, along the vertical."""
    shape = world.shapes.get(name)
    if shape is not None:
        return shape.surface_m(normal, place) or 0.0
    return world.ground(name).over(place, normal)


def hover(world: World) -> F64:
    """Position and view rotate with the body."""
    spec = world.camera.trajectory
    assert isinstance(spec, Hover)
    rng = world.brief_random("camera.place", spec.interval)
    lon = math.radians(uniform(rng, spec.lon_deg))
    low, high = (math.sin(math.radians(angle)) for angle in spec.lat_deg)
    lat = math.asin(uniform(rng, (low, high)))
    if spec.lat_deg[0] == spec.lat_deg[1]:
        lat = math.radians(spec.lat_deg[0])  # the arc sine loses digits near the poles
    height = uniform(rng, spec.height_m) + distance_noise_m(world, spec.distance_noise_m)
    lean = math.radians(uniform(rng, spec.off_nadir_deg))
    azimuth = math.radians(uniform(rng, spec.azimuth_deg))
    direction = spherical(lon, lat)
    body = world.config.bodies[spec.target]
    geodetic = body.is_geodetic if spec.latitudes is None else spec.latitudes == "geodetic"
    ground, normal = foot(world.body_radii_m[spec.target], direction, geodetic)
    east = np.array([-math.sin(lon), math.cos(lon), 0.0])
    east -= (east @ normal) * normal  # none, but of three axes
    east /= np.linalg.norm(east)
    north = np.cross(normal, east)
    towards = math.cos(azimuth) * north + math.sin(azimuth) * east
    forward = math.sin(lean) * towards - math.cos(lean) * normal
    up = math.cos(lean) * towards + math.sin(lean) * normal
    if spec.altitude_above != "datum":
        height += _ground_m(world, spec.target, ground, normal)
    place = ground + height * normal

    def view(when: int) -> tuple[F64, F64]:
        body = world.poses[spec.target][when]
        where = body[:3] + rotations.rotate(body[3:], place)
        return where, rotations.multiply(body[3:], rotations.look_at(forward, up))

    return finished(world, spec, view)
