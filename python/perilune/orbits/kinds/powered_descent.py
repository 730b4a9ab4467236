"""A gravity turn with throttle, from a state to the touch-down, after which it stands."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from perilune.config.orbit import PoweredDescent
from perilune.orbits.descent import track
from perilune.orbits.place import Motion, Place
from perilune.orbits.riding import Ride, field_of

F64 = NDArray[np.float64]


def powered_descent(orbit: PoweredDescent, place: Place) -> Motion:
    """From the epoch on. ValueError that names the key if no throttle does it."""
    ground = place.setting.ground(orbit.around)
    feet, footprint = place.feet_m, orbit.footprint_m or place.footprint_m
    found = track(orbit, ground, field_of(place.setting, orbit.around), feet)

    def state(t_s: float) -> tuple[F64, F64]:
        if t_s < found.end_s:
            return found.state(t_s)[0], found.axes(t_s)
        stance = ground.stance(found.feet_m, found.axes(t_s)[:, 0], footprint)
        return stance.point_m + feet * stance.axes[:, 2], stance.axes

    return Ride(place.setting, orbit.around, state)
