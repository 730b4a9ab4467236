"""Coincident faces inside one model: the later face is seen at every pixel, however it is cut into
triangles, as it is between objects (test_surfaces_hard.py)."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import perilune
from perilune.document.loader import read_tree

HALF, DECAL = 1.0, 0.6
Mesh = tuple[NDArray[np.float32], NDArray[np.uint32]]


def sheet(cells: int, half: float, tilt: float) -> Mesh:
    """A square of triangles in the plane z = tilt (x + 0.3 y) + 0.1, rounded to float."""
    u = np.linspace(-half, half, cells + 1)
    x, y = (axis.ravel() for axis in np.meshgrid(u, u))
    first = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    corners = [(0, 1, cells + 2), (0, cells + 2, cells + 1)]
    triangles = np.concatenate([first[:, None] + np.array(c) for c in corners])
    points = np.stack([x, y, tilt * (x + 0.3 * y) + 0.1], axis=1)
    return points.astype(np.float32), triangles.astype(np.uint32)


def write(path: Path, meshes: list[Mesh], double_sided: bool) -> Path:
    """A GLB of one mesh with a primitive and a material for each."""
    body, views, accessors, primitives = b"", [], [], []
    for k, mesh in enumerate(meshes):
        for array, kind, component in zip(mesh, ("VEC3", "SCALAR"), (5126, 5125), strict=True):
            views.append({"buffer": 0, "byteOffset": len(body), "byteLength": array.nbytes})
            row = {"bufferView": len(views) - 1, "componentType": component, "type": kind}
            row["count"] = len(array) if kind == "VEC3" else array.size
            if kind == "VEC3":
                row |= {"min": array.min(0).tolist(), "max": array.max(0).tolist()}
            accessors.append(row)
            body += array.tobytes()
        attributes = {"POSITION": 2 * k}
        primitives.append({"attributes": attributes, "indices": 2 * k + 1, "material": k})
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "materials": [{"name": str(k), "doubleSided": double_sided} for k in range(len(meshes))],
        "meshes": [{"primitives": primitives}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(body)}],
    }
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    header = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(body))
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    path.write_bytes(header + chunks + struct.pack("<I4s", len(body), b"BIN\0") + body)
    return path


@pytest.mark.parametrize("double_sided", [False, True])
@pytest.mark.parametrize("tilt", [0.0, 0.37])
@pytest.mark.parametrize("cells", [1, 3, 7])
@pytest.mark.parametrize("frame", [0, 1])
def test_decal(
    repo_dir: Path, tmp_path: Path, frame: int, cells: int, tilt: float, double_sided: bool
) -> None:
    meshes = [sheet(2, HALF, tilt), sheet(cells, DECAL, tilt)]
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    path = write(tmp_path / "decal.glb", meshes, double_sided)
    tree["spacecraft"]["sat"].update(model=str(path), size_m=6.0)
    tree["camera"].update(width=120, height=90)
    tree["camera"]["trajectory"] = {"kind": "orbit_object", "target": "sat", "distance_m": 8}
    sim = perilune.open(tree, base=repo_dir)
    sample = sim.frame(frame, channels=["part", "instance", "object_coords"], threads=2)
    here = sample["instance"] == sample["instance"].max()
    # The reader turns a file's (x, y, z) into (x, -z, y), and centres.
    place = np.abs(sample["object_coords"][here][:, [0, 2]]).max(axis=1)
    edge = DECAL / HALF * 3.0  # 6 m wide in all
    part = sample["part"][here]
    base, decal = np.unique(part)
    assert here.sum() > 500
    assert (part[place < edge - 1e-4] == decal).all()
    assert (part[place > edge + 1e-4] == base).all()
