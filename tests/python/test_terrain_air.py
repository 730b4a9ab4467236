"""Air over terrain: skylight with and without bounces, ground below the ellipsoid and far above."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import perilune

RADIUS_KM, SCALE_KM = 3389.5, 11.0
SITE = {"lon_deg": 20.0, "lat_deg": 10.0}
CHANNELS = ["radiance", "instance"]


def air(ground_km: float) -> dict[str, Any]:
    """The same air for a body whose surface is at this height over that of another."""
    more = math.exp(-ground_km / SCALE_KM)
    return {
        "rayleigh_per_km": [1e-3 * more, 2e-3 * more, 4e-3 * more],
        "rayleigh_height_km": SCALE_KM,
        "mie_scattering_per_km": 0.02 * more,
        "mie_extinction_per_km": 0.025 * more,
        "mie_height_km": SCALE_KM,
        "mie_g": 0.6,
        "top_km": 110.0 - ground_km,
        "multiple_scattering": False,
    }


def planet(
    terrain: dict[str, Any] | None, ground_km: float = 0.0, off_nadir_deg: float = 90.0,
    sun_deg: float = 20.0, height_m: float = 2.0, dust: dict[str, Any] | None = None, **render: Any,
) -> perilune.Simulation:  # fmt: skip
    """A grey planet with air, seen from a height over its ground. `ground_km`: of its surface;
    `dust`: other air."""
    body = {"kind": "mars", "radii_km": [RADIUS_KM + ground_km] * 3, "albedo": 0.3}
    body |= {"atmosphere": dust or air(ground_km)} | (
        {} if terrain is None else {"terrain": terrain}
    )
    camera = {"width": 32, "height": 48, "fov_deg": 40.0, "exposure": {"mode": "auto"}}
    camera["trajectory"] = SITE | {
        "kind": "hover", "target": "planet", "height_m": height_m, "off_nadir_deg": off_nadir_deg,
        "clearance_m": None,
    }  # fmt: skip
    tree = {
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z"},
        "root": "planet",
        "sun": {"at": SITE | {"azimuth_deg": 90.0, "elevation_deg": sun_deg}},
        "bodies": {"planet": body},
        "camera": camera,
        "render": {"samples": 16, "max_bounces": 1, "tolerance_dn": 0.25} | render,
    }
    return perilune.open(tree)


def flat(tmp_path: Path, height_km: float) -> dict[str, Any]:
    """A whole body of one height."""
    path = tmp_path / "flat.npy"
    np.save(path, np.full((18, 36), 1e3 * height_km, np.float32))
    place = {"kind": "cylindrical", "west_deg": 0.0}
    return {"elevation": [{"file": str(path), "projection": place}], "detail": None}


def shown(sim: perilune.Simulation) -> tuple[np.ndarray, np.ndarray]:
    sample = sim.frame(0, [*CHANNELS, "rgb"], threads=1)
    assert np.isfinite(sample["radiance"]).all()
    return sample["radiance"].astype(float), sample["instance"] > 0


@pytest.mark.parametrize("sun_deg", [5.0, 40.0])
def test_skylight_does_not_need_bounces(sun_deg: float) -> None:
    """Of flat terrain it is that of a smooth body; a Sun at 5 degrees gives less light than it."""
    nothing = {"detail": {"strength": 0.0}}
    down = {"off_nadir_deg": 20.0, "height_m": 500.0, "sun_deg": sun_deg}
    smooth = shown(planet(None, **down))[0].mean()
    for bounces in (0, 1, 2):
        light = shown(planet(nothing, max_bounces=bounces, **down))[0].mean()
        assert light == pytest.approx(smooth, rel=0.03), bounces
        dark = shown(planet(nothing, max_bounces=bounces, force_off=["skylight"], **down))[0].mean()
        assert dark < (0.75 if sun_deg < 10.0 else 0.95) * light, bounces


@pytest.mark.parametrize(
    ("sun_deg", "net", "within"), [(5.0, 0.373, 0.3), (10.0, 0.502, 0.1), (30.0, 0.740, 0.1)]
)
def test_light_under_dust_is_that_of_published_tables(
    sun_deg: float, net: float, within: float
) -> None:
    """`net`: sunlight that the ground of Mars takes in under dust of depth 0.4, over that without
    air (Appelbaum and Flood 1990, Solar Energy 45, table III, albedo 0.1, all wavelengths on level
    layers; a round body has more of the lowest Sun). At 5 degrees the Sun itself is a tenth of the
    sky's light at most: shadows are pale."""
    extinction = 0.4 / 9.0
    dust = {"mie_extinction_per_km": extinction, "mie_scattering_per_km": 0.93 * extinction}
    down = {"off_nadir_deg": 0.0, "sun_deg": sun_deg, "height_m": 20.0, "tolerance_dn": 0.0}
    below = planet(None, dust={"preset": "mars"} | dust, **down)
    below = below.with_overrides(
        {"bodies.planet.albedo": 0.1, "camera.width": 8, "camera.height": 6}
    )
    light = shown(below)[0].mean()
    direct = shown(below.with_overrides({"render.force_off": ["skylight"]}))[0].mean()
    bare = shown(below.with_overrides({"bodies.planet.atmosphere": None}))[0].mean()
    assert light / bare == pytest.approx(net / 0.9, rel=within)
    beer = math.exp(-0.4 / math.sin(math.radians(sun_deg)))
    assert 0.95 * beer < direct / bare < beer + 0.03
    assert sun_deg > 5.0 or direct < 0.1 * (light - direct)


def test_exposure_counts_the_light_of_the_sky() -> None:
    """With the Sun low, most light on the ground is that of the sky."""
    sim = planet({"detail": {"seed": 1}}, off_nadir_deg=20.0, height_m=500.0, sun_deg=5.0)
    rgb = sim.frame(0, ["rgb"], threads=1)["rgb"]
    assert (rgb == 255).mean() < 0.02
    assert np.percentile(rgb, 99.0) > 200


@pytest.mark.parametrize("height_km", [-8.0, -2.0, 0.0, 20.0])
def test_the_air_goes_on_below_and_thins_above(tmp_path: Path, height_km: float) -> None:
    """Over ground at one height, the sky, the haze and the light are those of a body whose surface
    is there."""
    for off_nadir_deg, height_m in ((85.0, 2.0), (60.0, 3000.0)):
        view = {"off_nadir_deg": off_nadir_deg, "height_m": height_m}
        light, ground = shown(planet(flat(tmp_path, height_km), **view))
        same, there = shown(planet(None, height_km, **view))
        assert (ground != there).mean() < 0.05
        for of in (ground & there, ~ground & ~there):
            if of.sum() > 100:
                np.testing.assert_allclose(light[of].mean(axis=0), same[of].mean(axis=0), rtol=0.02)
        sky = ~ground & ~there
        np.testing.assert_allclose(light[sky], same[sky], rtol=0.03)


def test_no_seam_where_rays_become_level(tmp_path: Path) -> None:
    """From a basin floor, the sky has no step at the horizon, below which rays meet the ellipsoid's
    inside; nor has the haze on a wall of the basin."""
    rows, columns = np.mgrid[:360, :720]
    away = np.hypot(columns / 2.0 - SITE["lon_deg"], 90.0 - rows / 2.0 - SITE["lat_deg"])
    path = tmp_path / "basin.npy"
    np.save(path, np.where(away < 6.0, -8e3, 0.0).astype(np.float32))
    terrain = {
        "elevation": [{"file": str(path), "projection": {"kind": "cylindrical", "west_deg": 0.0}}]
    }
    sim = planet(terrain | {"detail": None}, off_nadir_deg=90.0, height_m=3000.0)
    light, ground = shown(sim)
    assert 0.3 < ground.mean() < 0.7
    column = light.mean(axis=1)
    steps = np.abs(np.diff(np.log(column), axis=0)).max(axis=1)
    horizon = np.argmax(ground.mean(axis=1) > 0.5)
    quiet = np.r_[3 : horizon - 2, horizon + 3 : len(steps) - 3]
    assert steps[quiet].max() < 0.1
