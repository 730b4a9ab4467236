"""hover: above a point of a body's surface, looking down or obliquely."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.camera.trajectories.view import distance_noise_m, finished, uniform
from perilune.config.trajectory import Hover
from perilune.world import World

F64 = NDArray[np.float64]


def surface(radii_m: F64, normal: F64) -> F64:
    """The point of an ellipsoid whose outward normal is the unit vector `normal`, body axes.

    The gradient of sum (x_i / r_i)^2 is along `normal` where x_i is r_i^2 n_i over the root of
    sum (r_i n_i)^2; for two equal axes this is the usual geodetic formula.
    """
    return np.asarray(radii_m**2 * normal / np.linalg.norm(radii_m * normal))


def _foot(radii_m: F64, direction: F64, geodetic: bool) -> tuple[F64, F64]:
    """The point of an ellipsoid at a longitude and latitude, and its normal, body axes."""
    if geodetic:
        return surface(radii_m, direction), direction
    point = direction / np.linalg.norm(direction / radii_m)
    gradient = point / radii_m**2
    return point, gradient / np.linalg.norm(gradient)


def hover(world: World) -> F64:
    """Position and view rotate with the body."""
    spec = world.camera.trajectory
    assert isinstance(spec, Hover)
    rng = world.random("camera.place", spec.interval)
    lon = math.radians(uniform(rng, spec.lon_deg))
    low, high = (math.sin(math.radians(angle)) for angle in spec.lat_deg)
    lat = math.asin(uniform(rng, (low, high)))
    if spec.lat_deg[0] == spec.lat_deg[1]:
        lat = math.radians(spec.lat_deg[0])  # the arc sine loses digits near the poles
    height = uniform(rng, spec.height_m) + distance_noise_m(world, spec.distance_noise_m)
    lean = math.radians(uniform(rng, spec.off_nadir_deg))
    azimuth = math.radians(uniform(rng, spec.azimuth_deg))
    direction = np.array(
        [math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)]
    )
    body = world.config.bodies[spec.target]
    geodetic = body.is_geodetic if spec.latitudes is None else spec.latitudes == "geodetic"
    ground, normal = _foot(world.body_radii_m[spec.target], direction, geodetic)
    east = np.array([-math.sin(lon), math.cos(lon), 0.0])
    east -= (east @ normal) * normal  # none, but of three axes
    east /= np.linalg.norm(east)
    north = np.cross(normal, east)
    towards = math.cos(azimuth) * north + math.sin(azimuth) * east
    forward = math.sin(lean) * towards - math.cos(lean) * normal
    up = math.cos(lean) * towards + math.sin(lean) * normal
    shape = world.shapes.get(spec.target)
    if shape is not None:  # the heights count from it, where the vertical meets it
        height += shape.surface_m(normal, ground) or 0.0
    place = ground + height * normal

    def view(when: int) -> tuple[F64, F64]:
        body = world.poses[spec.target][when]
        where = body[:3] + rotations.rotate(body[3:], place)
        return where, rotations.multiply(body[3:], rotations.look_at(forward, up))

    return finished(world, spec, view)
