"""Numerically integrated orbits."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.config.attitude import Spin
from perilune.config.body import Body
from perilune.config.motion import sections
from perilune.config.orbit import Numerical
from perilune.orbits import forces
from perilune.orbits.almanac import almanac
from perilune.orbits.kinds.elements import two_body
from perilune.orbits.motion import propagator
from perilune.orbits.place import Motion, Place
from perilune.orbits.turns import spin_of

F64 = NDArray[np.float64]

_Z = np.array([0.0, 0.0, 1.0])


def _turning(place: Place) -> dict[str, Any] | None:
    """Rotation of the central body in the form of the forces; None if unknown."""
    _, entry = sections(place.setting.config)[place.around]
    if isinstance(entry, Body) and isinstance(entry.rotation, Spin):
        q, axis, rate = spin_of(entry.rotation, place.step_s)
        if rate == 0.0:
            return {"q": q, "rate_rad_s": 0.0}
        upright = float(axis @ _Z) / float(np.linalg.norm(axis))
        if abs(upright) < 1.0 - 1e-12:
            raise ValueError(
                f"bodies.{place.around}.rotation: about another axis than z: how its gravity and "
                "air turn is not modelled"
            )
        return {"q": q, "rate_rad_s": rate if upright > 0.0 else -rate}
    table = place.parent.table
    return None if table is None else forces.turning_of(table, place.epoch)


def _start(orbit: Numerical, place: Place) -> F64:
    """State at the epoch of the osculating two-body orbit; ICRF axes."""
    state: F64 = propagator(two_body(orbit, place), place.epoch).states(np.zeros(1))[0]
    return state


def numerical(orbit: Numerical, place: Place) -> Motion:
    """An orbit from elements or a state that osculate at the epoch."""
    parent = place.parent
    centre = forces.Centre(
        parent.name,
        parent.table,
        parent.gm_m3_s2,
        parent.radii_m,
        _turning(place),
        almanac(place.setting.config),
    )

    def file(text: str, key: str) -> Path:
        return place.file(text, f"forces.{key}")

    try:
        acting = forces.specification(orbit.forces, centre, place.epoch, file)
    except ValueError as error:
        raise ValueError(f"forces: {error}") from None
    return {
        "kind": "numerical",
        "gm": parent.gm_m3_s2,
        "state": _start(orbit, place),
        "rtol": orbit.rtol,
        # The bounding sphere of a spacecraft may hold orbits: its own shape is not known here.
        "surface_m": float(parent.radii_m.min()) if parent.is_body else 0.0,
        **acting,
    }
