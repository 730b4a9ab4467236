"""A LiDAR over terrain beside a march through heights in NumPy."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from tests.python.test_terrain_frames import SEED, moon, over

from perilune import _core
from perilune.base import rotations
from perilune.frame import scans

sys.path.insert(0, str(Path(__file__).resolve().parent))
from terrain_mesh import CORNERS, Mesh, locate

CELL_M = 2.0


PLANE, PATCH = 0, 1
"""What rays meet first, and what their ranges are to (csrc/terrain/ground_patch.h)."""


def top_m(mesh: Mesh, points: np.ndarray, level: int, what: int) -> np.ndarray:
    """Height of points above the triangles or the patches of a level, along their radius."""
    away = np.linalg.norm(points, axis=1)
    d = points / away[:, None]
    face, place = locate(d)
    assert (face == face[0]).all()
    cell = np.floor((place + 1.0) * 2.0 ** (level - 1))
    posts = {at: mesh.post(int(face[0]), level, cell + at) for at in CORNERS}
    return away - mesh.meet(d, posts)[what]


def march(mesh: Mesh, origin, directions, level: int, reach_m: float, what: int) -> np.ndarray:
    """Where rays first pass below the surface: steps of a quarter of a cell, then halves."""
    steps = np.arange(0.0, reach_m, 0.25 * CELL_M)
    points = origin + steps[None, :, None] * directions[:, None]
    above = top_m(mesh, points.reshape(-1, 3), level, what).reshape(points.shape[:2]) > 0.0
    assert above[:, 0].all()
    first = (~above).argmax(axis=1)
    assert (first > 0).all()
    low, high = steps[first - 1], steps[first]
    for _ in range(34):
        middle = 0.5 * (low + high)
        over_it = top_m(mesh, origin + middle[:, None] * directions, level, what) > 0.0
        low, high = np.where(over_it, middle, low), np.where(over_it, high, middle)
    return 0.5 * (low + high)


@pytest.mark.parametrize("off_nadir_deg", [20.0, 70.0])
def test_ranges_over_terrain_are_those_of_a_march(off_nadir_deg):
    """Over cells of 2 m with relief that hides some of itself, from above and flatly."""
    pattern = {"kind": "flash", "columns": 12, "rows": 9, "width_deg": 16.0, "height_deg": 12.0}
    ground = {
        "detail": {"seed": SEED, "strength": 4.0},
        "finest_cell_m": CELL_M,
        "cells_per_pixel": 0.0625,
    }
    sim = moon(ground, {"trajectory": over(40.0, off_nadir_deg)},
               lidars={"top": {"pattern": pattern, "range_m": [0.0, 1e6]}})  # fmt: skip
    found = sim.lidar(0)
    pose = sim.world(0).poses["moon"][0]
    axes = rotations.to_matrix(pose[3:])
    mesh = Mesh(sim.terrain(0), sim.world(0).ground("moon").radii_m)
    points = (found["position_m"] - pose[:3]) @ axes
    misfit, levels, _ = mesh.fit(points, np.full(len(points), mesh.terrain.level(8 * CELL_M)), 5)
    assert misfit.max() < 2e-5
    level = int(np.median(levels))
    rays = _core.source_rays(scans.source_of(sim.config.lidars["top"]))[:, 0, 3:6]
    camera = sim.camera_poses(0)[0]
    directions = rays @ rotations.to_matrix(camera[3:]).T @ axes
    origin = (camera[:3] - pose[:3]) @ axes
    own = found["beam"][levels == level]  # others see far ground behind a ridge
    assert len(own) > 0.75 * len(rays)
    ranges = found["range_m"][levels == level]
    reach_m = 1.1 * ranges.max() + CELL_M
    off = [
        march(mesh, origin, directions[own], level, reach_m, what) / ranges - 1.0
        for what in (PLANE, PATCH)
    ]
    assert np.abs(off).min(axis=0).max() < 1e-6
    assert (np.abs(off[PATCH]) < 1e-6).mean() > 0.9  # others are met beside their cell
