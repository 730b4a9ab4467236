"""The ready-to-run scenes with terrain: small frames of them show the ground that heights tell."""

from __future__ import annotations

import sys
from dataclasses import replace
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
    """Points that are seen lie on patches through heights of one level at nodes of the lattice, and
    within half of the cell's relief of that level's heights."""
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
    found = terrain_depth.judge(terrain_depth.pick(sim, 100))
    assert (found.pixels, found.beside, found.half) == (100, 0, 0)


def test_a_thousandth_of_a_cell_off_the_mesh_is_noticed() -> None:
    sim = perilune.open(CONFIGS / "mars_descent.yaml", overrides=SMALL)
    seen = terrain_depth.pick(sim, 30)
    _, levels, _ = seen.mesh.fit(seen.points, seen.coarsest, 6)
    cells = np.array([seen.mesh.cell_m(int(level)) for level in levels])
    away = np.linalg.norm(seen.points, axis=1)
    for by, beside, half in ((0.0, 0, 0), (1e-3, 30, 0), (-0.5, 30, 25)):
        moved = seen.points * (1.0 + by * cells / away)[:, None]
        found = terrain_depth.judge(replace(seen, points=moved, coarsest=levels), levels=0)
        assert found.beside == beside
        assert found.half >= half


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
