"""What stands on the ground of a body."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from perilune.config.orbit import Surface
from perilune.orbits.place import Motion, Place
from perilune.orbits.riding import Ride

F64 = NDArray[np.float64]


def surface(orbit: Surface, place: Place) -> Motion:
    """At rest in the body's axes."""
    ground = place.setting.ground(orbit.around)
    point, normal, north = ground.site(orbit)
    heading = math.radians(orbit.heading_deg)
    ahead = math.cos(heading) * north + math.sin(heading) * np.cross(north, normal)
    feet, footprint = place.feet_m, orbit.footprint_m or place.footprint_m
    datum = orbit.altitude_above == "datum"
    stance = ground.stance(point, ahead, footprint, orbit.level, datum)
    stood = stance.point_m + (orbit.height_m + feet) * stance.axes[:, 2], stance.axes
    return Ride(place.setting, orbit.around, lambda t_s: stood)
