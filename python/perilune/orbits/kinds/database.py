"""Orbits drawn once a scene from the classes of the database."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.config.orbit import Database, Drawn
from perilune.orbits import orbit_classes
from perilune.orbits.centre import centre_of, equator, frame_of
from perilune.orbits.drawn import run_through, start_rev
from perilune.orbits.kinds.circular import path
from perilune.orbits.place import Motion, Place
from perilune.orbits.setting import KM

F64 = NDArray[np.float64]


def _ranges(orbit: Database) -> dict[str, tuple[float, float]]:
    found = {key: getattr(orbit, key) for key in orbit_classes.KEYS}
    return {key: value for key, value in found.items() if value is not None}


def _circle(orbit: Drawn, place: Place, elements: dict[str, Any], of_date: bool) -> Motion:
    """A scaled circle with an orbit's size and plane: the same altitude above each semi-axis."""
    parent = place.parent
    assert orbit.v_step is not None  # the schema asks for it
    if "altitude_km" in elements:
        altitude = elements["altitude_km"] * KM
    else:
        altitude = elements["semi_major_axis_km"] * KM - parent.mean_radius_m
    scale = (altitude + parent.radii_m) / parent.radii_m
    plane = rotations.from_rpy_deg((elements["inclination_deg"], 0.0, elements["raan_deg"]))
    q = rotations.multiply(equator(place.setting, parent, of_date), plane)
    return path(place, scale, q, orbit.v_step, start_rev(orbit, place))


def database(orbit: Database, place: Place) -> Motion:
    """An orbit drawn from the class; with propagator circular, a circle of the same size and
    plane."""
    row = orbit_classes.CLASSES[orbit.class_]
    if orbit.propagator == "circular" and not row.round:
        raise ValueError(f"propagator: circular cannot run through an orbit of class {row.name}")
    elements = orbit_classes.draw(
        orbit.class_, centre_of(place, row.of_date), _ranges(orbit), place.scene_random
    )
    if orbit.propagator == "circular":
        return _circle(orbit, place, elements, row.of_date)
    frame = frame_of(place.parent, row.of_date)
    return run_through(orbit.propagator or "kepler", {**elements, "frame": frame}, place)
