"""The sky's light on the ground about and beyond the terminator, against Monte Carlo."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from perilune import _core
from perilune.bodies import atmospheres
from perilune.config.atmosphere import Atmosphere

sys.path.insert(0, str(Path(__file__).resolve().parent))
import air_monte_carlo as brute
from test_limb import limb

F64 = NDArray[np.float64]

PATHS = 4000
HIGH = Atmosphere(
    rayleigh_per_km=(0.002, 0.004, 0.008),
    rayleigh_height_km=25.0,
    top_km=250.0,
    ground_albedo=(0.3, 0.3, 0.3),
)
"""As deep as the Earth's, half as high as its body: the frame `air` of the benchmarks."""
HIGH_M, EARTH_M = 500e3, 6371e3


def skylight(air: _core.AirSettings, radius_m: float, sine: float) -> tuple[F64, F64, F64]:
    """Irradiance of light scattered once, of all orders, and its standard error."""
    rng = np.random.default_rng(1)
    up = (np.arange(PATHS) + rng.random(PATHS)) / PATHS  # by the cosine: even in its square
    turn, flat = 2.0 * math.pi * rng.random(PATHS), np.sqrt(1.0 - up)
    along = np.stack([flat * np.cos(turn), flat * np.sin(turn), np.sqrt(up)], axis=1)
    at = np.array([0.0, 0.0, radius_m * (1.0 + 1e-9)])
    sun = np.array([math.sqrt(1.0 - sine * sine), 0.0, sine])
    albedo = np.array(air["ground_albedo"])
    found = brute.radiance(air, radius_m, at, along, sun, albedo, PATHS)
    return math.pi * found.once, math.pi * found.total, math.pi * found.noise


@pytest.mark.parametrize("sine", [0.1, -0.1, -0.25, -0.31, -0.4])
def test_high_air_lights_the_ground_deep_in_the_night(sine: float) -> None:
    """The tables ended at a sine of -0.3, where a sixth of the day's skylight is left."""
    air = atmospheres.settings(HIGH)
    made = _core.Air(air, HIGH_M)
    once, total, noise = skylight(air, HIGH_M, sine)
    np.testing.assert_allclose(made.skylight(sine, False), once, rtol=0.05)
    off = np.abs(np.array(made.skylight(sine, True)) / total - 1.0)
    assert (off < 0.02 + 3.0 * noise / total).all(), (sine, off, noise / total)


@pytest.mark.parametrize("sine", [0.1, -0.05])
def test_the_earths_twilight(sine: float) -> None:
    air = atmospheres.settings(Atmosphere(preset="earth"))
    _, total, noise = skylight(air, EARTH_M, sine)
    off = np.abs(np.array(_core.Air(air, EARTH_M).skylight(sine, True)) / total - 1.0)
    assert (off < 0.08 + 3.0 * noise / total).all(), (sine, off, noise / total)


@pytest.mark.parametrize(("preset", "percent"), [("earth", 15), ("mars", 40)])
def test_the_air_is_off_by_no_more_than_its_row_says(preset: str, percent: int) -> None:
    """Random rays past the limb and to the ground near it, the sun on any side, by day and dusk."""
    row = next(row for row in _core.EFFECTS if row["name"] == "multiple_scattering")
    assert f"{percent} % for {'the Earth' if preset == 'earth' else 'Mars'}'s" in row["doc"]
    rng = np.random.default_rng(5)
    low, high = (-40e3, -0.12, 10.0), (40e3, 1.0, 180.0)
    rays = [(-20e3, 0.5, 30.0), (-11e3, 0.2, 167.0), *rng.uniform(low, high, (10, 3))]
    worst = 0.0
    for low_m, up, aside_deg in rays:
        _, ours, truth = limb(preset, low_m, math.degrees(math.acos(up)), aside_deg, 600)
        light = truth.once + truth.more
        if (truth.noise < 0.06 * light).all():
            off = np.abs(ours / light - 1.0) - 2.0 * truth.noise / light
            worst = max(worst, float(off.max()))
    assert worst > 0.003 * percent
    assert worst < 0.01 * percent, worst


def test_skylight_fades_without_a_step() -> None:
    made = _core.Air(atmospheres.settings(HIGH), HIGH_M)
    light = np.array([made.skylight(sine, True)[2] for sine in np.linspace(0.0, -0.9, 300)])
    fall = light[1:] / light[:-1]
    assert (light > 0.0).all()
    assert (fall <= 1.0).all()
    assert fall.min() > 0.9
