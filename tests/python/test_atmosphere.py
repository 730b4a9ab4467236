"""Atmospheres against numerical integrals, brute-force marching and bounds of energy."""

from __future__ import annotations

import math
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from scipy.integrate import quad

from perilune import _core
from perilune.base import spectra
from perilune.bodies import atmospheres
from perilune.config.atmosphere import Atmosphere

sys.path.insert(0, str(Path(__file__).resolve().parent))
from air_monte_carlo import densities, extinctions, limb_ray

F64 = NDArray[np.float64]

RADIUS_M = 6371e3
UM = (0.68, 0.55, 0.44)
SUN_RAD = 0.00465


def earth(**changes: Any) -> _core.AirSettings:
    """The Earth's preset at 680, 550 and 440 nm, with single scattering."""
    given_ = Atmosphere(preset="earth", multiple_scattering=False)
    return cast("_core.AirSettings", {**atmospheres.settings(given_, UM), **changes})


def mars(**changes: Any) -> _core.AirSettings:
    given_ = Atmosphere(preset="mars", multiple_scattering=False)
    return cast("_core.AirSettings", {**atmospheres.settings(given_, UM), **changes})


def way_m(radius_m: float, top_m: float, r: Any, mu: Any) -> Any:
    """From distance r from the centre under zenith cosine mu to the top."""
    return -r * mu + np.sqrt(np.maximum(0.0, (r * mu) ** 2 + (radius_m + top_m) ** 2 - r**2))


def depth(air: _core.AirSettings, radius_m: float, height_m: float, mu: float) -> F64:
    """Optical depths of the bands to the top, by QUADPACK."""
    r = radius_m + height_m
    length = float(way_m(radius_m, air["top_m"], r, mu))

    def height(s: float) -> float:
        return math.sqrt(r * r + 2.0 * r * mu * s + s * s) - radius_m

    columns = []
    bends = [air["ozone_center_m"] + k * air["ozone_width_m"] for k in (-1, 0, 1)]
    bends += [air["rayleigh_upper_m"][0], air["mie_upper_m"][0]]
    stops = [float(way_m(radius_m, bend, r, mu)) for bend in bends if bend > height_m]
    scales = [x for x in (1e3, 1e4, 3e4, 1e5, 3e5, *stops) if 0.0 < x < length]
    edges = [0.0, *sorted(scales), length]
    for part in range(3):
        total = 0.0
        for low, high in pairwise(edges):
            total += quad(
                lambda s, part=part: densities(air, np.array(height(s)))[part],
                low,
                high,
                epsrel=1e-10,
                epsabs=1e-9,
            )[0]
        columns.append(total)
    return np.array(columns) @ extinctions(air)


def rays(height_m: float, cosines: list[float], azimuth: float = 0.0) -> tuple[F64, F64]:
    mu = np.array(cosines)
    across = np.sqrt(1.0 - mu**2)
    points = np.tile([0.0, 0.0, RADIUS_M + height_m], (len(mu), 1))
    return points, np.stack([across * math.cos(azimuth), across * math.sin(azimuth), mu], axis=1)


# Air masses of an exponential atmosphere with R = 6371 km, H = 8 km: Chapman's function, by
# numerical integration; at the horizon X exp(X) K1(X), X = R/H.
CHAPMAN = {
    0: 1.0,
    30: 1.154219634,
    60: 1.992576765,
    75: 3.799616835,
    80: 5.55052004,
    85: 10.14002635,
    88: 18.6661093,
    89: 24.86639612,
    90: 35.3853195177,
}


@pytest.mark.parametrize("zenith_deg", CHAPMAN)
def test_air_mass_is_chapmans(zenith_deg: int) -> None:
    scattering = (1e-6, 1e-5, 3e-5)
    none = (0.0, 0.0, 0.0)
    air = earth(
        rayleigh_scattering=scattering,
        rayleigh_height_m=8e3,
        rayleigh_upper_m=(0.0, 0.0),
        mie_scattering=none,
        mie_extinction=none,
        ozone_absorption=none,
        top_m=400e3,
    )
    cosine = math.cos(math.radians(zenith_deg)) if zenith_deg < 90 else 0.0
    found = _core.Air(air, RADIUS_M).transmittance(*rays(0.0, [cosine]))[0]
    expected = np.exp(-np.array(scattering) * 8e3 * CHAPMAN[zenith_deg])
    np.testing.assert_allclose(found, expected, rtol=1e-3)


@pytest.mark.parametrize("make", [earth, mars])
@pytest.mark.parametrize("height_m", [0.0, 1.0, 1.7e3, 9.5e3, 24.8e3, 41e3, 80e3])
def test_transmittance_is_that_of_the_integral(make: Any, height_m: float) -> None:
    settings_ = make()
    cosines = [1.0, 0.8, 0.4, 0.2, 0.1, 0.05, 0.03, 0.01, 0.0]
    found = _core.Air(settings_, RADIUS_M).transmittance(*rays(height_m, cosines))
    expected = np.array([depth(settings_, RADIUS_M, height_m, mu) for mu in cosines])
    np.testing.assert_allclose(found, np.exp(-expected), rtol=1e-3 + 1e-3 * expected.max())


def test_transmittance_past_the_limb() -> None:
    settings_ = earth()
    for height_m, low_m in [(20e3, 19e3), (99e3, 5e3), (400e3, 0.0), (400e3, 12e3), (400e3, 99e3)]:
        mu = -math.sqrt(1.0 - ((RADIUS_M + low_m) / (RADIUS_M + height_m)) ** 2)
        found = _core.Air(settings_, RADIUS_M).transmittance(*rays(height_m, [mu]))[0]
        grazing = depth(settings_, RADIUS_M, low_m, 0.0)
        behind = depth(settings_, RADIUS_M, height_m, -mu) if height_m < 100e3 else 0.0
        # 1e-3 of what comes through, and the depth to 2e-4 where hardly anything does.
        expected = 2.0 * grazing - behind
        logs = -np.log(np.maximum(found, 1e-30))
        np.testing.assert_allclose(logs, expected, rtol=6e-4, atol=1e-3)


def march(
    air: _core.AirSettings, radius_m: float, point: F64, direction: F64, sun: F64, steps: int
) -> tuple[F64, F64]:
    """Radiance and transmittance along a ray by even steps, each point's way to the sun by even
    steps of a square law; the sun is a disc, 9 x 9 points of which count where they are up."""
    b = float(point @ direction)
    outer = b * b - float(point @ point) + (radius_m + air["top_m"]) ** 2
    if outer <= 0.0:
        return np.zeros(3), np.ones(3)
    start, end = max(0.0, -b - math.sqrt(outer)), -b + math.sqrt(outer)
    inner = b * b - float(point @ point) + radius_m**2
    if inner > 0.0 and b < 0.0:
        end = min(end, -b - math.sqrt(inner))
    if end <= start:
        return np.zeros(3), np.ones(3)
    step = (end - start) / steps
    s = start + step * (np.arange(steps) + 0.5)
    at = point + s[:, None] * direction
    r = np.linalg.norm(at, axis=1)
    density = densities(air, r - radius_m)
    mu = (at @ sun) / r
    horizon = -np.sqrt(np.maximum(0.0, 1.0 - (radius_m / r) ** 2))
    up = np.arcsin(np.clip(mu, -1, 1)) - np.arcsin(horizon)
    x = np.clip(up / SUN_RAD, -1.0, 1.0)
    visible = 0.5 + (x * np.sqrt(1.0 - x * x) + np.arcsin(x)) / math.pi
    low = np.where(up < SUN_RAD, 0.5 * (up + SUN_RAD), up)
    mu = np.where(visible > 0.0, np.sin(np.arcsin(horizon) + low), 1.0)
    length = way_m(radius_m, air["top_m"], r, mu)
    fine = 500
    v = (np.arange(fine) + 0.5) / fine
    # Even in the way beyond its lowest point, so that its thick part is met.
    middle = np.clip(-r * mu, 0.0, length)
    toward = np.zeros((3, steps))
    for low_s, high_s in ((middle, np.zeros(steps)), (middle, length)):
        y = low_s[:, None] + (high_s - low_s)[:, None] * v**2
        dy = np.abs(high_s - low_s)[:, None] * 2.0 * v / fine
        h = np.sqrt((r**2)[:, None] + 2.0 * (r * mu)[:, None] * y + y**2) - radius_m
        toward += (densities(air, np.maximum(h, 0.0)) * dy).sum(axis=2)
    along = (np.cumsum(density, axis=1) - 0.5 * density) * step
    dimmed = np.exp(-((toward + along).T @ extinctions(air))) * visible[:, None]
    cosine = float(direction @ sun)
    rayleigh = 3.0 / (16.0 * math.pi) * (1.0 + cosine**2)
    g = np.array(air["mie_g"])
    mie = 3.0 / (8.0 * math.pi) * (1.0 - g**2) * (1.0 + cosine**2)
    mie = mie / ((2.0 + g**2) * (1.0 + g**2 - 2.0 * g * cosine) ** 1.5)
    sent = density[0][:, None] * rayleigh * np.array(air["rayleigh_scattering"])
    sent = sent + density[1][:, None] * mie * np.array(air["mie_scattering"])
    passed = np.exp(-(density.sum(axis=1) * step) @ extinctions(air))
    return (sent * dimmed).sum(axis=0) * step, passed


# Height of the eye, zenith cosine of the view, azimuth from the sun's, sine of the sun's height.
VIEWS = {
    "nadir": (400e3, -1.0, 0.0, 0.5),
    "oblique": (400e3, -0.5, 0.4, 0.7),
    "far ground": (400e3, -0.345, 2.0, 0.3),
    "limb at 12 km": (400e3, -0.3346, 0.0, 0.4),
    "limb at 30 km": (400e3, -0.3298, 1.0, 0.1),
    "limb at 0 km": (400e3, -0.33824, 0.5, 0.5),
    "limb at sunset": (400e3, -0.3346, 0.3, -0.2),
    "zenith": (0.0, 1.0, 0.0, 0.6),
    "sky": (0.0, 0.3, 1.0, 0.4),
    "horizon": (0.0, 0.0, 0.0, 0.5),
    "sky, sun at the horizon": (0.0, 0.3, 0.5, 0.0),
    "down inside": (10e3, -0.2, 0.5, 0.5),
    "limb from inside": (15e3, -0.03, 0.5, 0.5),
    "past the limb from inside": (60e3, -0.11, 2.0, 0.3),
    "from the top, up": (100e3, 0.5, 0.0, 0.5),
    "from afar": (4e8, -math.sqrt(1.0 - (0.5 * 6371e3 / 4.06371e8) ** 2), 1.0, 0.8),
}


@pytest.mark.parametrize("make", [earth, mars])
@pytest.mark.parametrize("view", VIEWS)
def test_scattered_light_is_that_of_brute_force(make: Any, view: str) -> None:
    height_m, mu, azimuth, sine = VIEWS[view]
    settings_ = make()
    points, directions = rays(height_m, [mu], azimuth)
    sun = (math.sqrt(1.0 - sine * sine), 0.0, sine)
    found, passed = _core.Air(settings_, RADIUS_M).scatter(
        points, directions, sun, SUN_RAD, math.inf, 12, False
    )
    light, through = march(settings_, RADIUS_M, points[0], directions[0], np.array(sun), 1500)
    np.testing.assert_allclose(found[0], light, rtol=1e-2, atol=1e-6)
    np.testing.assert_allclose(passed[0], through, rtol=1e-2, atol=1e-4)


_log = st.floats(0.0, 1.0)


@settings(max_examples=60)
@given(
    depth_=st.floats(0.01, 5.0),
    absorbed=st.floats(0.0, 0.9),
    g=st.floats(-0.6, 0.9),
    ratio=st.floats(1e-5, 0.3),
    start=st.floats(0.0, 2.0),
    mu=st.floats(-1.0, 1.0),
    sine=st.floats(-1.0, 1.0),
)
def test_energy(
    depth_: float, absorbed: float, g: float, ratio: float, start: float, mu: float, sine: float
) -> None:
    radius_m = 1e6
    height_m = ratio * radius_m
    band = (depth_ / height_m,) * 3
    settings_ = earth(
        rayleigh_scattering=tuple(0.5 * b for b in band),
        rayleigh_height_m=height_m,
        rayleigh_upper_m=(1.5 * height_m, 0.7 * height_m),
        mie_extinction=tuple(0.5 * b for b in band),
        mie_scattering=tuple(0.5 * (1.0 - absorbed) * b for b in band),
        mie_height_m=0.5 * height_m,
        mie_g=(g,) * 3,
        top_m=8.0 * height_m,
    )
    air = _core.Air(settings_, radius_m)
    across = math.sqrt(1.0 - mu * mu)
    point = np.array([[0.0, 0.0, radius_m + start * settings_["top_m"]]])
    direction = np.array([[across, 0.0, mu]])
    sun = (0.6 * math.sqrt(1.0 - sine * sine), 0.8 * math.sqrt(1.0 - sine * sine), sine)
    light, passed = air.scatter(point, direction, sun, SUN_RAD, math.inf, 32, False)
    assert np.isfinite(light).all()
    assert (light >= 0.0).all()
    assert ((passed >= 0.0) & (passed <= 1.0)).all()
    # What is sent on is at most what the way takes out, times the largest phase.
    cosine = float(direction[0] @ np.array(sun))
    mie = 3.0 / (8.0 * math.pi) * (1.0 - g * g) * (1.0 + cosine**2)
    mie /= (2.0 + g * g) * (1.0 + g * g - 2.0 * g * cosine) ** 1.5
    largest = max(mie, 3.0 / (16.0 * math.pi) * (1.0 + cosine**2))
    assert (light <= largest * (1.0 - passed) * 1.02 + 1e-6).all()
    # Shorter ways take less.
    lengths = [0.01, 0.1, 0.5, 1.0, 2.0, 8.0]
    passes = [
        air.scatter(point, direction, sun, SUN_RAD, x * settings_["top_m"], 4, False)[1][0, 0]
        for x in lengths
    ]
    assert all(b <= a + 1e-5 for a, b in pairwise(passes))


@pytest.mark.parametrize("multiple", [False, True])
def test_ground_gets_no_more_than_the_sun_sends(multiple: bool) -> None:
    settings_ = earth(multiple=multiple)
    air = _core.Air(settings_, RADIUS_M)
    albedo = np.array(settings_["ground_albedo"])
    for sine in np.linspace(0.05, 1.0, 20):
        across = math.sqrt(1.0 - sine * sine)
        passed = air.transmittance(
            np.array([[0.0, 0.0, RADIUS_M]]), np.array([[across, 0.0, sine]])
        )[0]
        sky = np.array(air.skylight(float(sine), multiple))
        assert (sky > 0.0).all()
        # Light that the ground sends back and the sky returns is counted in `multiple`.
        assert ((sine * passed + sky) * (1.0 - albedo) < sine).all()


def test_multiple_scattering_adds_blue_by_day() -> None:
    # Its share of the day sky: 10 to 30 %, up to twice in the blue.
    air = _core.Air(earth(multiple=True), RADIUS_M)
    points, directions = rays(0.0, [1.0, 0.5])
    sun = (math.sqrt(0.51), 0.0, 0.7)
    once = air.scatter(points, directions, sun, SUN_RAD, math.inf, 16, False)[0]
    more = air.scatter(points, directions, sun, SUN_RAD, math.inf, 16, True)[0]
    ratio = more / once
    assert (ratio > 1.04).all()  # haze beside the sun is bright by itself
    assert (ratio < 2.0).all()
    assert (ratio[:, 2] > ratio[:, 0]).all()


def test_what_is_refused() -> None:
    for change in (
        {"mie_scattering": (1.0, 1.0, 1.0)},
        {"mie_g": (1.0, 0.0, 0.0)},
        {"top_m": 0.0},
        {"rayleigh_height_m": math.nan},
        {"rayleigh_upper_m": (-1.0, 1e3)},
        {"mie_upper_m": (9e3, 0.0)},
        {"rayleigh_scattering": (-1.0, 0.0, 0.0)},
        {"ground_albedo": (0.0, 2.0, 0.0)},
    ):
        with pytest.raises(ValueError, match="atmosphere"):
            _core.Air(earth(**change), RADIUS_M)
    with pytest.raises(ValueError, match="radius"):
        _core.Air(earth(), 0.0)


# What the presets stand for, against published values that they are not made of.
STANDARD = {0: 1.2250, 5: 0.73643, 10: 0.41351, 15: 0.19476, 20: 0.08891, 25: 0.04008,
            30: 0.01841, 40: 0.003996, 50: 0.001027}  # fmt: skip
"""Height, km -> density of the U.S. Standard Atmosphere 1976, kg m-3."""
OZONE = {16: 2.95, 18: 4.04, 20: 4.77, 22: 4.86, 24: 4.54, 26: 4.03, 28: 3.24, 30: 2.52, 32: 2.03}
"""Height, km -> 1e18 molecules m-3 at middle latitudes, its table 18, of 345 Dobson units."""


def test_the_earths_gas_thins_out_as_the_standard_atmosphere_does() -> None:
    heights = np.array(list(STANDARD), dtype=float) * 1e3
    published = np.array(list(STANDARD.values())) / STANDARD[0]
    np.testing.assert_allclose(densities(earth(), heights)[0], published, rtol=0.15)
    assert _core.Air(earth(), RADIUS_M).transmittance(*rays(0.0, [1.0])).shape == (1, 3)


def test_the_earths_ozone_lies_where_it_is_found() -> None:
    heights = np.array(list(OZONE), dtype=float) * 1e3
    published = np.array(list(OZONE.values())) / 345.0 * 300.0
    found = densities(earth(), heights)[2] * atmospheres._OZONE_PER_M3 / 1e18
    np.testing.assert_allclose(found, published, rtol=0.25, atol=0.1)
    assert np.trapezoid(found, heights) == pytest.approx(np.trapezoid(published, heights), rel=0.1)


def test_the_earths_depths_are_the_published_ones() -> None:
    """Gas: Bodhaine et al. 1999; haze: the mean of the Earth of Kinne 2019."""
    um = (0.65, 0.55, 0.45)
    air = atmospheres.settings(Atmosphere(preset="earth"), um)
    heights = np.linspace(0.0, 100e3, 200001)
    gas, haze, _ = np.trapezoid(densities(air, heights), heights, axis=1)
    found = np.array(air["rayleigh_scattering"]) * gas
    np.testing.assert_allclose(found, [0.049188, 0.097069, 0.22111], rtol=2e-3)
    found = np.array(air["mie_extinction"]) * haze
    np.testing.assert_allclose(found[1:], [0.122, 0.144], rtol=2e-3)
    below = np.trapezoid(densities(air, heights[:6001])[1], heights[:6001]) / haze
    assert below == pytest.approx((0.041 + 0.059) / 0.122, abs=0.05)  # under 3 km


def test_the_dust_of_mars_is_the_published_one() -> None:
    air = atmospheres.settings(Atmosphere(preset="mars"), (0.70, 0.65, 0.388))
    heights = np.linspace(0.0, 110e3, 200001)
    dust = np.trapezoid(densities(air, heights)[1], heights)
    assert np.array(air["mie_extinction"]) * dust == pytest.approx(0.375, rel=1e-3)
    share = np.array(air["mie_scattering"]) / np.array(air["mie_extinction"])
    assert share == pytest.approx([0.975, 0.967, 0.73], abs=2e-3)
    assert 6e3 <= air["mie_height_m"] <= 12e3  # over the seasons


def sun_at(direction: F64, point: F64, zenith_deg: float, azimuth_deg: float) -> F64:
    """Towards the sun, by its zenith angle at a ray's lowest point and its azimuth from there."""
    up = point - direction * float(point @ direction)
    up = up / np.linalg.norm(up)
    zenith, azimuth = math.radians(zenith_deg), math.radians(azimuth_deg)
    flat = math.cos(azimuth) * direction + math.sin(azimuth) * np.cross(up, direction)
    return np.asarray(math.cos(zenith) * up + math.sin(zenith) * flat)


def test_three_bands_have_the_colour_of_the_spectrum() -> None:
    """The limb in 39 wavelengths, seen as sRGB, against the bands of the preset. With the dominant
    wavelengths of the primaries instead, blue over red is 3.0 where the spectrum has 4.9."""
    um = np.linspace(0.385, 0.775, 39)
    sun = um**-5.0 / np.expm1(14387.77 / (um * 5850.0)) * np.where(um < 0.4, 0.7, 1.0)
    weights = spectra.srgb_response(um) * sun
    weights /= weights.sum(axis=1, keepdims=True)
    given_ = Atmosphere(preset="earth", multiple_scattering=False)

    def limb(wavelengths: Any, height_m: float) -> F64:
        point, direction = limb_ray(RADIUS_M, 418e3, height_m)
        toward = tuple(sun_at(direction, point, 50.0, 100.0))
        air = _core.Air(atmospheres.settings(given_, wavelengths), RADIUS_M)
        return air.scatter(
            point[None], direction[None], toward, SUN_RAD, math.inf, 32, False
        )[0][0]  # fmt: skip

    for height_m, off in ((-20e3, 0.03), (5e3, 0.03), (20e3, 0.13), (30e3, 0.05), (40e3, 0.015)):
        spectrum = np.concatenate([limb(um[i : i + 3], height_m) for i in range(0, 39, 3)])
        np.testing.assert_allclose(limb(None, height_m), weights @ spectrum, rtol=off)


def test_given_scale_heights_have_no_layer_above() -> None:
    air = atmospheres.settings(Atmosphere(preset="earth", rayleigh_height_km=8.0))
    assert air["rayleigh_height_m"] == 8e3
    assert air["rayleigh_upper_m"][0] == 0.0
    with pytest.raises(ValueError, match="needs rayleigh_upper_height_km"):
        Atmosphere(preset="earth", rayleigh_upper_from_km=11.0)
    own = Atmosphere(
        preset="earth", rayleigh_height_km=9.0, rayleigh_upper_from_km=11.0,
        rayleigh_upper_height_km=6.0,
    )  # fmt: skip
    assert atmospheres.settings(own)["rayleigh_upper_m"] == (11e3, 6e3)
