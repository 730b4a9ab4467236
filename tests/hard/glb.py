"""Small .glb files made by the tests: triangles with float positions, one material."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_FLOAT, _UINT32 = 5126, 5125


def write_glb(
    path: Path,
    positions: NDArray[np.float32],
    indices: NDArray[np.uint32],
    attributes: Mapping[str, NDArray[np.float32]] | None = None,
    nodes: list[dict[str, Any]] | None = None,
) -> Path:
    """Positions in model axes (z up), turned to the file's y up; indices (T, 3). Further attributes
    by their glTF name, (V, 2) or (V, 4), as they are. Nodes: the root first; by default one, with
    mesh 0."""
    points = np.asarray(positions, dtype=np.float32)
    # The reader turns (x, y, z) of a file into (x, -z, y).
    points = np.ascontiguousarray(points[:, [0, 2, 1]] * np.float32([1, 1, -1]))
    index = np.ascontiguousarray(indices, dtype=np.uint32)
    body = points.tobytes() + index.tobytes()
    tree: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": nodes or [{"mesh": 0, "name": "shape"}],
        "materials": [{"name": "plain", "doubleSided": True}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}
        ],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": _FLOAT,
                "count": len(points),
                "type": "VEC3",
                "min": points.min(axis=0).tolist() if len(points) else [0, 0, 0],
                "max": points.max(axis=0).tolist() if len(points) else [0, 0, 0],
            },
            {
                "bufferView": 1,
                "componentType": _UINT32,
                "count": index.size,
                "type": "SCALAR",
            },
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": points.nbytes},
            {"buffer": 0, "byteOffset": points.nbytes, "byteLength": index.nbytes},
        ],
        "buffers": [{"byteLength": len(body)}],
    }  # fmt: skip
    for name, values in (attributes or {}).items():
        raw = np.ascontiguousarray(values, dtype=np.float32).tobytes()
        tree["meshes"][0]["primitives"][0]["attributes"][name] = len(tree["accessors"])
        tree["accessors"].append(
            {
                "bufferView": len(tree["bufferViews"]),
                "componentType": _FLOAT,
                "count": len(values),
                "type": f"VEC{values.shape[1]}",
            }
        )
        tree["bufferViews"].append({"buffer": 0, "byteOffset": len(body), "byteLength": len(raw)})
        body += raw
    tree["buffers"][0]["byteLength"] = len(body)
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(body), 0x004E4942) + body
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    return path


def cube(half: float) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """A cube about the origin, faces counter-clockwise from outside, corners shared."""
    corners = np.array(
        [[x, y, z] for x in (-half, half) for y in (-half, half) for z in (-half, half)],
        dtype=np.float32,
    )
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    triangles = [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])]
    return corners, np.array(triangles, dtype=np.uint32)
