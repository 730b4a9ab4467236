"""From the configuration's orbits, rotations and attitudes to poses in the root frame."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core, bodies, rotations
from perilune.bodies import Date
from perilune.config.attitude import Inertial, Lvlh, Spin
from perilune.config.orbit import Elements, Kepler, Orbit
from perilune.config.schema import Body, Config, Spacecraft
from perilune.motion import States, evaluate

F64 = NDArray[np.float64]

_KM = 1e3


def table_name(body: Body) -> str | None:
    """Name of the entry of the core's table that a body stands for; None for a free ellipsoid."""
    return body.ephemeris if body.kind == "ellipsoid" else body.kind


def ephemeris_name(config: Config, name: str) -> str | None:
    """Whose ephemeris places a body that has no orbit; a free ellipsoid as root takes Earth's."""
    return table_name(config.bodies[name]) or ("earth" if name == config.root else None)


def radii_m(body: Body) -> F64:
    """Semi-axes, body-fixed."""
    if body.radii_km is not None:
        return np.array(body.radii_km) * _KM
    return np.array(_core.BODIES[body.kind]["radii_m"], dtype=np.float64)


def gm_m3_s2(body: Body) -> float:
    """Gravitational parameter."""
    if body.gm_km3_s2 is not None:
        return body.gm_km3_s2 * 1e9
    return float(_core.BODIES[body.kind]["gm_m3_s2"])


def periapsis_m(orbit: Elements, body: Body) -> float:
    """Distance of the periapsis from the body's centre."""
    if orbit.periapsis_km is not None:
        return orbit.periapsis_km * _KM
    if orbit.altitude_km is not None:
        return float(np.mean(radii_m(body)[:2])) + orbit.altitude_km * _KM
    assert orbit.semi_major_axis_km is not None  # the schema asks for one of the three
    return orbit.semi_major_axis_km * (1.0 - orbit.eccentricity) * _KM


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


def _default_frame(equator: str | None) -> str:
    """The equator of the body's table entry; ICRF without one, and for the Earth.

    ICRF's equator is the Earth's of J2000 (0.15 deg from that of 2026), and nodes of Earth orbits
    are counted from the equinox, ICRF's x axis; the node of the equator of date on ICRF's equator,
    from which `equator` counts, lies 90 deg from it.
    """
    return "icrf" if equator is None or equator == "earth" else "equator"


def kepler_motion(orbit: Orbit, body: Body) -> dict[str, Any]:
    """The core's motion of an orbit around a body."""
    if not isinstance(orbit, Kepler) or orbit.state is not None:
        raise ValueError(f"orbits of kind {orbit.kind}, or by state, are not propagated yet")
    if orbit.position_km is not None:
        return {"kind": "fixed", "position_m": np.array(orbit.position_km) * _KM}
    gm, periapsis = gm_m3_s2(body), periapsis_m(orbit, body)
    smallest = float(radii_m(body).min())
    if periapsis <= smallest:
        raise ValueError(
            f"the periapsis, {periapsis / _KM:.6g} km from the centre of {orbit.around}, lies "
            f"inside it (smallest radius {smallest / _KM:.6g} km)"
        )
    equator = table_name(body)
    frame = orbit.frame or _default_frame(equator)
    if frame == "equator" and equator is None:
        raise ValueError(
            f"frame: equator: {orbit.around} is an ellipsoid without ephemeris, its equator is not "
            "known; use frame: icrf"
        )
    return {
        "kind": "kepler",
        "gm": gm,
        "elements": {
            "periapsis_m": periapsis,
            "eccentricity": orbit.eccentricity,
            "inclination_rad": math.radians(orbit.inclination_deg),
            "raan_rad": math.radians(orbit.raan_deg),
            "arg_periapsis_rad": math.radians(orbit.arg_periapsis_deg),
            "since_periapsis_s": since_periapsis_s(orbit, periapsis, gm),
        },
        "frame": frame,
        "parent_body": equator if frame == "equator" else None,
    }


def _turned(frame: str, turn: Spin | Lvlh, **keys: Any) -> dict[str, Any]:
    """The core's rotation of axes with the entry's own rotation and spin on top."""
    return {
        "frame": frame,
        "q": rotations.from_rpy_deg(turn.rotation_deg),
        "axis": np.array(turn.spin_axis),
        "rate_rad_s": math.radians(turn.spin_rate_deg_s),
        **keys,
    }


def _body_rotation(body: Body) -> dict[str, Any]:
    if isinstance(body.rotation, Spin):
        return _turned("inertial", body.rotation)
    name = table_name(body)
    return {"frame": "inertial"} if name is None else {"frame": "body", "body": name}


def _body_motion(config: Config, name: str, epoch: Date) -> Any:
    body = config.bodies[name]
    if name == config.root:
        return {"kind": "fixed", "position_m": np.zeros(3)}
    if body.orbit is not None:
        return kepler_motion(body.orbit, config.bodies[body.orbit.around])
    own, origin = ephemeris_name(config, name), ephemeris_name(config, config.root)
    if own is None or origin is None:
        raise ValueError("its place is not known: give an orbit, or an ephemeris")
    if own == origin:
        raise ValueError(
            f"it stands where the root body is (the ephemeris of {own}); give an orbit"
        )

    def path(t_s: F64) -> F64:
        return np.stack([bodies.relative_state(own, origin, epoch.after(t)) for t in t_s])

    return path


def _nodes(config: Config, epoch: Date) -> list[dict[str, Any]]:
    index = {name: k for k, name in enumerate(config.bodies)}
    nodes: list[dict[str, Any]] = []

    def add(name: str, parent: int, motion: Any, rotation: Any) -> None:
        nodes.append({"name": name, "parent": parent, "motion": motion, "rotation": rotation})

    for section, entries in (("bodies", config.bodies), ("spacecraft", config.spacecraft)):
        for name, entry in entries.items():
            try:
                if isinstance(entry, Spacecraft):
                    motion = kepler_motion(entry.orbit, config.bodies[entry.orbit.around])
                    if not isinstance(entry.attitude, (Inertial, Lvlh)):
                        raise ValueError(f"pointing: {entry.attitude.pointing} is not there yet")
                    rotation = _turned(entry.attitude.pointing, entry.attitude)
                else:
                    motion = _body_motion(config, name, epoch)
                    rotation = _body_rotation(entry)
            except ValueError as error:
                raise ValueError(f"{section}.{name}: {error}") from None
            around = entry.orbit.around if entry.orbit is not None else config.root
            if around not in index:
                raise ValueError(f"{section}.{name}: orbits about spacecraft are not there yet")
            parent = -1 if name == config.root else index[around]
            add(name, parent, motion, rotation)
    return nodes


def states(config: Config, epoch: Date, t_s: F64) -> States:
    """States of every body and spacecraft in the root frame, t_s (n,) seconds after the epoch."""
    return evaluate(_nodes(config, epoch), epoch, t_s)


def sun_position_m(config: Config, date: Date) -> F64:
    """The Sun's centre in the root frame."""
    if config.sun.direction is not None:
        return np.array(config.sun.direction) * (config.sun.distance_au * bodies.AU_M)
    origin = ephemeris_name(config, config.root)
    assert origin is not None  # the root always has one
    return bodies.relative_m("sun", origin, date)
