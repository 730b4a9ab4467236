"""Orbits from elements or a state: two-body motion."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.config.orbit import Elements, Kepler
from perilune.orbits.place import Motion, Place
from perilune.orbits.setting import KM, Parent

F64 = NDArray[np.float64]


def periapsis_m(orbit: Elements, parent: Parent) -> float:
    """Distance of the periapsis from the centre of the central body."""
    if orbit.periapsis_km is not None:
        return orbit.periapsis_km * KM
    if orbit.altitude_km is not None:
        return parent.mean_radius_m + orbit.altitude_km * KM
    assert orbit.semi_major_axis_km is not None  # the schema asks for one of the three
    return orbit.semi_major_axis_km * (1.0 - orbit.eccentricity) * KM


def default_frame(equator: str | None) -> str:
    """The equator of the body's table entry; ICRF without one, and for the Earth.

    The ICRF equator is the Earth's of J2000 (0.15 deg from that of 2026), and nodes of Earth orbits
    refer to the equinox, the x axis of ICRF. The frame `equator` refers to the node of the equator
    of date on the ICRF equator, which is 90 deg away."""
    return "icrf" if equator is None or equator == "earth" else "equator"


def _check_periapsis(periapsis: float, orbit: Elements, parent: Parent) -> None:
    # A spacecraft's bounding sphere may hold orbits: its own shape is not known here.
    smallest = min(parent.radii_m.tolist()) if parent.is_body else 0.0
    if periapsis <= smallest:
        raise ValueError(
            f"the periapsis, {periapsis / KM:.6g} km from the centre of {orbit.around}, lies "
            f"inside it (smallest radius {smallest / KM:.6g} km)"
        )


def _elements(orbit: Elements, parent: Parent) -> dict[str, float]:
    periapsis = periapsis_m(orbit, parent)
    _check_periapsis(periapsis, orbit, parent)
    if orbit.mean_anomaly_deg is not None:
        anomaly = {"mean_anomaly_rad": math.radians(orbit.mean_anomaly_deg)}
    else:
        assert orbit.true_anomaly_deg is not None  # the schema asks for one of the two
        anomaly = {"true_anomaly_rad": math.radians(orbit.true_anomaly_deg)}
    return {
        "periapsis_m": periapsis,
        "eccentricity": orbit.eccentricity,
        "inclination_rad": math.radians(orbit.inclination_deg),
        "raan_rad": math.radians(orbit.raan_deg),
        "arg_periapsis_rad": math.radians(orbit.arg_periapsis_deg),
        **anomaly,
    }


def _state(orbit: Elements, parent: Parent, gm: float) -> F64:
    assert orbit.state is not None
    state: F64 = np.array([*orbit.state.position_km, *orbit.state.velocity_km_s]) * KM
    r, v = state[:3], state[3:]
    h = np.cross(r, v)
    eccentricity = float(np.linalg.norm(np.cross(v, h) / gm - r / np.linalg.norm(r)))
    _check_periapsis(float(h @ h) / gm / (1.0 + eccentricity), orbit, parent)
    return state


def two_body(orbit: Elements, place: Place) -> dict[str, Any]:
    """The core's two-body motion of elements or a state."""
    parent = place.parent
    gm, equator = parent.gm_m3_s2, parent.table
    frame = orbit.frame or ("icrf" if orbit.state is not None else default_frame(equator))
    if frame == "equator" and equator is None:
        raise ValueError(
            f"frame: equator: {orbit.around} is no body of the table and has no ephemeris: its "
            "equator is not known; use frame: icrf"
        )
    spec: dict[str, Any] = {
        "kind": "kepler",
        "gm": gm,
        "frame": frame,
        "parent_body": equator if frame == "equator" else None,
    }
    if orbit.state is None:
        return {**spec, "elements": _elements(orbit, parent)}
    return {**spec, "state": _state(orbit, parent, gm)}


def kepler(orbit: Kepler, place: Place) -> Motion:
    """Two-body motion, or a fixed position."""
    if orbit.position_km is not None:
        return {"kind": "fixed", "position_m": np.array(orbit.position_km) * KM}
    return two_body(orbit, place)
