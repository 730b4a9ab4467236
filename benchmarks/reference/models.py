"""Models that the comparison makes itself: crumpled foil, and finer ground for a measured body."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

from .scene import Array


def metal(color: tuple[float, float, float], roughness: float) -> dict[str, Any]:
    """A material of glTF."""
    factor = {"baseColorFactor": [*color, 1.0], "metallicFactor": 1.0, "roughnessFactor": roughness}
    return {"pbrMetallicRoughness": factor, "doubleSided": True}


def flat_normals(corners: Array) -> Array:
    """(T, 3, 3) for triangles (T, 3, 3)."""
    n = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.repeat((n / np.linalg.norm(n, axis=1, keepdims=True))[:, None], 3, axis=1)


def write_glb(path: Path, pieces: list[tuple[Array, Array | None, dict[str, Any]]]) -> Path:
    """Pieces of triangles (T, 3, 3) with z upwards, normals (T, 3, 3) (None: flat), material."""
    document: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": []}],
        "materials": [],
        "accessors": [],
        "bufferViews": [],
    }
    blob = b""
    for index, (corners, normals, material) in enumerate(pieces):
        arrays = (corners, flat_normals(corners) if normals is None else normals)
        for values in arrays:
            v = values.reshape(-1, 3)
            turned = np.stack([v[:, 0], v[:, 2], -v[:, 1]], -1).astype("<f4")
            view = {"buffer": 0, "byteOffset": len(blob), "byteLength": turned.nbytes}
            document["bufferViews"].append(view)
            document["accessors"].append(
                {
                    "bufferView": len(document["bufferViews"]) - 1,
                    "componentType": 5126,
                    "count": len(turned),
                    "type": "VEC3",
                    "min": turned.min(0).tolist(),
                    "max": turned.max(0).tolist(),
                }
            )
            blob += turned.tobytes()
        attributes = {"POSITION": 2 * index, "NORMAL": 2 * index + 1}
        document["meshes"][0]["primitives"].append({"attributes": attributes, "material": index})
        document["materials"].append({"name": f"piece_{index}", **material})
    document["buffers"] = [{"byteLength": len(blob)}]
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(blob))
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(
        head
        + struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", len(blob), b"BIN\0")
        + blob
    )
    return path


def rectangle(center: Any, a: Any, b: Any) -> Array:
    """Two triangles, seen from a x b."""
    c, a, b = (np.asarray(v, dtype=float) for v in (center, a, b))
    p = [c - a - b, c + a - b, c + a + b, c - a + b]
    return np.array([[p[0], p[1], p[2]], [p[0], p[2], p[3]]])


def crumpled(side: float, height: float, count: int = 48, seed: int = 3) -> Array:
    """A sheet folded along random lines: flat facets with sharp creases."""
    rng = np.random.default_rng(seed)
    grid = np.linspace(-side, side, count + 1)
    x, y = np.meshgrid(grid, grid)
    inner = (np.abs(x) < side) & (np.abs(y) < side)
    shake = 0.35 * 2.0 * side / count
    x = x + inner * rng.uniform(-shake, shake, x.shape)
    y = y + inner * rng.uniform(-shake, shake, y.shape)
    z = np.zeros_like(x)
    for k in range(14):
        turn, offset = rng.uniform(0.0, np.pi), rng.uniform(-side, side)
        along = np.abs(x * np.cos(turn) + y * np.sin(turn) - offset)
        z += rng.choice([-1.0, 1.0]) * height * np.minimum(along, 0.3 * side) / (1.0 + 0.3 * k)
    p = np.stack([x, y, z - z.mean()], -1)
    a, b, c, d = p[:-1, :-1], p[:-1, 1:], p[1:, 1:], p[1:, :-1]
    return np.concatenate([np.stack([a, b, c], -2), np.stack([a, c, d], -2)]).reshape(-1, 3, 3)


def halved(vertices: Array, triangles: Array) -> tuple[Array, Array]:
    """Each triangle as four."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, which = np.unique(edges, axis=0, return_inverse=True)
    middles = vertices[edges].mean(axis=1)
    ab, bc, ca = (which.reshape(-1, 3) + len(vertices)).T
    a, b, c = triangles.T
    faces = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    return np.concatenate([vertices, middles]), np.concatenate([np.stack(f, -1) for f in faces])


def rubble(points: Array, amplitude: float) -> Array:
    """Points moved along their radius by waves of falling length: ground with steep sides."""
    rng = np.random.default_rng(16)
    radius = np.linalg.norm(points, axis=1, keepdims=True)
    unit, height = points / radius, np.zeros(len(points))
    for octave in range(6):
        for _ in range(24):
            wave = rng.normal(size=3) * 6.0 * 1.7**octave
            height += 1.7**-octave * np.sin(unit @ wave + rng.uniform(0.0, 6.3)) / 5.0
    return np.asarray(points * (1.0 + amplitude * height[:, np.newaxis]))


def write_obj(path: Path, vertices: Array, triangles: Array) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w") as file:
        np.savetxt(file, vertices, fmt="v %.7g %.7g %.7g")
        np.savetxt(file, triangles + 1, fmt="f %d %d %d")
    return path
