"""The ready-to-run scenes with terrain: small frames of them show the ground that heights tell."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import perilune

sys.path.insert(0, str(Path(__file__).resolve().parent))
import terrain_depth

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
SMALL = {"camera.width": 64, "camera.height": 48, "render.samples": 1, "render.max_bounces": 0}
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
def test_what_is_seen_lies_on_the_ground(name: str) -> None:
    """Points that are seen are within the relief, with all detail, of the cell at the pixel, and
    within half of it but for 3 %: those on tops and in hollows narrower than the cell, which lie
    in the outer half of its heights themselves."""
    sim = perilune.open(CONFIGS / f"{name}.yaml", overrides=SMALL)
    config = sim.config
    body = config.root
    given = config.bodies[body].terrain
    assert given is not None
    channels = ["radiance", "instance"]
    sample = sim.frame(1, channels=channels, threads=1)
    seen = sample["instance"] == sim.taxonomy.instances[body]
    assert seen.mean() > 0.5
    assert np.isfinite(sample["radiance"]).all()
    assert (sample["radiance"][seen] > 0.0).mean() > 0.05
    found = terrain_depth.look(sim, 200)
    assert found.pixels == 200
    assert found.half <= 6
    assert found.whole == 0


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
