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
    """Distance of the periapsis from the body's centre."""
    if orbit.periapsis_km is not None:
        return orbit.periapsis_km * KM
    if orbit.altitude_km is not None:
        return parent.mean_radius_m + orbit.altitude_km * KM
    assert orbit.semi_major_axis_km is not None  # the schema asks for one of the three
    return orbit.semi_major_axis_km * (1.0 - orbit.eccentricity) * KM


def since_periapsis_s(orbit: Elements, periapsis: float, gm: float) -> float:
    """Time since periapsis at the epoch; on an ellipse within half a period.

    Kepler's equation and its forms for hyperbola and parabola (Barker): Battin, An Introduction to
    the Mathematics and Methods of Astrodynamics, chapter 4. A true anomaly beyond a hyperbola's
    asymptote is a ValueError.
    """
    e = orbit.eccentricity
    mean_motion = math.sqrt(gm * abs(1.0 - e) ** 3 / periapsis**3)
    if orbit.mean_anomaly_deg is not None:
        turn = math.radians(orbit.mean_anomaly_deg)
        return (math.remainder(turn, 2.0 * math.pi) if e < 1.0 else turn) / mean_motion
    assert orbit.true_anomaly_deg is not None  # the schema asks for one of the two
    true = math.remainder(math.radians(orbit.true_anomaly_deg), 2.0 * math.pi)
    tangent = math.tan(0.5 * true)
    if e < 1.0:
        eccentric = 2.0 * math.atan(math.sqrt((1.0 - e) / (1.0 + e)) * tangent)
        return (eccentric - e * math.sin(eccentric)) / mean_motion
    if e == 1.0:
        return math.sqrt(2.0 * periapsis**3 / gm) * (tangent + tangent**3 / 3.0)
    ratio = math.sqrt((e - 1.0) / (e + 1.0)) * tangent
    if abs(ratio) >= 1.0:
        limit = math.degrees(math.acos(-1.0 / e))
        raise ValueError(
            f"true_anomaly_deg = {orbit.true_anomaly_deg:g}: a hyperbola of eccentricity {e:g} "
            f"has true anomalies between -{limit:.6g} and {limit:.6g} deg"
        )
    hyperbolic = 2.0 * math.atanh(ratio)
    return (e * math.sinh(hyperbolic) - hyperbolic) / mean_motion


def default_frame(equator: str | None) -> str:
    """The equator of the body's table entry; ICRF without one, and for the Earth.

    ICRF's equator is the Earth's of J2000 (0.15 deg from that of 2026), and nodes of Earth orbits
    are counted from the equinox, ICRF's x axis; the node of the equator of date on ICRF's equator,
    from which `equator` counts, lies 90 deg from it.
    """
    return "icrf" if equator is None or equator == "earth" else "equator"


def _elements(orbit: Elements, parent: Parent, gm: float) -> dict[str, float]:
    periapsis = periapsis_m(orbit, parent)
    # A spacecraft's bounding sphere may hold orbits: its own shape is not known here.
    smallest = float(parent.radii_m.min()) if parent.is_body else 0.0
    if periapsis <= smallest:
        raise ValueError(
            f"the periapsis, {periapsis / KM:.6g} km from the centre of {orbit.around}, lies "
            f"inside it (smallest radius {smallest / KM:.6g} km)"
        )
    return {
        "periapsis_m": periapsis,
        "eccentricity": orbit.eccentricity,
        "inclination_rad": math.radians(orbit.inclination_deg),
        "raan_rad": math.radians(orbit.raan_deg),
        "arg_periapsis_rad": math.radians(orbit.arg_periapsis_deg),
        "since_periapsis_s": since_periapsis_s(orbit, periapsis, gm),
    }


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
        return {**spec, "elements": _elements(orbit, parent, gm)}
    state = (*orbit.state.position_km, *orbit.state.velocity_km_s)
    return {**spec, "state": np.array(state) * KM}


def kepler(orbit: Kepler, place: Place) -> Motion:
    """Two-body motion, or a fixed position."""
    if orbit.position_km is not None:
        return {"kind": "fixed", "position_m": np.array(orbit.position_km) * KM}
    return two_body(orbit, place)
