"""Time scales, and positions of bodies and the Sun at a date (pyerfa): ICRF axes, metres.

Seconds are those of TT, which equal those of TAI and UTC. Dates are TDB, the time of ephemerides,
which differs from TT by up to 1.7 ms. Positions are geometric: light time and aberration are left
out (the Sun's direction changes by at most 0.006 deg). `accuracy` states their errors. Phobos and
Europa rotate synchronously and are placed over their own prime meridian."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import erfa
import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import rotations
from perilune.config.errors import nearest

F64 = NDArray[np.float64]

AU_M = 149597870700.0
_DAY_S = 86400.0
_PLANETS = ("mercury", "venus", "", "mars", "jupiter", "saturn", "uranus", "neptune")
"""Names in plan94's order; the third entry is the Earth-Moon barycentre, for which epv00 is
better."""
_SYNCHRONOUS_M = {"phobos": 9.376e6, "europa": 6.711e8}
"""Distance from the planet of synchronous satellites, whose x axis points to it (JPL mean
elements)."""


@dataclass(frozen=True)
class Date:
    """JD(TDB) as two doubles, day + fraction, with a resolution below a nanosecond."""

    day: float
    fraction: float

    def after(self, seconds: float) -> Date:
        """The date some seconds of TT later."""
        later = self._after_tdb(seconds)
        gained = _tdb_minus_tt(later.day, later.fraction) - _tdb_minus_tt(self.day, self.fraction)
        return later._after_tdb(gained)

    def _after_tdb(self, seconds: float) -> Date:
        days, rest = divmod(self.fraction + seconds / _DAY_S, 1.0)
        return Date(self.day + days, rest)

    def utc(self, digits: int = 3) -> str:
        """ISO 8601 text with 1 to 9 digits of a second."""
        return _utc(self.day, self.fraction, digits)


@lru_cache(maxsize=64)
def _utc(jd_day: float, fraction: float, digits: int) -> str:
    """Kept, as all sensors of a step ask."""
    # The functions that erfa's own wrap, as every frame asks. A status above 0 is "dubious
    # year": leap seconds of the future are not known; none are assumed.
    call = erfa.ufunc
    tt = call.tdbtt(jd_day, fraction, _tdb_minus_tt(jd_day, fraction))
    tai = call.tttai(*tt[:2])
    utc = call.taiutc(*tai[:2])
    year, month, day, clock, status = call.d2dtf(b"UTC", digits, *utc[:2])
    if min(utc[2], status) < 0:
        raise ValueError(f"JD {jd_day + fraction} (TDB) is no date of the calendar")
    clocks = clock.tolist()
    hms = f"{clocks[0]:02d}:{clocks[1]:02d}:{clocks[2]:02d}.{clocks[3]:0{digits}d}"
    return f"{year:04d}-{month:02d}-{day:02d}T{hms}Z"


def date_from_utc(fields: tuple[int, int, int, int, int, float]) -> Date:
    """JD(TDB) of year, month, day, hour, minute, second UTC, including leap seconds (second 60)."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", erfa.ErfaWarning)
        tt = erfa.taitt(*erfa.utctai(*erfa.dtf2d("UTC", *fields)))
    day, fraction = erfa.tttdb(*tt, _tdb_minus_tt(*tt))
    whole = np.floor(day)
    return Date(float(whole), 0.0)._after_tdb((float(day - whole) + float(fraction)) * _DAY_S)


def tdb_s(epoch: Date, t_s: NDArray[Any]) -> F64:
    """Seconds of TDB (n,) after an epoch, from seconds of TT after it."""
    times = np.asarray(t_s, dtype=np.float64)
    then = erfa.dtdb(epoch.day, epoch.fraction + times / _DAY_S, 0.0, 0.0, 0.0, 0.0)
    return np.asarray(times + (then - _tdb_minus_tt(epoch.day, epoch.fraction)))


@lru_cache(maxsize=4096)
def _tdb_minus_tt(day: float, fraction: float) -> float:
    """Difference in seconds at the geocentre (Fairhead and Bretagnon 1990), where UT1 does not
    matter."""
    return float(erfa.dtdb(day, fraction, 0.0, 0.0, 0.0, 0.0))


def _state(pv: NDArray[Any]) -> F64:
    """ERFA's position and velocity, AU and AU a day, as (6,) m and m/s."""
    return np.concatenate([pv["p"] * AU_M, pv["v"] * (AU_M / _DAY_S)])


def _earth(date: Date) -> F64:
    heliocentric, _ = erfa.epv00(date.day, date.fraction)
    return _state(heliocentric)


def _geocentric_moon(date: Date) -> F64:
    return _state(erfa.moon98(date.day, date.fraction))


def _planet(name: str) -> Callable[[Date], F64]:
    number = _PLANETS.index(name) + 1
    return lambda date: _state(erfa.plan94(date.day, date.fraction, number))


def _synchronous(name: str) -> Callable[[Date], F64]:
    def from_planet_m(date: Date) -> F64:
        q = _core.body_orientation(name, date.day, np.array([date.fraction]))[0]
        return -_SYNCHRONOUS_M[name] * rotations.rotate(q, np.array([1.0, 0.0, 0.0]))

    def state(date: Date) -> F64:
        # A difference over 2 s: the turn of 5e-4 rad leaves 1e-8 of the speed.
        velocity = 0.5 * (from_planet_m(date.after(1.0)) - from_planet_m(date.after(-1.0)))
        planet = _heliocentric(str(_core.BODIES[name]["parent"]), date)
        from_planet: F64 = np.concatenate([from_planet_m(date), velocity])
        return planet + from_planet

    return state


_HELIOCENTRIC: dict[str, Callable[[Date], F64]] = {
    "sun": lambda date: np.zeros(6),
    "earth": _earth,
    "moon": lambda date: _earth(date) + _geocentric_moon(date),
    **{name: _planet(name) for name in _PLANETS if name},
    **{name: _synchronous(name) for name in _SYNCHRONOUS_M},
}


_SERIES = {
    "earth": "5 km (ERFA epv00, 1900 to 2100)",
    "moon": "10 km from the Earth (ERFA moon98)",
    "mercury": "2 100 km (ERFA plan94, 1800 to 2100)",
    "venus": "4 000 km (ERFA plan94, 1800 to 2100)",
    "mars": "31 000 km (ERFA plan94, 1800 to 2100; 8 000 km is usual)",
    "jupiter": "310 000 km (ERFA plan94, 1800 to 2100; 70 000 km is usual)",
    "saturn": "670 000 km (ERFA plan94, 1800 to 2100; 200 000 km is usual)",
    "uranus": "1 400 000 km (ERFA plan94, 1800 to 2100; 560 000 km is usual)",
    "neptune": "350 000 km (ERFA plan94, 1800 to 2100; 160 000 km is usual)",
    "phobos": "2 degrees of its orbit, beside its planet's error (locked to its planet)",
    "europa": "2 degrees of its orbit, beside its planet's error (locked to its planet)",
}
"""Largest errors of positions. For planets: the largest differences of plan94 from DE200 in
longitude, latitude and distance from the Sun (its note 5), combined; "usual" is the root mean
square over 1960 to 2025."""


def accuracy(name: str) -> str:
    """Accuracy of a body's position, in words."""
    return "the origin" if name == "sun" else f"series, within {_SERIES[name]}"


def has_ephemeris(name: str) -> bool:
    """Whether the position of a body at a date is known."""
    return name in _HELIOCENTRIC


def _heliocentric(name: str, date: Date) -> F64:
    if name not in _HELIOCENTRIC:
        raise ValueError(f"no ephemeris of '{name}'{nearest(name, _HELIOCENTRIC)}")
    return _HELIOCENTRIC[name](date)


def relative_state(name: str, origin: str, date: Date) -> F64:
    """Position and velocity (6,), m and m/s, of a body relative to another's centre, ICRF axes.

    `sun` is one of the bodies."""
    if {name, origin} == {"moon", "earth"}:
        # Straight from the theory, without the rounding of a heliocentric difference.
        moon = _geocentric_moon(date)
        return moon if name == "moon" else -moon
    return _heliocentric(name, date) - _heliocentric(origin, date)


def relative_m(name: str, origin: str, date: Date) -> F64:
    """Position of a body relative to another's centre; `sun` is one of the bodies."""
    return relative_state(name, origin, date)[:3]
