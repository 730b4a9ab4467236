"""Points that are seen, beside the heights of the ground: whether they lie on the patches of the
mesh, and how far from the heights that it is made from, beside the relief of its cell.
`script/soak` looks at 10 000 pixels of every scene with terrain."""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from terrain_mesh import Mesh

import perilune
from perilune.base import rotations
from perilune.frame import shutter

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
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
ON_THE_MESH = 2e-5
"""Cells: posts are multiples of 2^-17 of one or two of them (csrc/terrain/ground_tile.h)."""
FLOOR = 1e-7
"""Of the distance: rounding of single precision."""
COARSER, FINER = 1, 5
"""Levels about that of the widest cell that sight allows at a pixel."""


@dataclass(frozen=True)
class Seen:
    """Pixels at random that show ground, in axes of the body."""

    mesh: Mesh
    points: F64
    distance: F64  # from the camera
    coarsest: I64  # level of the mesh


@dataclass(frozen=True)
class Report:
    pixels: int
    beside: int  # not on the mesh
    half: int  # farther from the heights of the mesh's level than half of the cell's relief
    whole: int  # than all of it


def pick(sim: perilune.Simulation, pixels: int) -> Seen:
    """Pixels of frame 1. Cells are at most as wide as the choice of tiles allows: sqrt(2) of a
    pixel over the root of the sine of the elevation (at least 1/4)."""
    body = sim.config.root
    given = sim.config.bodies[body].terrain
    assert given is not None
    sample = sim.frame(1, ["position", "instance", "rock_id"], threads=1)
    seen = (sample["instance"] == sim.taxonomy.instances[body]) & (sample["rock_id"] == 0)
    at = np.random.default_rng(1).permutation(np.flatnonzero(seen))[:pixels]
    pose = shutter.middle(sim.world(1)).poses[body][0]
    axes = rotations.to_matrix(pose[3:])
    points = (sample["position"].reshape(-1, 3)[at].astype(float) - pose[:3]) @ axes
    sight = points - (sim.camera_poses(1)[0, :3] - pose[:3]) @ axes
    distance = np.linalg.norm(sight, axis=1)
    down = -np.sum(sight * points, axis=1) / (distance * np.linalg.norm(points, axis=1))
    width = sim.config.camera.width
    pixel_rad = 2.0 * math.tan(0.5 * math.radians(sim.config.camera.fov_deg)) / width
    cell_m = math.sqrt(2.0) * distance * pixel_rad / np.sqrt(np.clip(down, 0.25, 1.0))
    widest = np.maximum(cell_m / given.cells_per_pixel, given.finest_cell_m)
    mesh = Mesh(sim.terrain(1), sim.world(1).ground(body).radii_m)
    coarsest = np.array([mesh.terrain.level(cell) for cell in widest]) - COARSER
    return Seen(mesh, points, distance, coarsest)


def judge(seen: Seen, levels: int = COARSER + FINER) -> Report:
    """`levels` more than the coarsest are tried."""
    mesh, points = seen.mesh, seen.points
    away = np.linalg.norm(points, axis=1)
    d = points / away[:, None]
    misfit, own, wider = mesh.fit(points, seen.coarsest, levels)
    margin = FLOOR * seen.distance
    cells = np.array([mesh.cell_m(int(level)) for level in own])
    beside = int((misfit * cells > ON_THE_MESH * cells + margin).sum())
    off_m = np.full(len(d), np.inf)
    for level, more in {*zip(own.tolist(), (own + wider).tolist(), strict=True)}:
        of = (own == level) & (own + wider == more)
        height = away[of] - mesh.datum_m(d[of])
        for either in (level, more):  # a cell beside a coarser tile has posts of both
            off_m[of] = np.fmin(off_m[of], np.abs(height - mesh.heights(d[of], either)))
    left = np.arange(len(d))  # few samples show enough relief for most pixels
    for side in (2, 3, 5, 9, 17):
        low, high = mesh.cell_range_m(d[left], own[left], side)
        beyond = off_m[left] > 0.5 * (high - low) + margin[left]
        whole = int((off_m[left] > high - low + margin[left]).sum())
        left = left[beyond]
    return Report(len(d), beside, len(left), whole)


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
            found = judge(pick(sim.with_overrides({key: cells}), asked.pixels))
            print(
                f"{name}, {cells:g} cells a pixel: {found.pixels} pixels, {found.beside} beside the"
                f" mesh, {found.half} beyond half of the cell's relief, {found.whole} beyond it",
                flush=True,
            )
            failed += found.beside > 0 or found.half > 0
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
