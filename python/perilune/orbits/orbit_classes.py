"""Classes of orbits: ranges to draw orbits from, for any central body.

Ranges for the Earth are customary (altitudes of ISO 24113 and ESA's orbit classes; Vallado,
Fundamentals of Astrodynamics, chapter 11); for other bodies they scale with the radius. Default
ranges are cut to what lies above surface and atmosphere and within the sphere of influence. A range
given by the user must lie there as a whole.

To add a class: its ranges as a function here, its line in CLASSES, its name in config/orbit.py."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from perilune.config.errors import nearest
from perilune.orbits.gravity import Zonals

Range = tuple[float, float]
Ranges = dict[str, Range]

_KM = 1e3
_EARTH_RADIUS_KM = 6378.137
_FLOOR_KM = {"earth": 160.0, "mars": 150.0, "moon": 15.0, "mercury": 15.0, "europa": 25.0}
"""Lowest altitudes: above mountains, and above air that would end an orbit within hours."""
_FLOOR = 0.02  # of other bodies, in radii
_TURN: Range = (0.0, 360.0)
_CRITICAL_DEG = math.degrees(math.asin(math.sqrt(0.8)))  # the periapsis stands still under J2


@dataclass(frozen=True)
class Centre:
    """Properties of the central body that a class of orbits needs."""

    name: str
    table: str | None
    """Name in the table of bodies."""
    radii_m: tuple[float, float, float]
    gm_m3_s2: float | None
    hill_radius_m: float = math.inf
    """Radius of its sphere of influence relative to its own central body."""
    rate_rad_s: float = 0.0
    """Sidereal rate of rotation; 0: unknown."""
    zonals: Zonals | None = None
    year_s: float | None = None
    """Tropical year of the planet it belongs to."""
    noon_deg: float = 0.0
    """Angle of the mean Sun from the x axis of the elements' frame, in its xy plane."""
    meridian_deg: float | None = None
    """Angle of its longitude 0 at the epoch in the same plane; None if its equator is not the plane
    of the elements."""

    @property
    def radius_km(self) -> float:
        """Mean equatorial radius."""
        return 0.5 * (self.radii_m[0] + self.radii_m[1]) / _KM

    @property
    def floor_km(self) -> float:
        """Lowest altitude above the mean equatorial radius."""
        own = _FLOOR_KM.get(self.table or "", _FLOOR * self.radius_km)
        return max(self.radii_m) / _KM - self.radius_km + own

    def gm_km3_s2(self, why: str) -> float:
        """Gravitational parameter; ValueError if it is unknown."""
        if self.gm_m3_s2 is None:
            raise ValueError(f"{why} needs the gm_km3_s2 of {self.name}")
        return self.gm_m3_s2 / 1e9

    def synchronous_km(self, why: str) -> float:
        """Radius of the orbit whose period is the sidereal day."""
        gm = self.gm_km3_s2(why)
        if self.rate_rad_s == 0.0:
            raise ValueError(f"{why} needs a body that rotates, and {self.name} does not")
        return float((gm / self.rate_rad_s**2) ** (1.0 / 3.0))


@dataclass(frozen=True)
class OrbitClass:
    """A row of the table."""

    name: str
    doc: str
    ranges: Callable[[Centre], Ranges]
    """Key -> default range, in the keys and units of the configuration."""
    finish: Callable[[Centre, dict[str, float]], dict[str, float]] | None = None
    """Converts drawn values to Keplerian keys, if they are not those already."""
    of_date: bool = False
    """Whether its elements refer to the body's equator of date, even around the Earth, where other
    orbits refer to ICRF: 0.15 deg is 2 % of a sun-synchronous drift."""
    round: bool = True
    """Whether a circular path may replace it."""
    reach: float = 1.0
    """Largest apoapsis, in radii of the sphere of influence."""


def _altitudes(centre: Centre, earth: Range, others: Range | None = None) -> Range:
    """The Earth's range in km; for other bodies in radii (default: the Earth's, in its radii)."""
    if centre.table == "earth":
        return earth
    low, high = others or (earth[0] / _EARTH_RADIUS_KM, earth[1] / _EARTH_RADIUS_KM)
    return (low * centre.radius_km, high * centre.radius_km)


def _angles(inclination: Range, periapsis: Range = _TURN) -> Ranges:
    return {
        "inclination_deg": inclination,
        "raan_deg": _TURN,
        "arg_periapsis_deg": periapsis,
        "mean_anomaly_deg": _TURN,
    }


def _low(centre: Centre) -> Ranges:
    altitude = _altitudes(centre, (300.0, 1600.0), (_FLOOR, 0.5))
    return {"altitude_km": altitude, "eccentricity": (0.0, 0.02), **_angles((0.0, 180.0))}


def _medium(centre: Centre) -> Ranges:
    altitude = _altitudes(centre, (2000.0, 35786.0), (0.5, 5.6))
    return {"altitude_km": altitude, "eccentricity": (0.0, 0.0), **_angles((0.0, 65.0))}


def _stationary(centre: Centre) -> Ranges:
    return {
        "eccentricity": (0.0, 0.0),
        "inclination_deg": (0.0, 0.0),
        "raan_deg": (0.0, 0.0),
        "longitude_deg": (-180.0, 180.0),
    }


def _over_longitude(centre: Centre, drawn: dict[str, float]) -> dict[str, float]:
    """Mean anomaly of a geostationary longitude: to first order, longitude is node + anomaly -
    meridian."""
    if centre.meridian_deg is None:
        raise ValueError(f"a stationary orbit needs the equator of {centre.name}, not known here")
    radius = centre.synchronous_km("a stationary orbit")
    station = centre.meridian_deg + drawn.pop("longitude_deg")
    drawn["mean_anomaly_deg"] = (station - drawn["raan_deg"]) % 360.0
    return {"semi_major_axis_km": radius, **drawn}


def _polar(centre: Centre) -> Ranges:
    altitude = _altitudes(centre, (400.0, 1000.0))
    return {"altitude_km": altitude, "eccentricity": (0.0, 0.02), **_angles((80.0, 100.0))}


def _sun_synchronous(centre: Centre) -> Ranges:
    low, high = _altitudes(centre, (400.0, 1000.0))
    return {
        "altitude_km": (low, min(high, _largest_synchronous_km(centre, 0.0) - centre.radius_km)),
        "eccentricity": (0.0, 0.0),
        "ltan_h": (0.0, 24.0),
        "arg_periapsis_deg": _TURN,
        "mean_anomaly_deg": _TURN,
    }


def _largest_synchronous_km(centre: Centre, eccentricity: float) -> float:
    """Semi-major axis of the retrograde equatorial orbit whose node follows the mean Sun."""
    why = "a sun-synchronous orbit"
    if centre.zonals is None or centre.year_s is None:
        raise ValueError(f"{why} needs the oblateness (J2) of {centre.name}, which is not known")
    gm, radius = centre.gm_km3_s2(why), centre.zonals.radius_m / _KM
    oblate = 1.5 * centre.zonals.j[0] * radius**2 * math.sqrt(gm) / (1.0 - eccentricity**2) ** 2
    return float((oblate * centre.year_s / (2.0 * math.pi)) ** (1.0 / 3.5))


def sun_synchronous_deg(centre: Centre, semi_major_axis_km: float, eccentricity: float) -> float:
    """Inclination whose node follows the mean Sun under J2 (Vallado, section 11.4.1): its cosine
    is -(a / largest a)^(7/2). ValueError beyond the largest orbit that has one.
    """
    largest = _largest_synchronous_km(centre, eccentricity)
    if semi_major_axis_km > largest:
        raise ValueError(
            f"no sun-synchronous orbit has a semi-major axis of {semi_major_axis_km:.6g} km: "
            f"around {centre.name} they end at {largest:.6g} km"
        )
    return math.degrees(math.acos(-((semi_major_axis_km / largest) ** 3.5)))


def _follow_sun(centre: Centre, drawn: dict[str, float]) -> dict[str, float]:
    e = drawn["eccentricity"]
    semi_major = (centre.radius_km + drawn["altitude_km"]) / (1.0 - e)
    drawn["inclination_deg"] = sun_synchronous_deg(centre, semi_major, e)
    drawn["raan_deg"] = (centre.noon_deg + 15.0 * (drawn.pop("ltan_h") - 12.0)) % 360.0
    return drawn


def _molniya(centre: Centre) -> Ranges:
    semi_major = 26560.0  # half a sidereal day around the Earth
    if centre.table != "earth":
        semi_major *= centre.radius_km / _EARTH_RADIUS_KM
    return {
        "semi_major_axis_km": (semi_major, semi_major),
        "eccentricity": (0.70, 0.74),
        **_angles((_CRITICAL_DEG, _CRITICAL_DEG), (270.0, 270.0)),
    }


def _transfer(centre: Centre) -> Ranges:
    altitude = _altitudes(centre, (200.0, 500.0))
    return {"altitude_km": altitude, **_angles((0.0, 28.5), (178.0, 182.0))}


def _to_synchronous(centre: Centre, drawn: dict[str, float]) -> dict[str, float]:
    low = centre.radius_km + drawn["altitude_km"]
    high = centre.synchronous_km("a transfer orbit")
    return {**drawn, "eccentricity": (high - low) / (high + low)}


def _lunar(centre: Centre) -> Ranges:
    altitude = (50.0, 200.0) if centre.table == "moon" else _altitudes(centre, (184.0, 734.0))
    return {"altitude_km": altitude, "eccentricity": (0.0, 0.005), **_angles((0.0, 180.0))}


def _halo(centre: Centre) -> Ranges:
    """Ellipse through periapsis and apoapsis of the Moon's 9:2 near-rectilinear halo orbit (about
    3300 and 71000 km; NASA, White paper: Gateway destination orbit model, 2019)."""
    if not math.isfinite(centre.hill_radius_m):
        raise ValueError(f"NRHO needs a body that circles another, and {centre.name} does not")
    semi_major = 0.604 * centre.hill_radius_m / _KM
    return {
        "altitude_km": (0.73 * centre.radius_km, 1.07 * centre.radius_km),
        "semi_major_axis_km": (0.96 * semi_major, 1.04 * semi_major),
        **_angles((88.0, 92.0), (88.0, 92.0)),
    }


def _halo_shape(centre: Centre, drawn: dict[str, float]) -> dict[str, float]:
    low = centre.radius_km + drawn.pop("altitude_km")
    if low >= drawn["semi_major_axis_km"]:
        raise ValueError(f"the sphere of influence of {centre.name} is too small for an NRHO")
    return {**drawn, "eccentricity": 1.0 - low / drawn["semi_major_axis_km"]}


CLASSES: dict[str, OrbitClass] = {
    row.name: row
    for row in (
        OrbitClass("LEO", "low orbit, any inclination", _low),
        OrbitClass("MEO", "medium orbit, below the stationary one", _medium),
        OrbitClass("GEO", "stationary over longitude_deg", _stationary, _over_longitude, True),
        OrbitClass("PO", "low polar orbit", _polar),
        OrbitClass("SSO", "its node follows the Sun", _sun_synchronous, _follow_sun, True),
        OrbitClass("MOLNIYA", "long dwell over the north, half a day", _molniya, round=False),
        OrbitClass("GTO", "to the stationary orbit", _transfer, _to_synchronous, round=False),
        OrbitClass("LLO", "low orbit as around the Moon", _lunar),
        OrbitClass(
            "NRHO",
            "polar ellipse like a near-rectilinear halo orbit (as two-body motion)",
            _halo,
            _halo_shape,
            round=False,
            reach=1.3,
        ),
    )
}
"""Name -> class."""

KEYS = (
    *("altitude_km", "semi_major_axis_km", "eccentricity", "inclination_deg", "raan_deg"),
    *("arg_periapsis_deg", "mean_anomaly_deg", "ltan_h", "longitude_deg"),
)
"""Keys that one class or another allows."""


def _extent_km(centre: Centre, elements: Mapping[str, float]) -> Range:
    """Distances of periapsis and apoapsis."""
    e = elements["eccentricity"]
    if "altitude_km" in elements:
        low = centre.radius_km + elements["altitude_km"]
        return (low, low * (1.0 + e) / (1.0 - e))
    semi_major = elements["semi_major_axis_km"]
    return (semi_major * (1.0 - e), semi_major * (1.0 + e))


def _fault(row: OrbitClass, centre: Centre, elements: Mapping[str, float]) -> str | None:
    """Reason why an orbit is impossible; None if it is possible."""
    low, high = _extent_km(centre, elements)
    floor = centre.radius_km + centre.floor_km
    if low < floor * (1.0 - 1e-12):
        return (
            f"its periapsis, {low - centre.radius_km:.6g} km over the mean equatorial radius, lies "
            f"below {centre.floor_km:.6g} km, where the surface or the atmosphere ends an orbit"
        )
    limit = row.reach * centre.hill_radius_m / _KM
    if high > limit * (1.0 + 1e-12):
        return (
            f"its apoapsis, {high:.6g} km, lies outside the sphere of influence of {centre.name} "
            f"(Hill radius {centre.hill_radius_m / _KM:.6g} km)"
        )
    return None


def _possible(row: OrbitClass, centre: Centre, ranges: Ranges) -> Range:
    """The possible part of the default range of altitudes."""
    low, high = max(ranges["altitude_km"][0], centre.floor_km), ranges["altitude_km"][1]
    if "semi_major_axis_km" not in ranges:  # which would set the apoapsis
        e = ranges.get("eccentricity", (0.0, 0.0))[1]
        ceiling = row.reach * centre.hill_radius_m / _KM * (1.0 - e) / (1.0 + e)
        high = min(high, ceiling - centre.radius_km)
    if low > high:
        raise ValueError(
            f"no orbit of class {row.name} around {centre.name}: altitudes from {low:.6g} km (over "
            f"its surface and atmosphere) to {high:.6g} km (the class, and the sphere of influence "
            f"with its Hill radius of {centre.hill_radius_m / _KM:.6g} km) do not exist"
        )
    return (low, high)


def _finished(row: OrbitClass, centre: Centre, values: Mapping[str, float]) -> dict[str, float]:
    drawn = dict(values)
    return drawn if row.finish is None else row.finish(centre, drawn)


def ranges_of(name: str, centre: Centre, given: Mapping[str, Range]) -> Ranges:
    """Key -> range that an orbit of a class is drawn from; `given` replaces defaults.

    ValueError with a reason for keys that the class does not have, and for ranges with impossible
    orbits: all corners are tested, so no later draw fails."""
    row = CLASSES[name]
    defaults = row.ranges(centre)
    for key in given:
        if key not in defaults:
            raise ValueError(f"{key}: not a key of class {name}{nearest(key, defaults)}")
    ranges = {**defaults, **given}
    low, high = ranges.get("eccentricity", (0.0, 0.0))
    if not 0.0 <= low <= high < 1.0:
        text = f"[{low:g}, {high:g}]: the orbits of the database are closed, 0 <= e < 1"
        raise ValueError(f"eccentricity = {text}")
    if "altitude_km" in defaults and "altitude_km" not in given:
        ranges["altitude_km"] = _possible(row, centre, ranges)
    sizes = [key for key in ("altitude_km", "semi_major_axis_km", "eccentricity") if key in ranges]
    for corner in range(2 ** len(sizes)):
        values = {key: value[0] for key, value in ranges.items()}
        values |= {key: ranges[key][corner >> k & 1] for k, key in enumerate(sizes)}
        fault = _fault(row, centre, _finished(row, centre, values))
        if fault is not None:
            raise ValueError(f"class {name} around {centre.name}: {fault}")
    return ranges


def _one(key: str, limits: Range, rng: np.random.Generator) -> float:
    """Draws uniformly; inclinations uniformly over the sphere."""
    low, high = limits
    u = float(rng.random())
    if low == high:
        return low
    if key != "inclination_deg":
        return low + (high - low) * u
    first, last = math.cos(math.radians(low)), math.cos(math.radians(high))
    return min(max(math.degrees(math.acos(first + (last - first) * u)), low), high)


def draw(
    name: str,
    centre: Centre,
    given: Mapping[str, Range],
    rng: Callable[[str], np.random.Generator],
) -> dict[str, Any]:
    """Draws the keys of a Kepler orbit. rng(key) is the generator of a key, so that giving one key
    leaves the others unchanged."""
    ranges = ranges_of(name, centre, given)
    values = {key: _one(key, limits, rng(key)) for key, limits in ranges.items()}
    return _finished(CLASSES[name], centre, values)
