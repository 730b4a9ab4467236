"""Random worlds for BOP, and what their labels must be, by code that shares nothing with the core:
convex models as half spaces, bodies as quadrics, a ray a pixel."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull
from tests.hard.glb import write_glb
from tests.python.optics_scenes import tree

import perilune
from perilune.base import rotations
from perilune.export.check.ply import read_ply

F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]
STEPS = 10
"""Frames of a world, each a scene with draws of its own."""
LENSES = (
    None,
    {"model": "brown_conrady", "k1": -0.2, "p1": 0.01, "labels": "undistorted"},
    {"model": "fisheye", "k1": 0.05, "labels": "undistorted"},
)


def _hull(random: np.random.Generator, path: Path) -> Path:
    """A convex model: a box, or a many-cornered one."""
    radii = random.uniform(0.3, 1.5, 3)
    if random.random() < 0.5:
        corners = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, 8).T
    else:
        corners = random.normal(size=(int(random.integers(5, 60)), 3))
        corners /= np.linalg.norm(corners, axis=1, keepdims=True)
    points = (corners * radii + random.uniform(-2.0, 2.0, 3)).astype(np.float32)
    faces = ConvexHull(points.astype(float)).simplices.astype(np.uint32)
    return write_glb(path, points, faces)


def _place(low: tuple[float, ...], high: tuple[float, ...]) -> list[Any]:
    return [{"uniform": [1e-3 * a, 1e-3 * b]} for a, b in zip(low, high, strict=True)]


def world(seed: int, folder: Path) -> perilune.Simulation:
    """1 to 4 spacecraft that hide each other, cut by the image or out of it, in half of the worlds
    with an annotated body among or behind them."""
    random = np.random.default_rng(seed)
    scene = tree((int(random.integers(20, 48)), int(random.integers(16, 40))))
    camera = scene["camera"]
    camera["focal_px"] = float(camera["width"] * random.uniform(0.5, 2.5))
    camera["lens"] = LENSES[seed % len(LENSES)]
    # The anchor is out of view, behind the camera.
    camera["trajectory"] = {
        "kind": "fixed",
        "target": "anchor",
        "position_m": [20.0, 0.0, 0.0],
        "aim_offset_m": [30.0, 0.0, 0.0],
        "aim_jitter_deg": 5.0,
        "roll_deg": {"uniform": [0.0, 360.0]},
    }
    for k in range(int(random.integers(1, 5))):
        scene["spacecraft"][f"craft_{k}"] = {
            "model": str(_hull(random, folder / f"{k}.glb")),
            "metres_per_unit": 1.0,
            "orbit": {"around": "anchor", "position_km": _place((24, -4, -4), (34, 4, 4))},
            "attitude": {"rotation_deg": [{"uniform": [-180.0, 180.0]}] * 3},
        }
    if seed % 2:
        far = random.random() < 0.5
        size = random.uniform(10.0, 60.0) if far else random.uniform(0.3, 1.5)
        places = ((100, -30, -30), (300, 30, 30)) if far else ((24, -3, -3), (34, 3, 3))
        scene["bodies"]["rock"] = {
            "kind": "ellipsoid",
            "radii_km": (1e-3 * size * random.uniform(0.7, 1.3, 3)).tolist(),
            "gm_km3_s2": 1e-20,
            "albedo": 0.2,
            "annotate": True,
            "orbit": {"around": "anchor", "position_km": _place(*places)},
        }
    scene["render"] = {"samples": 1, "max_bounces": 0}
    scene["seed"] = seed
    return perilune.open(scene)


@dataclass(frozen=True)
class Solid:
    """A model, mm, model axes."""

    points: F64
    planes: F64 | None  # (n, 4): inside is n . x + c <= 0
    semi_axes: F64 | None
    diameter: float

    def depth(self, K: F64, R: F64, t: F64, shape: tuple[int, int], margin: int = 0) -> Any:
        """Depths z where rays of pixels enter, inf beside it; and pixels within rounding of its
        outline. margin: image sizes on each side."""
        height, width = shape
        u, v = np.meshgrid(
            np.arange(-margin * width, (margin + 1) * width),
            np.arange(-margin * height, (margin + 1) * height),
        )
        rays = np.stack([u, v, np.ones_like(u)], axis=-1) @ np.linalg.inv(K).T
        d, o = rays @ R, -t @ R  # model axes
        low, high = self._planes(o, d) if self.planes is not None else self._quadric(o, d)
        unsure = np.abs(high - low) < 2e-3 * self.diameter / np.linalg.norm(rays, axis=-1)
        met = (low < high) & (low > 0.0)
        return np.where(met, low, np.inf), unsure

    def _planes(self, o: F64, d: F64) -> tuple[F64, F64]:
        assert self.planes is not None
        along = d @ self.planes[:, :3].T
        away = self.planes[:, :3] @ o + self.planes[:, 3]
        with np.errstate(divide="ignore"):
            z = -away / along
        return (
            np.where(along < 0.0, z, -np.inf).max(axis=-1),
            np.where(along > 0.0, z, np.inf).min(axis=-1),
        )

    def _quadric(self, o: F64, d: F64) -> tuple[F64, F64]:
        p, q = o / self.semi_axes, d / self.semi_axes
        a, b, c = (q**2).sum(-1), q @ p, p @ p - 1.0
        square = b**2 - a * c
        root = np.sign(square) * np.sqrt(np.abs(square))  # below 0 beside it
        return (-b - root) / a, (-b + root) / a


def solids(dataset: Path) -> dict[int, Solid]:
    """Models of a dataset by id."""
    told = json.loads((dataset / "models/models_info.json").read_text())
    found = {}
    for key, info in told.items():
        points = np.asarray(read_ply(dataset / f"models/obj_{int(key):06d}.ply").points, float)
        body = info.get("surface") == "ellipsoid"
        sizes = 0.5 * np.array([info[f"size_{axis}"] for axis in "xyz"])
        planes = None if body else ConvexHull(points).equations
        found[int(key)] = Solid(points, planes, sizes if body else None, info["diameter"])
    return found


def turned(R: F64, angle_rad: float, random: np.random.Generator) -> F64:
    """A rotation turned by an angle about a random axis."""
    axis = random.normal(size=3)
    return np.asarray(rotations.to_matrix(rotations.axis_angle(axis, angle_rad))) @ R
