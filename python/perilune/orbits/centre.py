"""Properties of a central body that the orbit database needs: sphere of influence, day, Sun."""

from __future__ import annotations

import math

import erfa
import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import rotations
from perilune.config.attitude import Spin
from perilune.config.body import Body
from perilune.config.motion import sections
from perilune.config.orbit import Elements
from perilune.orbits import solar_system
from perilune.orbits.almanac import almanac
from perilune.orbits.gravity import ZONALS
from perilune.orbits.kinds.elements import default_frame, periapsis_m
from perilune.orbits.orbit_classes import Centre
from perilune.orbits.place import Place
from perilune.orbits.setting import KM, Parent, Setting, ephemeris_name, parent_of
from perilune.orbits.turns import earth, spin_of

F64 = NDArray[np.float64]

_DAY_S = 86400.0
_YEARS_D = {
    "mercury": 87.968, "venus": 224.695, "earth": 365.242189, "mars": 686.973,
    "jupiter": 4330.595, "saturn": 10746.94, "uranus": 30588.74, "neptune": 59799.9,
}  # fmt: skip
"""Tropical orbital periods in days, from NASA's planetary fact sheets; the Earth's from the
Astronomical Almanac."""
_Z = np.array([0.0, 0.0, 1.0])


def _planet(name: str | None) -> str | None:
    """The planet that a body is, or belongs to."""
    while name is not None and name not in _YEARS_D:
        name = _core.BODIES[name]["parent"]
    return name


def hill_radius_m(setting: Setting, name: str) -> float:
    """Hill radius a (m / 3M)^(1/3) relative to the central body; infinite if that is unknown."""
    _, entry = sections(setting.config)[name]
    own = parent_of(setting, name)
    if own.gm_or_none is None:
        return math.inf
    if entry.orbit is not None:
        other = parent_of(setting, entry.orbit.around)
        distance = _distance_m(entry.orbit, other)
        gm = other.gm_or_none
    else:
        table = ephemeris_name(setting.config, name)
        parent = None if table is None else _core.BODIES[table]["parent"]
        if table is None or parent is None:
            return math.inf
        from_parent = almanac(setting.config).relative_m(table, parent, setting.epoch)
        distance = float(np.linalg.norm(from_parent))
        gm = float(_core.BODIES[parent]["gm_m3_s2"])
    if gm is None or distance is None:
        return math.inf
    return float(distance * (own.gm_or_none / (3.0 * gm)) ** (1.0 / 3.0))


def _distance_m(orbit: object, parent: Parent) -> float | None:
    """Mean distance on an orbit, for kinds that define one."""
    if not isinstance(orbit, Elements):
        return None
    if orbit.state is not None:
        return math.hypot(*orbit.state.position_km) * KM
    if getattr(orbit, "position_km", None) is not None:
        return None  # it stands still: nothing pulls
    e = orbit.eccentricity
    return periapsis_m(orbit, parent) / (1.0 - e) if e < 1.0 else None


def frame_of(parent: Parent, of_date: bool) -> str:
    """Frame of a Kepler orbit's section that the database's elements refer to."""
    return "equator" if of_date and parent.table is not None else default_frame(parent.table)


def equator(setting: Setting, parent: Parent, of_date: bool) -> F64:
    """Quaternion from the axes of that frame to ICRF at the epoch, equal to the core's."""
    if frame_of(parent, of_date) == "icrf":
        return np.array([1.0, 0.0, 0.0, 0.0])
    assert parent.table is not None  # else it is icrf
    date = setting.epoch
    q = _core.body_orientation(parent.table, date.day, np.array([date.fraction]))[0]
    pole = rotations.rotate(q, _Z)
    x = rotations.cross(_Z, pole)
    x = np.array([1.0, 0.0, 0.0]) if np.linalg.norm(x) < 1e-12 else x / np.linalg.norm(x)
    return rotations.from_matrix(np.column_stack([x, rotations.cross(pole, x), pole]))


def _orientation(table: str, setting: Setting, after_s: float = 0.0) -> F64:
    if table == "earth":
        return np.asarray(earth(setting.epoch)(np.array([after_s]))[0])
    date = setting.epoch.after(after_s)
    return np.asarray(_core.body_orientation(table, date.day, np.array([date.fraction]))[0])


def _day(setting: Setting, parent: Parent) -> tuple[F64 | None, float]:
    """Orientation at the epoch (None: unknown), and rate about the pole in rad/s."""
    _, entry = sections(setting.config)[parent.name]
    if isinstance(entry, Body) and isinstance(entry.rotation, Spin):
        q, axis, rate = spin_of(entry.rotation, setting.config.time.step_s)
        upright = abs(float(axis @ _Z)) > 1.0 - 1e-9
        aligned = float(rotations.rotate(q, _Z) @ _Z) > 1.0 - 1e-9
        return (q if upright and aligned else None), abs(rate)
    if parent.table is None:
        return None, 0.0
    span = 600.0  # long enough for rounding, too short for half a turn of anything
    q, later = _orientation(parent.table, setting), _orientation(parent.table, setting, span)
    turn = rotations.multiply(rotations.conjugate(q), later)
    angle = 2.0 * math.atan2(float(np.linalg.norm(turn[1:])), abs(float(turn[0])))
    return q, angle / span


def _angle_deg(q: F64, direction: F64) -> float:
    """Angle of a direction from the x axis of q, in its xy plane."""
    x, y, _ = rotations.rotate_back(q, direction).tolist()
    return math.degrees(math.atan2(y, x))


def _noon_deg(setting: Setting, parent: Parent, axes: F64) -> float:
    """Angle of the mean Sun. For the Earth it moves along the equator of date at the Sun's mean
    longitude (Astronomical Almanac); elsewhere the true Sun is used."""
    date = setting.epoch
    if parent.table == "earth":
        centuries = (date.day - 2451545.0 + date.fraction) / 36525.0
        mean = math.radians((280.460 + 36000.771 * centuries) % 360.0)
        of_date = np.array([math.cos(mean), math.sin(mean), 0.0])
        return _angle_deg(axes, erfa.pmat06(date.day, date.fraction).T @ of_date)
    own = parent.table or ephemeris_name(setting.config, setting.config.root)
    if own is None or not solar_system.has_ephemeris(own):
        return 0.0
    return _angle_deg(axes, almanac(setting.config).relative_m("sun", own, date))


def centre_of(place: Place, of_date: bool) -> Centre:
    """Properties of an orbit's central body at the epoch."""
    setting, parent = place.setting, place.parent
    axes = equator(setting, parent, of_date)
    q, rate = _day(setting, parent)
    planet = _planet(parent.table)
    a, b, c = parent.radii_m.tolist()
    meridian = None if q is None else _angle_deg(axes, rotations.rotate(q, np.eye(3)[0]))
    return Centre(
        name=parent.name,
        table=parent.table,
        radii_m=(a, b, c),
        gm_m3_s2=parent.gm_or_none,
        hill_radius_m=hill_radius_m(setting, parent.name),
        rate_rad_s=rate,
        zonals=ZONALS.get(parent.table or ""),
        year_s=None if planet is None else _YEARS_D[planet] * _DAY_S,
        noon_deg=_noon_deg(setting, parent, axes),
        meridian_deg=meridian,
    )
