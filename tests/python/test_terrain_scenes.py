"""The ready-to-run scenes with terrain: small frames of them show the ground that heights tell."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import perilune
from perilune import _core
from perilune.base import rotations
from perilune.frame import shutter

F64 = NDArray[np.float64]

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


def reliefs_m(terrain: _core.Terrain, d: F64, reach_rad: F64) -> F64:
    """(n,) highest less lowest ground, with all detail, within a distance of unit directions."""
    east = np.cross([0.0, 0.0, 1.0], d)
    east /= np.linalg.norm(east, axis=1, keepdims=True)
    around = [d]
    for turn in np.arange(8) * (math.pi / 4.0):
        way = math.cos(turn) * east + math.sin(turn) * np.cross(d, east)
        around += [d + (share * reach_rad)[:, None] * way for share in (0.35, 0.7, 1.0)]
    heights = np.stack([terrain.heights(row) for row in around])
    return np.asarray(np.ptp(heights, axis=0))


@pytest.mark.parametrize("name", SCENES)
def test_what_is_seen_lies_on_the_ground(name: str) -> None:
    """Points that are seen are within half of the relief, with all detail, of the ground of the
    cell at the pixel, but for less than 3 %, and within the relief of four cells for all. The few
    are tops, and craters too narrow for the cell."""
    sim = perilune.open(CONFIGS / f"{name}.yaml", overrides=SMALL)
    config = sim.config
    body = config.root
    given = config.bodies[body].terrain
    assert given is not None
    channels = ["radiance", "range", "position", "instance", "rock_id"]
    sample = sim.frame(1, channels=channels, threads=1)
    seen = sample["instance"] == sim.taxonomy.instances[body]
    assert seen.mean() > 0.5
    assert np.isfinite(sample["radiance"]).all()
    assert (sample["radiance"][seen] > 0.0).mean() > 0.05
    seen &= sample["rock_id"] == 0
    pick = np.random.default_rng(1).permutation(np.flatnonzero(seen))[:200]
    pose = shutter.middle(sim.world(1)).poses[body][0]
    axes = rotations.to_matrix(pose[3:])
    points = (sample["position"].reshape(-1, 3)[pick].astype(float) - pose[:3]) @ axes
    eye = (sim.camera_poses(1)[0, :3] - pose[:3]) @ axes
    away = np.linalg.norm(points, axis=1)
    d = points / away[:, None]
    distance = np.linalg.norm(points - eye, axis=1)
    sine = np.clip(-np.sum((points - eye) * d, axis=1) / distance, 0.25, 1.0)
    pixel_rad = 2.0 * math.tan(0.5 * math.radians(config.camera.fov_deg)) / SMALL["camera.width"]
    cell_m = math.sqrt(2.0) * distance * pixel_rad / (given.cells_per_pixel * np.sqrt(sine))
    cell_m = np.maximum(cell_m, 2.0 * given.finest_cell_m)
    terrain = sim.terrain(1)
    ground = sim.world(1).ground(body)
    off_m = np.abs(away - ground.datum_m(d) - terrain.heights(d))
    cells = [reliefs_m(terrain, d, reach * cell_m / away) for reach in (0.71, 1.42)]
    assert (off_m > 0.5 * cells[0]).mean() < 0.03
    assert (off_m > 0.5 * cells[1]).mean() < 0.01
    assert (off_m <= cells[1]).all()


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
