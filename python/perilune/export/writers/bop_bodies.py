"""Models of the bodies that are objects: an ellipsoid, the mesh of a shape, or ground as a mesh
that is finest below the camera of the first frame."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core, orbits
from perilune.base import colors, rotations
from perilune.config.body import Body
from perilune.config.errors import ConfigError
from perilune.drivers import Found
from perilune.export.writers.bop_models import DOUBLE, BopModel, Surfaces, bop_model
from perilune.simulation import Simulation

F64 = NDArray[np.float64]

SURFACE = "surface"
"""Key of models_info.json: what a body is."""
ELLIPSOID, SHAPE, TERRAIN = "ellipsoid", "shape", "terrain"
_ONE_SHAPE = ("kind", "radii_km", "shape", "terrain")
"""Keys of a body that decide its model."""
_SPLITS = 5
"""Times that the triangles of an icosahedron are split in four: 10 242 vertices."""
_SECTORS = 128
"""Vertices of a ring of ground; rings lie as far apart as these vertices."""
_CELLS_BELOW = 50
"""Cells of ground from the point below the camera to one that is seen at 45 degrees."""
_FINEST = 1e-9
"""Least angle of a ring about that point, rad."""


def varies(sim: Simulation, driver: Found) -> bool:
    """Whether a driver changes the model of a body that is an object."""
    path = driver.path
    if path[0] != "bodies" or (len(path) > 1 and not sim.config.bodies[str(path[1])].annotate):
        return False
    return len(path) < 3 or path[2] in _ONE_SHAPE


def body_model(sim: Simulation, name: str) -> BopModel:
    """The model of a body, in BOP's frame. ConfigError if it has none."""
    body, obj_id = sim.config.bodies[name], sim.obj_ids[name]
    radii_m = np.asarray(orbits.radii_m(body), dtype=np.float64)
    if body.shape is not None:
        kind, mesh = SHAPE, sim.shapes[name].model.mesh()
    elif body.terrain is not None:
        kind, mesh = TERRAIN, _ground(sim, name, radii_m)
    else:
        kind, mesh = ELLIPSOID, _ellipsoid(radii_m)
    count = len(mesh["indices"])
    if kind != SHAPE or not sim.config.bodies[name].may_be_dressed:
        mesh = {**mesh, "triangle_color": np.tile(_color(body), (count, 1))}
    surfaces = Surfaces(np.zeros(count, dtype=bool), np.full(count, 2, dtype=np.uint8))
    try:
        model = bop_model(
            obj_id, mesh, surfaces, np.zeros(3), 1.0, dtype=DOUBLE if kind == TERRAIN else None
        )
    except ValueError as error:
        raise ConfigError(f"{sim.document.source}: bodies.{name}: {error}") from error
    return replace(model, counts={SURFACE: kind})


def _color(body: Body) -> NDArray[np.uint8]:
    """Colour of all vertices: that of the albedo, a middle grey under maps and materials."""
    if body.albedo is None and (body.color_map or body.is_replaced or body.has_parameter_maps):
        return np.full(3, 128, dtype=np.uint8)
    grey = float(_core.BODIES[body.kind]["bond_albedo"]) if body.albedo is None else 0.0
    linear = np.full(3, grey) if body.albedo is None else np.array(body.albedo)
    return np.asarray(np.rint(255.0 * colors.srgb(linear.clip(0.0, 1.0))), dtype=np.uint8)


def _mesh(points: F64, faces: NDArray[np.int64], normals: F64) -> dict[str, NDArray[Any]]:
    return {"positions": points, "indices": faces, "normals": normals}


def _ellipsoid(radii_m: F64) -> dict[str, NDArray[Any]]:
    """Vertices on the ellipsoid, those on its axes among them."""
    points, faces = _sphere()
    normals = points / radii_m
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return _mesh(points * radii_m, faces, normals)


def _sphere() -> tuple[F64, NDArray[np.int64]]:
    """A subdivided icosahedron: unit vertices (V, 3), and faces (T, 3) seen from outside."""
    golden = 0.5 * (1.0 + np.sqrt(5.0))
    points = np.array(
        [np.roll((0.0, a, b * golden), k) for k in range(3) for a in (-1, 1) for b in (-1, 1)]
    )
    gaps = np.linalg.norm(points[:, None] - points[None], axis=2)
    near = np.abs(gaps - 2.0) < 1e-9
    every = np.array([(i, j, k) for i in range(12) for j in range(i) for k in range(j)])
    faces = every[near[every[:, 0], every[:, 1]] & near[every[:, 1], every[:, 2]]
                  & near[every[:, 2], every[:, 0]]]  # fmt: skip
    a, b, c = points[faces].transpose(1, 0, 2)
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0.0
    faces[inward] = faces[inward][:, ::-1]
    for _ in range(_SPLITS):
        edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        ends, number = np.unique(edges, axis=0, return_inverse=True)
        mids = len(points) + number.reshape(-1, 3)
        points = np.concatenate([points, points[ends].mean(axis=1)])
        (i, j, k), (p, q, r) = faces.T, mids.T
        faces = np.concatenate(
            [np.stack(corners, axis=1) for corners in ((i, p, r), (p, j, q), (r, q, k), (p, q, r))]
        )
    return points / np.linalg.norm(points, axis=1, keepdims=True), faces


def _below(sim: Simulation, name: str, radii_m: F64) -> tuple[F64, float]:
    """Direction (3,) of the ground below the camera of the first frame, in body axes, and the
    camera's height over it, m."""
    world = sim.world(0)
    pose, camera = world.poses[name][0], sim.camera_poses(0)[0]
    at = rotations.to_matrix(pose[3:]).T @ (camera[:3] - pose[:3])
    distance = float(np.linalg.norm(at))
    up = at / distance
    height = float(sim.terrain(0, name).heights(up[np.newaxis])[0])
    return up, max(distance - 1.0 / float(np.linalg.norm(up / radii_m)) - height, 0.0)


def _ground(sim: Simulation, name: str, radii_m: F64) -> dict[str, NDArray[Any]]:
    """The whole ground of a body, in rings about the point below the camera of the first frame:
    cells are as large as 1/20 of their distance from it."""
    up, height_m = _below(sim, name, radii_m)
    terrain = sim.terrain(0, name)
    step = 2.0 * np.pi / _SECTORS
    least = max(height_m / _CELLS_BELOW / float(radii_m.max()), _FINEST)
    rings = int(np.ceil(np.log(np.pi / least) / np.log1p(step)))
    angles = np.pi * np.exp(-np.arange(rings, 0, -1) * np.log1p(step))
    side = np.eye(3)[np.argmin(np.abs(up))]
    across = np.cross(up, side) / np.linalg.norm(np.cross(up, side))
    turn = step * np.arange(_SECTORS)
    around = np.cos(turn)[:, None] * across + np.sin(turn)[:, None] * np.cross(up, across)
    points = [up[np.newaxis] * _radius(terrain, up[np.newaxis], radii_m, least)]
    for angle in angles:
        directions = np.cos(angle) * up + np.sin(angle) * around
        cell = min(float(angle), 1.0) * step
        points.append(directions * _radius(terrain, directions, radii_m, cell))
    points.append(-up[np.newaxis] * _radius(terrain, -up[np.newaxis], radii_m, step))
    vertices = np.concatenate(points)
    faces = _ring_faces(rings)
    return _mesh(vertices, faces, _normals(vertices, faces))


def _radius(terrain: _core.Terrain, directions: F64, radii_m: F64, cell_rad: float) -> F64:
    """(n, 1) distance of the ground from the centre."""
    ellipsoid_m = 1.0 / np.linalg.norm(directions / radii_m, axis=1)
    heights_m = terrain.heights(np.ascontiguousarray(directions), cell_rad * float(radii_m.max()))
    return np.asarray((ellipsoid_m + heights_m)[:, np.newaxis])


def _ring_faces(rings: int) -> NDArray[np.int64]:
    """Triangles between two poles and rings of _SECTORS vertices, seen from outside."""
    here = np.arange(_SECTORS)
    beside = np.roll(here, -1)
    faces = [np.stack([np.zeros_like(here), 1 + here, 1 + beside], axis=1)]
    for k in range(rings - 1):
        a, b = 1 + k * _SECTORS + here, 1 + k * _SECTORS + beside
        c, d = a + _SECTORS, b + _SECTORS
        faces += [np.stack([a, c, d], axis=1), np.stack([a, d, b], axis=1)]
    last = 1 + (rings - 1) * _SECTORS
    pole = np.full_like(here, last + _SECTORS)
    faces.append(np.stack([last + here, pole, last + beside], axis=1))
    return np.concatenate(faces)


def _normals(points: F64, faces: NDArray[np.int64]) -> F64:
    """Means of the normals of the triangles about each vertex, by their areas."""
    a, b, c = points[faces].transpose(1, 0, 2)
    across = np.cross(b - a, c - a)
    sums = np.zeros_like(points)
    for corner in range(3):
        np.add.at(sums, faces[:, corner], across)
    return np.asarray(sums / np.linalg.norm(sums, axis=1, keepdims=True))
