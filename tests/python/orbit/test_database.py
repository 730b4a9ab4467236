"""Classes of orbits: ranges, physics of the derived elements, and requests that cannot be met."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from perilune.base.random import generator
from perilune.orbits import orbit_classes as db
from perilune.orbits.gravity import ZONALS

DAY = 86400.0
EARTH = db.Centre(
    "earth", "earth", (6378137.0, 6378137.0, 6356752.0), 3.986004418e14, 1.4966e9,
    7.292115e-5, ZONALS["earth"], 365.242189 * DAY, 0.0, 100.0,
)  # fmt: skip
MOON = db.Centre(
    "moon", "moon", (1737400.0,) * 3, 4.90280011845755e12, 6.15e7,
    2.0 * math.pi / (27.321661 * DAY), ZONALS["moon"], 365.242189 * DAY, 0.0, 0.0,
)  # fmt: skip
MARS = db.Centre(
    "mars", "mars", (3396190.0, 3396190.0, 3376200.0), 4.282837362069909e13, 1.08e9,
    2.0 * math.pi / 88642.66, ZONALS["mars"], 686.973 * DAY, 0.0, 0.0,
)  # fmt: skip
PHOBOS = db.Centre("phobos", "phobos", (13000.0, 11400.0, 9100.0), 7.0875e5, 16600.0)
PEBBLE = db.Centre("pebble", None, (50.0, 40.0, 30.0), 10.0)


def draw(name, centre, seed=0, **given_ranges):
    return db.draw(name, centre, given_ranges, lambda key: generator(seed, key, 0))


@pytest.mark.parametrize("name", db.CLASSES)
@pytest.mark.parametrize("centre", [EARTH, MOON, MARS], ids=lambda c: c.name)
def test_every_class_respects_sizes(name, centre):
    """Above the ground, within the sphere of influence, or refused before anything is drawn."""
    possible = {("GEO", "moon"), ("GTO", "moon")}
    if (name, centre.name) in possible:
        with pytest.raises(ValueError, match="sphere of influence of moon"):
            draw(name, centre)
        return
    for seed in range(40):
        elements = draw(name, centre, seed)
        e = elements["eccentricity"]
        low = elements.get("semi_major_axis_km", 0.0) * (1 - e)
        if "semi_major_axis_km" not in elements or "altitude_km" in elements:
            low = centre.radius_km + elements["altitude_km"]
        assert low >= centre.radius_km + centre.floor_km - 1e-9
        assert low * (1 + e) / (1 - e) <= db.CLASSES[name].reach * centre.hill_radius_m / 1e3


# science: the two-body formula of Vallado section 11.4.1 with EGM96's J2, evaluated with 40 digits
# for R = 6378.137 km; ours takes the coefficient's own radius, 6378.1363 km (2e-7 of the cosine).
@pytest.mark.parametrize(
    ("altitude_km", "expected_deg"),
    [(200, 96.3273894687), (500, 97.4018077377), (800, 98.603110649), (2000, 104.890078403),
     (5974, 179.184216115)],
)  # fmt: skip
def test_sun_synchronous_inclination(altitude_km, expected_deg):
    found = db.sun_synchronous_deg(EARTH, 6378.137 + altitude_km, 0.0)
    assert found == pytest.approx(expected_deg, abs=2e-3 if altitude_km > 5000 else 1e-4)


@pytest.mark.parametrize(("altitude_km", "expected_deg"), [(300, 92.6604659), (400, 92.9212423)])
def test_sun_synchronous_inclination_of_mars(altitude_km, expected_deg):
    """The expected values take R = 3396.19 km; J2 belongs to 3397 km: 5e-4 of the cosine."""
    found = db.sun_synchronous_deg(MARS, 3396.19 + altitude_km, 0.0)
    assert found == pytest.approx(expected_deg, abs=2e-3)


def test_no_sun_synchronous_orbit_above_its_limit():
    """Hard case 26: beyond a = 12352.49 km around the Earth the cosine would pass -1."""
    with pytest.raises(ValueError, match=r"they end at 12352\.\d km"):
        draw("SSO", EARTH, altitude_km=(5900.0, 6200.0))
    draw("SSO", EARTH, altitude_km=(5900.0, 5973.0))
    with pytest.raises(ValueError, match="J2"):
        draw("SSO", PEBBLE, altitude_km=(0.1, 0.2))


def test_no_stationary_orbit_of_the_moon():
    """Hard case 27: its radius, 88 000 km, is beyond the Hill radius of 61 500 km."""
    with pytest.raises(ValueError, match=r"GEO around moon.*88\d\d\d.*Hill radius 61500 km"):
        draw("GEO", MOON)


def test_local_time_of_the_node():
    for hour, expected in ((12.0, 30.0), (18.0, 120.0), (10.5, 7.5)):
        centre = db.Centre(**{**vars(EARTH), "noon_deg": 30.0})
        assert draw("SSO", centre, ltan_h=(hour, hour))["raan_deg"] == pytest.approx(expected)


def test_stationary_orbit():
    """a = 42164.17 km with the sidereal day (science, section 3), over its longitude."""
    elements = draw("GEO", EARTH, longitude_deg=(-75.0, -75.0))
    assert elements["semi_major_axis_km"] == pytest.approx(42164.17, abs=0.01)
    assert elements["mean_anomaly_deg"] == pytest.approx(25.0)


def test_transfer_reaches_the_stationary_orbit():
    elements = draw("GTO", EARTH, altitude_km=(250.0, 250.0))
    low = 6378.137 + 250.0
    high = low * (1 + elements["eccentricity"]) / (1 - elements["eccentricity"])
    assert high == pytest.approx(42164.17, abs=0.01)


def test_giving_a_key_leaves_the_others():
    plain = draw("LEO", EARTH, seed=3)
    changed = draw("LEO", EARTH, seed=3, inclination_deg=(51.6, 51.6))
    assert changed == {**plain, "inclination_deg": 51.6}
    assert plain["inclination_deg"] != 51.6


@given(st.floats(0.0, 180.0), st.floats(0.0, 180.0), st.integers(0, 1000))
def test_inclinations_stay_in_their_range(a, b, seed):
    low, high = min(a, b), max(a, b)
    found = draw("LEO", EARTH, seed, inclination_deg=(low, high))["inclination_deg"]
    assert low <= found <= high


def test_inclinations_are_uniform_over_the_sphere():
    """Mean and variance of the cosine over 4000 draws: 0 and 1/3, within 5 standard errors."""
    cosines = np.cos(
        np.radians([draw("LEO", EARTH, seed)["inclination_deg"] for seed in range(4000)])
    )
    assert abs(cosines.mean()) < 5 * math.sqrt(1 / 3 / 4000)
    assert abs(cosines.var() - 1 / 3) < 5 * math.sqrt((1 / 5 - 1 / 9) / 4000)


def test_small_bodies():
    """Phobos' sphere of influence hardly clears its surface; a pebble has no table entry."""
    elements = draw("LEO", PHOBOS, eccentricity=(0.0, 0.0))
    assert 13.0 < 12.2 + elements["altitude_km"] <= 16.6
    with pytest.raises(ValueError, match=r"MEO around phobos.*do not exist"):
        draw("MEO", PHOBOS)
    elements = draw("LEO", PEBBLE)
    assert 0.05 < 0.045 + elements["altitude_km"] < 0.07


@pytest.mark.parametrize(
    ("name", "ranges", "text"),
    [
        ("LEO", {"ltan_h": (6.0, 6.0)}, "ltan_h: not a key of class LEO; .*altitude_km"),
        ("LEO", {"altitude_km": (100.0, 400.0)}, "periapsis, 100 km.*below 160 km"),
        ("LEO", {"altitude_km": (1e6, 2e6)}, "sphere of influence of earth"),
        ("LEO", {"eccentricity": (0.0, 1.0)}, "closed"),
        ("MOLNIYA", {"eccentricity": (0.7, 0.8)}, "periapsis"),
    ],
)
def test_requests_that_cannot_be_met(name, ranges, text):
    with pytest.raises(ValueError, match=text):
        draw(name, EARTH, **ranges)
