"""A drive over the ground of a body."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from perilune.config.orbit import Traverse
from perilune.orbits.ground import way_stance
from perilune.orbits.place import Motion, Place
from perilune.orbits.riding import Ride

F64 = NDArray[np.float64]


def traverse(orbit: Traverse, place: Place) -> Motion:
    """Along the curve at a constant speed, from the epoch to its end."""
    ground = place.setting.ground(orbit.around)
    feet, footprint = place.feet_m, orbit.footprint_m or place.footprint_m

    def state(t_s: float) -> tuple[F64, F64]:
        stance = way_stance(ground, orbit, orbit.speed_m_s * t_s, footprint)
        return stance.point_m + (orbit.height_m + feet) * stance.axes[:, 2], stance.axes

    return Ride(place.setting, orbit.around, state)
