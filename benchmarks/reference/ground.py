"""The ground of a body with terrain as a mesh: a square of even posts about what is in view."""

from __future__ import annotations

from typing import Any

import numpy as np

import perilune
from perilune.base import rotations

from .scene import Array

POSTS = 1025
MARGIN = 1.6
"""Side of the square over twice the farthest distance in view: room for casters of shadows."""
FARTHEST = 0.02
"""Farthest distance that a flat lattice serves, over the body's radius."""


def check(name: str, terrain: Any) -> list[str]:
    """Keys that are not exported."""
    if terrain is None:
        return []
    rays = None if terrain.craters is None else terrain.craters.rays
    given = {"rocks": terrain.rocks, "craters.rays": rays}
    given |= {"albedo": terrain.albedo or None, "roughness": terrain.roughness or None}
    return [f"bodies.{name}.terrain.{key}" for key, value in given.items() if value is not None]


def square(
    sim: perilune.Simulation, frame: int, name: str, place: Array, posts: int = POSTS
) -> tuple[Array, Array, Array, Array]:
    """Points, normals, uv (all zero) and triangles, in body axes. `place`: (4, 4), to the
    axes of the camera. Raises ValueError for a view that reaches the horizon."""
    sample = sim.frame(frame, channels=["position", "instance"])
    seen = sample["instance"] == sim.taxonomy.instances[name]
    pose = sim.world(frame).poses[name][0]
    at = (sample["position"][seen] - pose[:3]) @ rotations.to_matrix(pose[3:])
    eye = -place[:3, :3].T @ place[:3, 3]
    up = eye / np.linalg.norm(eye)
    radius_m = float(np.linalg.norm(at, axis=1).mean())
    reach_m = float(np.linalg.norm(at - radius_m * up, axis=1).max())
    if reach_m > FARTHEST * radius_m:
        raise ValueError(f"bodies.{name}.terrain: not exported: ground {reach_m / 1e3:.4g} km away")
    east = np.cross(up, np.eye(3)[np.abs(up).argmin()])
    east /= np.linalg.norm(east)
    step = np.linspace(-1.0, 1.0, posts) * MARGIN * reach_m / radius_m
    d = up + step[None, :, None] * east + step[:, None, None] * np.cross(up, east)
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    d = d.reshape(-1, 3)
    cell_m = radius_m * (step[1] - step[0])
    radii = np.asarray(
        sim.request(frame)["body_radii"][list(sim.world(frame).config.bodies).index(name)]
    )
    rho = 1.0 / np.linalg.norm(d / radii, axis=1)
    points = d * (rho + sim.terrain(frame, name).heights(d, cell_m))[:, None]
    corner = (np.arange(posts - 1)[:, None] * posts + np.arange(posts - 1)).reshape(-1)
    lower = np.stack([corner, corner + 1, corner + posts + 1], axis=-1)
    upper = np.stack([corner, corner + posts + 1, corner + posts], axis=-1)
    grid = points.reshape(posts, posts, 3)
    normals = np.cross(np.gradient(grid, axis=1), np.gradient(grid, axis=0)).reshape(-1, 3)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    triangles = np.concatenate([lower, upper]).astype(np.uint32)
    return points, normals, np.zeros((len(points), 2)), triangles
