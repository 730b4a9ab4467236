"""Time scales and places of bodies, against references that do not come from ERFA's routines."""

from __future__ import annotations

import datetime
import math

import erfa
import numpy as np
import pytest

from perilune import _core
from perilune.base import rotations
from perilune.orbits import solar_system
from perilune.orbits.solar_system import AU_M, Date, date_from_utc

# Largest errors of heliocentric longitude against JPL's DE200 over 1800-2050, arcseconds, from the
# notes of the routine (Simon et al. 1994); the distance's error is smaller than that of longitude.
PLAN94_ARCSEC = {
    "mercury": 6, "venus": 7, "mars": 26, "jupiter": 78, "saturn": 87, "uranus": 86, "neptune": 11
}  # fmt: skip


def angle_deg(a, b):
    return math.degrees(math.atan2(np.linalg.norm(np.cross(a, b)), a @ b))


def centuries(date: Date) -> float:
    return (date.day - 2451545.0 + date.fraction) / 36525.0


def almanac_sun_au(date: Date):
    """Astronomical Almanac, low-precision Sun: 0.01 deg, 1950-2050; turned to J2000."""
    T = centuries(date)
    mean = math.radians(357.5291092 + 35999.05034 * T)
    longitude = math.radians(
        280.460 + 36000.771 * T + 1.914666471 * math.sin(mean)
        + 0.019994643 * math.sin(2 * mean) - 1.397 * T
    )  # fmt: skip
    tilt = math.radians(23.439291)
    r = 1.000140612 - 0.016708617 * math.cos(mean) - 0.000139589 * math.cos(2 * mean)
    return r * np.array(
        [
            math.cos(longitude),
            math.cos(tilt) * math.sin(longitude),
            math.sin(tilt) * math.sin(longitude),
        ]
    )


@pytest.mark.parametrize("year", [1962, 1986, 2000, 2013, 2026, 2049])
@pytest.mark.parametrize("month", [1, 3, 6, 9])
def test_sun_of_the_earth_against_the_almanac(year, month):
    date = date_from_utc((year, month, 20, 5, 0, 0.0))
    sun = solar_system.relative_m("sun", "earth", date) / AU_M
    expected = almanac_sun_au(date)
    assert angle_deg(sun, expected) < 0.02
    assert abs(np.linalg.norm(sun) - np.linalg.norm(expected)) < 2e-4


def test_equinox_and_solstice():
    """Equinox 2026-03-20 14:46 and solstice 2026-06-21 08:25 UTC (Astronomical Almanac).

    The Sun crosses the equator of date then; 26.2 years of precession (20.04 arcsec a year in
    declination, times the sine of the Sun's right ascension) stand between that and the ICRF.
    """
    equinox = solar_system.relative_m("sun", "earth", date_from_utc((2026, 3, 20, 14, 46, 0.0)))
    declination = math.degrees(math.asin(equinox[2] / np.linalg.norm(equinox)))
    assert abs(declination + 26.2 * 20.04 / 3600.0) < 0.01
    solstice = solar_system.relative_m("sun", "earth", date_from_utc((2026, 6, 21, 8, 25, 0.0)))
    declination = math.degrees(math.asin(solstice[2] / np.linalg.norm(solstice)))
    assert abs(declination - 23.436) < 0.01


@pytest.mark.parametrize(
    ("fields", "gamma", "opposite"),
    [
        # Greatest eclipse and gamma (Earth radii): NASA's eclipse catalogue (Espenak and Meeus).
        ((2024, 4, 8, 18, 17, 20.0), 0.3431, False),
        ((2017, 8, 21, 18, 25, 32.0), 0.4367, False),
        ((2025, 3, 14, 6, 58, 43.0), 0.3485, True),
    ],
)
def test_moon_at_eclipses(fields, gamma, opposite):
    """At the greatest eclipse the shadow's axis passes gamma Earth radii from Earth's or Moon's."""
    date = date_from_utc(fields)
    moon = solar_system.relative_m("moon", "earth", date)
    sun = solar_system.relative_m("sun", "earth", date)
    axis = -sun / np.linalg.norm(sun) if opposite else (sun - moon) / np.linalg.norm(sun - moon)
    distance = np.linalg.norm(np.cross(moon, axis)) / 6378137.0
    assert abs(distance - gamma) < 0.02


def test_relative_places_are_consistent():
    date = date_from_utc((2026, 1, 1, 0, 0, 0.0))
    moon = solar_system.relative_m("moon", "earth", date)
    assert (solar_system.relative_m("earth", "moon", date) == -moon).all()
    of_moon, of_earth = (solar_system.relative_m(name, "sun", date) for name in ("moon", "earth"))
    via_sun = of_moon - of_earth
    assert np.abs(via_sun - moon).max() < 1e-3
    from_sun = solar_system.relative_m("mars", "sun", date)
    assert (solar_system.relative_m("sun", "mars", date) == -from_sun).all()
    with pytest.raises(ValueError, match=r"did you mean 'mars'\?"):
        solar_system.relative_m("marz", "earth", date)


def naif_states(data_dir):
    """Date, body -> position km of planetary barycentres from the solar system's."""
    table: dict[str, dict[str, np.ndarray]] = {}
    lines = (data_dir / "orbits/naif/DE431-ephemeris-NAIF.txt").read_text().splitlines()
    for line in lines[1:]:
        words = line.split()
        if len(words) == 10 and words[3] == "BARYCENTER":
            position = np.array([float(word) for word in words[4:7]])
            table.setdefault(words[0], {})[words[2].lower()] = position
    return table


def test_planets_against_jpl(data_dir):
    """Vectors between planets and the Earth-Moon barycentre, DE431 as NAIF's toolkit prints it."""
    checked = 0
    for text, planets in naif_states(data_dir).items():
        year, month, day = (int(part) for part in text[:10].split("-"))
        if not 1960 <= year <= 2050:
            continue
        seconds = 3600.0 * int(text[11:13]) + 60.0 * int(text[14:16])
        midnight = datetime.date(year, month, day).toordinal() + 1721424.5  # JD
        tdb = Date(midnight, 0.0).after(seconds)
        moon = solar_system.relative_m("moon", "earth", tdb)
        barycentre = solar_system.relative_m("earth", "sun", tdb) + moon * 0.01215058
        for name, limit in PLAN94_ARCSEC.items():
            mine = solar_system.relative_m(name, "sun", tdb) - barycentre
            theirs = (planets[name] - planets["earth"]) * 1e3
            distance = np.linalg.norm(solar_system.relative_m(name, "sun", tdb))
            assert np.linalg.norm(mine - theirs) < math.radians((limit + 10) / 3600.0) * distance
            checked += 1
    assert checked >= 49


@pytest.mark.parametrize(("name", "period_days"), [("phobos", 0.31891023), ("europa", 3.551181)])
def test_locked_satellites(name, period_days):
    """They go round in their planet's equator, with the right period, the same face inwards."""
    planet = _core.BODIES[name]["parent"]
    start = date_from_utc((2026, 5, 1, 0, 0, 0.0))

    def place(days):
        return solar_system.relative_m(name, planet, start.after(days * 86400.0))

    pole = rotations.rotate(
        _core.body_orientation(planet, start.day, np.array([start.fraction]))[0],
        np.array([0.0, 0.0, 1.0]),
    )
    normal = np.cross(place(0.0), place(0.25 * period_days))
    assert angle_deg(normal, pole) < 2.0  # Phobos: inclination 1.08 deg
    assert angle_deg(place(0.0), place(100.0 * period_days)) < 4.0  # twice the libration
    assert abs(angle_deg(place(0.0), place(0.5 * period_days)) - 180.0) < 5.0


def test_j2000_in_utc():
    """J2000.0 is 2000-01-01 12:00 TT = 11:58:55.816 UTC (32 leap seconds and 32.184 s)."""
    date = date_from_utc((2000, 1, 1, 11, 58, 55.816))
    days = (date.day - 2451545.0) + date.fraction
    assert abs(days) * 86400.0 < 1e-4  # TDB - TT is -73 us there
    assert date_from_utc((2000, 1, 1, 11, 58, 55.816)).utc() == "2000-01-01T11:58:55.816Z"


def test_leap_second():
    before = date_from_utc((2016, 12, 31, 23, 59, 59.0))
    assert before.after(1.0).utc() == "2016-12-31T23:59:60.000Z"
    assert before.after(2.0).utc() == "2017-01-01T00:00:00.000Z"


def test_dates_keep_nanoseconds():
    date = date_from_utc((2026, 3, 20, 12, 0, 0.0))
    for seconds in (1e-9, 0.02, 59.0, 86400.0, 1e7 + 1e-6, -3600.0):
        later = date.after(seconds)
        got = (later.day - date.day) * 86400.0 + (later.fraction - date.fraction) * 86400.0
        ends = [erfa.dtdb(row.day, row.fraction, 0, 0, 0, 0) for row in (date, later)]
        expected = seconds + float(ends[1] - ends[0])  # in TDB, of seconds of TT
        assert abs(got - expected) < 2e-11 + 4e-16 * abs(seconds)
        assert 0.0 <= later.fraction < 1.0
