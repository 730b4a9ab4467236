"""The scaled circle of the Space OAISYS paper, traversed at a constant rate."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.config.orbit import Circular
from perilune.orbits.place import Motion, Place

F64 = NDArray[np.float64]


def path(place: Place, scale: F64, q: F64, v_step: float, start: float) -> dict[str, Any]:
    """The core's path: scale (3,) in radii of the parent, q from the path's axes to ICRF."""
    return {
        "kind": "circular",
        "radii_m": np.asarray(scale) * place.parent.radii_m,
        "q": q,
        "start_rev": start,
        "rate_rev_s": v_step / place.step_s if v_step else 0.0,
    }


def circular(orbit: Circular, place: Place) -> Motion:
    """A circular orbit from its section."""
    q = rotations.from_rpy_deg(orbit.rotation_deg)
    return path(place, np.array(orbit.scale), q, orbit.v_step, orbit.orbit_start)
