"""The channels `albedo` and `shadow_cause` where both are known."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.python.optics_scenes import at, ball, opened, tree

import perilune

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
POINT_SUN: dict[str, Any] = {"force_off": ["soft_sun", "antialiasing"], "samples": 1}


def test_matt_light_over_irradiance_is_the_albedo(repo_dir: Path) -> None:
    """L = albedo E cos / pi on a ball with a map, under a point Sun."""
    planet = ball(at(4.0), 2.0, albedo=0.8, emission_w_m2_sr=0.0, reflectance="lambert",
                  color_map="assets/maps/earth_like.jpg")  # fmt: skip
    scene = tree((64, 64), 60.0, planet=planet)
    scene["render"] |= POINT_SUN
    scene["sun"] = {"direction": [-1.0, 0.2, 0.3]}
    sim = opened(scene, repo_dir)
    sample = sim.frame(0, ["albedo", "radiance", "incidence", "instance", "position"])
    lit = (sample["instance"] == 2) & (sample["incidence"] < 1.4)
    irradiance = 1361.0 * np.cos(sample["incidence"][lit])
    found = sample["radiance"][lit] * np.pi / irradiance[:, None]
    assert lit.sum() > 500
    assert np.ptp(sample["albedo"][lit][:, 0]) > 0.1
    assert found / sample["albedo"][lit] == pytest.approx(np.full((lit.sum(), 3), 1.0), abs=5e-3)
    assert not sample["albedo"][sample["instance"] == 0].any()


def test_albedo_knows_no_light_and_no_plan(repo_dir: Path) -> None:
    sim = perilune.open(CONFIGS / "demo.yaml", overrides={"camera.width": 64, "camera.height": 48})
    alone = sim.frame(0, ["albedo"], threads=1)["albedo"]
    assert alone.max() > 0.5
    changes = {"sun.irradiance_w_m2": 1.0, "render.force_off": ["surface_maps", "texture_filter"]}
    other = sim.with_overrides(changes).frame(0, ["rgb", "albedo"], threads=2)["albedo"]
    assert np.array_equal(alone, other)


def test_rays_of_craters_are_in_it_with_and_without_colour() -> None:
    sim = perilune.open(
        CONFIGS / "lunar_orbiter.yaml", overrides={"camera.width": 48, "camera.height": 48}
    )
    alone = sim.frame(0, ["albedo"])["albedo"]
    assert alone.std() > 1e-3
    assert np.array_equal(alone, sim.frame(0, ["albedo", "rgb"])["albedo"])


def shadows(repo_dir: Path, **bodies: Any) -> perilune.Sample:
    """A satellite above a large ball, the Sun behind the camera."""
    scene = tree((64, 64), 60.0, far=ball(at(30.0), 9.0, albedo=0.5), **bodies)
    scene["sun"] = {"direction": [-1.0, 0.25, 0.15]}
    scene["spacecraft"]["sat"] = {
        "model": "assets/models/smallsat.glb",
        "size_m": 6.0,
        "orbit": {"around": "anchor", "position_km": at(12.0, 1.5)},
        "attitude": {"rotation_deg": [20.0, 30.0, 40.0]},
    }
    return opened(scene, repo_dir).frame(0, ["shadow", "shadow_cause", "instance"], threads=1)


def test_what_throws_shadows(repo_dir: Path) -> None:
    """Beside a satellite lies its shadow, on itself its own; behind a second ball everything that
    faces the Sun is eclipsed."""
    sample = shadows(repo_dir)
    ids = {"far": 2, "sat": 3}
    assert np.array_equal(sample["shadow"], sample["shadow_cause"] > 0)
    far, sat = (sample["shadow_cause"][sample["instance"] == ids[name]] for name in ("far", "sat"))
    assert {0, 2} <= set(np.unique(far)) <= {0, 1, 2}
    assert set(np.unique(sat)) == {0, 1}
    dark = shadows(repo_dir, moon=ball(at(-100.0, -25.0, -15.0), 60.0))
    causes = set(np.unique(dark["shadow_cause"][dark["instance"] > 0]))
    assert {3} <= causes <= {1, 3}


def test_the_ground_throws_shadows() -> None:
    """Of rocks and a lander on the Moon: whatever is dark has a cause."""
    changes = {"camera.width": 96, "camera.height": 72}
    sim = perilune.open(CONFIGS / "lunar_rover.yaml", overrides=changes)
    sample = sim.frame(6, ["shadow", "shadow_cause", "instance", "rock_id"])
    ids = sim.taxonomy.instances
    assert np.array_equal(sample["shadow"], sample["shadow_cause"] > 0)
    ground = (sample["instance"] == ids["moon"]) & (sample["rock_id"] == 0)
    assert {1, 2, 4} <= set(np.unique(sample["shadow_cause"][sample["instance"] > 0]))
    assert 3 not in sample["shadow_cause"]
    assert 4 in sample["shadow_cause"][ground]
    again = sim.frame(6, ["shadow_cause"], threads=3)["shadow_cause"]
    assert np.array_equal(again, sample["shadow_cause"])
