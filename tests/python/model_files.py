"""Copies of our small satellite whose materials have extras."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

SATELLITE = Path(__file__).parents[2] / "assets" / "models" / "smallsat.glb"


def changed_glb(path: Path, change: Callable[[dict[str, Any]], None]) -> Path:
    """The satellite with its JSON changed, written to `path`."""
    data = SATELLITE.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    tree = json.loads(data[20 : 20 + length])
    change(tree)
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + data[20 + length :]
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    return path


def under(tree: dict[str, Any], **placing: list[float]) -> None:
    """Puts a node above all roots of a file."""
    scene = tree["scenes"][tree.get("scene", 0)]
    tree["nodes"].append({"name": "above", "children": scene["nodes"], **placing})
    scene["nodes"] = [len(tree["nodes"]) - 1]


def melted_box(path: Path) -> Path:
    """A GLB of a box of side 2 with a vertex a corner: its normals are the means of three faces."""
    corners = [(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
    points = b"".join(struct.pack("<3f", *corner) for corner in corners)
    normals = b"".join(struct.pack("<3f", *(x / 3**0.5 for x in corner)) for corner in corners)
    body = points + normals + b"".join(struct.pack("<3H", *row) for row in triangles)
    vectors = {"componentType": 5126, "count": 8, "type": "VEC3"}
    tree = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "box"}],
        "materials": [{"name": "paint", "pbrMetallicRoughness": {"metallicFactor": 0.0}}],
        "meshes": [
            {
                "primitives": [
                    {"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2, "material": 0}
                ]
            }
        ],
        "accessors": [
            {"bufferView": 0, **vectors, "min": [-1.0] * 3, "max": [1.0] * 3},
            {"bufferView": 1, **vectors},
            {"bufferView": 2, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 96},
            {"buffer": 0, "byteOffset": 96, "byteLength": 96},
            {"buffer": 0, "byteOffset": 192, "byteLength": 72},
        ],
        "buffers": [{"byteLength": len(body)}],
    }
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(body), 0x004E4942) + body
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    return path


def with_graphs(path: Path, **graphs: Any) -> Path:
    """The satellite with graphs in the materials of these names."""

    def change(tree: dict[str, Any]) -> None:
        for material in tree["materials"]:
            if material["name"] in graphs:
                material["extras"] = {"perilune_graph": graphs[material["name"]], "mine": 1}

    return changed_glb(path, change)
