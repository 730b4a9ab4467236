"""How far points that are seen lie from the heights with all detail, beside the relief of the cell
of the mesh at the pixel: `script/soak` looks at 10 000 pixels of every scene with terrain."""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import perilune
from perilune import _core
from perilune.base import rotations
from perilune.frame import shutter

F64 = NDArray[np.float64]
CONFIGS = Path(__file__).resolve().parents[2] / "configs"
SCENES = (
    "lunar_rover",
    "paper2_segmentation",
    "mars_descent",
    "lunar_orbiter",
    "lunar_lander",
    "lunar_pole",
    "apollo15",
    "paper2_slope",
)
QUIET = {"render.samples": 1, "render.max_bounces": 0}
FLOOR = 1e-7
"""Of the distance: rounding of single precision."""


@dataclass(frozen=True)
class Report:
    pixels: int
    half: int  # farther from the heights than half of the cell's relief
    whole: int  # than all of it


def _range_m(heights: F64, at: F64, axes: tuple[F64, F64], reach: F64, side: int,
             terrain: _core.Terrain) -> tuple[F64, F64]:  # fmt: skip
    """Lowest and highest ground, with all detail, at side^2 places of a square about directions."""
    low, high = heights.copy(), heights.copy()
    for x in np.linspace(-1.0, 1.0, side):
        for y in np.linspace(-1.0, 1.0, side):
            d = at + (x * reach)[:, None] * axes[0] + (y * reach)[:, None] * axes[1]
            found = terrain.heights(d / np.linalg.norm(d, axis=1, keepdims=True))
            low, high = np.minimum(low, found), np.maximum(high, found)
    return low, high


def look(sim: perilune.Simulation, pixels: int) -> Report:
    """Pixels of frame 1 that show ground, at random. Cells are the widest that the choice of tiles
    allows there: sqrt(2) of a pixel over the root of the sine of the elevation (at least 1/4)."""
    body = sim.config.root
    given = sim.config.bodies[body].terrain
    assert given is not None
    sample = sim.frame(1, ["position", "instance", "rock_id"], threads=1)
    seen = (sample["instance"] == sim.taxonomy.instances[body]) & (sample["rock_id"] == 0)
    pick = np.random.default_rng(1).permutation(np.flatnonzero(seen))[:pixels]
    pose = shutter.middle(sim.world(1)).poses[body][0]
    axes = rotations.to_matrix(pose[3:])
    points = (sample["position"].reshape(-1, 3)[pick].astype(float) - pose[:3]) @ axes
    eye = (sim.camera_poses(1)[0, :3] - pose[:3]) @ axes
    away = np.linalg.norm(points, axis=1)
    d = points / away[:, None]
    distance = np.linalg.norm(points - eye, axis=1)
    sine = np.clip(-np.sum((points - eye) * d, axis=1) / distance, 0.25, 1.0)
    width = sim.config.camera.width
    pixel_rad = 2.0 * math.tan(0.5 * math.radians(sim.config.camera.fov_deg)) / width
    cell_m = math.sqrt(2.0) * distance * pixel_rad / (given.cells_per_pixel * np.sqrt(sine))
    reach = 0.5 * np.maximum(cell_m, 2.0 * given.finest_cell_m) / away
    terrain = sim.terrain(1)
    heights = terrain.heights(d)
    off_m = np.abs(away - sim.world(1).ground(body).datum_m(d) - heights)
    east = np.cross([0.0, 0.0, 1.0], d)
    east /= np.linalg.norm(east, axis=1, keepdims=True)
    left = np.arange(len(d))  # few samples show enough relief for most pixels
    for side in (3, 9, 17):
        east_north = east[left], np.cross(d[left], east[left])
        low, high = _range_m(heights[left], d[left], east_north, reach[left], side, terrain)
        margin = FLOOR * distance[left]
        beyond = off_m[left] > 0.5 * (high - low) + margin
        whole = int((off_m[left] > high - low + margin).sum())
        left = left[beyond]
    return Report(len(d), len(left), whole)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", nargs="+", default=SCENES)
    parser.add_argument("--pixels", type=int, default=10000)
    parser.add_argument("--cells", type=float, nargs="+", default=[1.0])
    asked = parser.parse_args()
    failed = 0
    for name in asked.scenes:
        sim = perilune.open(CONFIGS / f"{name}.yaml", overrides=QUIET)
        sim = sim.with_overrides({"camera.width": 160, "camera.height": 120})
        for cells in asked.cells:
            key = f"bodies.{sim.config.root}.terrain.cells_per_pixel"
            found = look(sim.with_overrides({key: cells}), asked.pixels)
            print(
                f"{name}, {cells:g} cells a pixel: {found.pixels} pixels, {found.half} beyond half"
                f" of the cell's relief, {found.whole} beyond it",
                flush=True,
            )
            failed += found.whole > 0 or found.half > 0.03 * found.pixels
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
