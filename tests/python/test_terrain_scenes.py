"""The ready-to-run scenes with terrain: small frames of them show the ground that heights tell."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import perilune

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
SMALL = {"camera.width": 32, "camera.height": 24, "render.samples": 1, "render.max_bounces": 0}
SCENES = [
    "lunar_rover",
    "paper2_segmentation",
    "mars_descent",
    *(
        pytest.param(name, marks=pytest.mark.needs_data)
        for name in (
            "lunar_orbiter",
            "lunar_lander",
            "lunar_pole",
            "apollo15",
            "paper2_slope",
        )
    ),
]


@pytest.mark.parametrize("name", SCENES)
def test_what_is_seen_lies_on_the_ground(name):
    sim = perilune.open(CONFIGS / f"{name}.yaml", overrides=SMALL)
    body = sim.config.root
    sample = sim.frame(1, channels=["radiance", "range", "position", "instance"], threads=1)
    ids = {sim.taxonomy.instances[body]}
    seen = np.isin(sample["instance"], list(ids))
    assert seen.mean() > 0.5
    assert np.isfinite(sample["radiance"]).all()
    assert (sample["radiance"][seen] > 0.0).mean() > 0.05
    world = sim.world(1)
    ground = world.ground(body)
    pixel = np.radians(sim.config.camera.fov_deg) / SMALL["camera.width"]
    camera = sim.camera_poses(1)[0, :3]
    for row, column in list(zip(*np.nonzero(seen), strict=True))[::9]:
        place = world.body_axes(body, np.asarray(sample["position"][row, column], float))
        away = float(np.linalg.norm(sample["position"][row, column] - camera))
        # Heights of the mesh are off by what is finer than its cells, of a pixel or two at most.
        assert abs(ground.height_m(place)) < 2.0 * pixel * away + 0.02, (row, column)


def test_the_ground_of_a_frame() -> None:
    """Its heights are those that things stand on; the same object until a driver changes it."""
    sim = perilune.open(CONFIGS / "lunar_rover.yaml")
    terrain = sim.terrain(0)
    assert terrain is sim.terrain(1, "moon")
    up = np.array([[0.6, 0.0, 0.8], [0.0, -1.0, 0.0]])
    ground = sim.world(0).ground("moon")
    for place, height_m in zip(up, terrain.heights(up), strict=True):
        assert abs(ground.height_m((1737.4e3 + height_m) * place)) < 1e-6
    other = sim.with_overrides({"bodies.moon.terrain.detail.seed": 4})
    assert other.terrain(0).heights(up) != pytest.approx(terrain.heights(up))


def test_a_body_without_terrain_is_named() -> None:
    demo = perilune.open(CONFIGS / "demo.yaml")
    with pytest.raises(ValueError, match="'planet' has no terrain; those with terrain: -"):
        demo.terrain(0, "planet")
    rover = perilune.open(CONFIGS / "lunar_rover.yaml")
    with pytest.raises(ValueError, match="'sun' has no terrain; those with terrain: moon"):
        rover.terrain(0, "sun")
