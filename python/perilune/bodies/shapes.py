"""Shapes of bodies: meshes that replace their ellipsoids, and distances to their surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.bodies import shape_files
from perilune.config.shape import Shape

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class BodyShape:
    """A closed mesh in body axes, metres."""

    model: _core.Model
    warnings: tuple[str, ...] = ()
    """Messages of the file's reader about what it left out or repaired."""
    color: tuple[float, float, float] | None = None
    """Mean linear colour of the file's materials; None without any."""

    @cached_property
    def corners(self) -> F64:
        """(T, 3, 3): corners of each triangle, identical to the core's."""
        mesh = self.model.mesh()
        return np.asarray(mesh["positions"].astype(np.float64)[mesh["indices"]])

    @cached_property
    def radius_m(self) -> float:
        """Radius of a bounding sphere about the body's centre."""
        return float(np.linalg.norm(self.corners, axis=2).max())

    def holds(self, point: F64) -> bool:
        """Whether a point (3,) is inside."""
        low, high = self.model.bounds
        if (point < low).any() or (point > high).any():
            return False
        return float(self.model.winding(point[np.newaxis])[0]) > 0.5

    def distance_m(self, point: F64) -> float:
        """Distance from a point (3,) to the surface, on either side."""
        a, b, c = self.corners.transpose(1, 0, 2)
        inside, height = _above(point, a, b, c)
        near = [_to_segment(point, p, q) for p, q in ((a, b), (b, c), (c, a))]
        return float(np.minimum(np.where(inside, height, np.inf), np.min(near, axis=0)).min())

    def hit_m(self, origin: F64, direction: F64) -> float | None:
        """Distance to the first intersection along a ray of unit direction; None without one."""
        along = -float(origin @ direction)
        if float(origin @ origin) - along**2 > self.radius_m**2:
            return None
        a, b, c = self.corners.transpose(1, 0, 2)
        e1, e2, from_a = b - a, c - a, origin - a
        p = np.cross(direction, e2)
        with np.errstate(divide="ignore", invalid="ignore"):
            # Moeller and Trumbore 1997; edges count to both faces, so that no ray slips through.
            scale = 1.0 / np.einsum("ij,ij->i", e1, p)
            u = scale * np.einsum("ij,ij->i", from_a, p)
            q = np.cross(from_a, e1)
            v = scale * (q @ direction)
            t = scale * np.einsum("ij,ij->i", e2, q)
            met = (u >= -1e-12) & (v >= -1e-12) & (u + v <= 1.0 + 1e-12) & (t >= 0.0)
        return float(t[met].min()) if met.any() else None

    def surface_m(self, direction: F64, origin: F64 | None = None) -> float | None:
        """Distance of the outermost surface along a line from the centre or `origin`; negative if
        it is behind, None if the line misses."""
        start = np.zeros(3) if origin is None else origin
        far = 2.0 * self.radius_m + float(np.linalg.norm(start))
        hit = self.hit_m(start + far * direction, -direction)
        return None if hit is None else far - hit

    def surfaces_m(self, directions: F64) -> F64:
        """Distance (n,) of the outermost surface along unit directions (n, 3) from the centre; 0
        where there is none."""
        return np.array([self.surface_m(direction) or 0.0 for direction in directions])


def _above(point: F64, a: F64, b: F64, c: F64) -> tuple[NDArray[np.bool_], F64]:
    """Whether a point is over each triangle, and how far from its plane."""
    normal = np.cross(b - a, c - a)
    over = [
        np.einsum("ij,ij->i", np.cross(q - p, point - p), normal) >= 0.0
        for p, q in ((a, b), (b, c), (c, a))
    ]
    length = np.linalg.norm(normal, axis=1)
    height = np.abs(np.einsum("ij,ij->i", point - a, normal)) / np.where(length > 0.0, length, 1.0)
    return np.all(over, axis=0) & (length > 0.0), height


def _to_segment(point: F64, p: F64, q: F64) -> F64:
    way = q - p
    square = np.einsum("ij,ij->i", way, way)
    share = np.einsum("ij,ij->i", point - p, way) / np.where(square > 0.0, square, 1.0)
    nearest = p + np.clip(share, 0.0, 1.0)[:, np.newaxis] * way
    return np.asarray(np.linalg.norm(point - nearest, axis=1))


LENGTHS_M = (1e-9, 1e18)
"""Limits of shapes and models, from the core's single precision."""


def load(name: str, given: Shape, path: Path) -> BodyShape:
    """The shape of the body `name`; ValueError that names the key, below the section, and the
    file."""
    try:
        remarks: list[str] = []
        (vertices, triangles), skin = shape_files.read_dressed(path, remarks)
    except ValueError as error:
        raise ValueError(f"file: {error}") from error
    standard_m = 1.0 if path.suffix.lower() in (".gltf", ".glb") else 1e3
    unit_m = np.array(given.metres_per_unit or (standard_m,) * 3)
    if not given.smooth:  # normals are the mean of the faces about a vertex
        vertices = vertices[triangles.ravel()]
        triangles = np.arange(len(vertices)).reshape(-1, 3)
    largest_m = float((unit_m * np.abs(vertices)).max())
    if not LENGTHS_M[0] <= largest_m <= LENGTHS_M[1]:
        raise ValueError(
            f"metres_per_unit: {unit_m.tolist()}: {path} then reaches {largest_m:.3g} m far; "
            f"allowed: {LENGTHS_M[0]:g} to {LENGTHS_M[1]:g} m"
        )
    metres = (unit_m * vertices).astype(np.float32)
    indices = triangles.astype(np.uint32)
    if skin is None:
        return BodyShape(_core.Model.of_mesh(name, metres, indices), tuple(remarks))
    model = _core.Model.of_mesh(name, metres, indices, False, *skin)
    return BodyShape(model, tuple(remarks), skin.color)
