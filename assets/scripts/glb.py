"""Writes glTF 2.0 binary files (.glb) from meshes made in NumPy; deterministic byte for byte.

Authors work in metres with z up; the file is y-up as glTF asks: (x, y, z) -> (x, z, -y). Readers
that turn y-up files to z-up, as Perilune does, get the authors' coordinates back.
"""

from __future__ import annotations

import json
import struct
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from shapes import Mesh

# Coordinates are rounded before they become float32, so that the last bit of a sine, which differs
# between builds of NumPy, does not reach the file.
POSITION_DECIMALS = 5  # 0.01 mm
NORMAL_DECIMALS = 4
UV_DECIMALS = 5

ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
UINT16, UINT32, FLOAT32 = 5123, 5125, 5126


@dataclass(frozen=True)
class Material:
    """A glTF metallic-roughness material; colours are linear."""

    name: str
    color: tuple[float, float, float]
    metallic: float
    roughness: float
    texture: str | None = None  # name of an image of the file, sRGB, multiplied by `color`
    emissive: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass
class Node:
    """A named node: a mesh (by name) or a group, placed in its parent; z-up."""

    name: str
    mesh: str | None = None
    translation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: NDArray[np.float64] | None = None  # 3x3, child to parent
    children: list[Node] = field(default_factory=list)

    def add(self, node: Node) -> Node:
        self.children.append(node)
        return node


@dataclass
class Document:
    """What goes into one file. Meshes map material names to triangles."""

    name: str
    materials: Sequence[Material]
    meshes: dict[str, dict[str, Mesh]]
    root: Node
    images: Mapping[str, bytes] = field(default_factory=dict)  # name -> PNG
    extras: Mapping[str, Any] = field(default_factory=dict)

    def to_bytes(self) -> bytes:
        return _Writer(self).finish()

    def save(self, path: Path) -> None:
        path.write_bytes(self.to_bytes())


def to_y_up(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """(x, y, z) with z up -> (x, z, -y) with y up."""
    return np.stack([vectors[..., 0], vectors[..., 2], -vectors[..., 1]], axis=-1)


def quaternion(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit quaternion (x, y, z, w) of a rotation matrix, w >= 0."""
    m = np.asarray(matrix, dtype=float)
    # Bar-Itzhack 2000: the quaternion is the dominant eigenvector of this symmetric matrix.
    k = np.array(
        [
            [m[0, 0] - m[1, 1] - m[2, 2], 0, 0, 0],
            [m[1, 0] + m[0, 1], m[1, 1] - m[0, 0] - m[2, 2], 0, 0],
            [m[2, 0] + m[0, 2], m[2, 1] + m[1, 2], m[2, 2] - m[0, 0] - m[1, 1], 0],
            [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], np.trace(m)],
        ]
    )
    _, vectors = np.linalg.eigh(k / 3.0, UPLO="L")
    q = np.round(vectors[:, -1], 9)
    # Half turns have w = 0: the sign is then fixed by the largest component.
    lead = q[3] if abs(q[3]) > 1e-6 else q[np.argmax(np.abs(q))]
    q = q if lead > 0 else -q
    return q / np.linalg.norm(q) + 0.0  # + 0.0 turns -0 into 0


class _Writer:
    """Collects buffer views and accessors, then packs the two chunks of the file."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.binary = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.nodes: list[dict[str, Any]] = []
        self.material_index = {m.name: i for i, m in enumerate(document.materials)}
        self.mesh_index = {name: i for i, name in enumerate(document.meshes)}

    def finish(self) -> bytes:
        document = self.document
        meshes = [self.mesh(name, parts) for name, parts in document.meshes.items()]
        root = self.node(document.root)
        images = [
            {"name": name, "mimeType": "image/png", "bufferView": self.view(data, None)}
            for name, data in document.images.items()
        ]
        content: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "perilune assets/scripts"},
            "scene": 0,
            "scenes": [{"name": document.name, "nodes": [root]}],
            "nodes": self.nodes,
            "meshes": meshes,
            "materials": [self.material(m) for m in document.materials],
            "accessors": self.accessors,
        }
        if images:
            content["images"] = images
            content["samplers"] = [{"magFilter": 9729, "minFilter": 9987}]
            content["textures"] = [{"sampler": 0, "source": i} for i in range(len(images))]
        if document.extras:
            content["scenes"][0]["extras"] = dict(document.extras)
        content["bufferViews"] = self.views
        content["buffers"] = [{"byteLength": len(self.binary)}]
        return _pack(content, bytes(self.binary))

    def view(self, data: bytes, target: int | None) -> int:
        self.binary.extend(b"\0" * (-len(self.binary) % 4))
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)}
        if target is not None:
            view["target"] = target
        self.binary.extend(data)
        self.views.append(view)
        return len(self.views) - 1

    def floats(self, values: NDArray[np.float64], decimals: int, bounds: bool = False) -> int:
        # + 0.0 turns -0 into 0.
        data = (np.round(values, decimals) + 0.0).astype("<f4")
        accessor = {
            "bufferView": self.view(data.tobytes(), ARRAY_BUFFER),
            "componentType": FLOAT32,
            "count": len(data),
            "type": {2: "VEC2", 3: "VEC3"}[data.shape[1]],
        }
        if bounds:
            accessor["min"] = [float(v) for v in data.min(axis=0)]
            accessor["max"] = [float(v) for v in data.max(axis=0)]
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def mesh(self, name: str, parts: Mapping[str, Mesh]) -> dict[str, Any]:
        return {"name": name, "primitives": [self.primitive(m, p) for m, p in parts.items()]}

    def primitive(self, material: str, mesh: Mesh) -> dict[str, Any]:
        attributes = {
            "POSITION": self.floats(to_y_up(mesh.positions), POSITION_DECIMALS, bounds=True),
            "NORMAL": self.floats(to_y_up(mesh.normals), NORMAL_DECIMALS),
        }
        index = self.material_index[material]
        if self.document.materials[index].texture:  # others have no use for coordinates
            attributes["TEXCOORD_0"] = self.floats(mesh.uvs, UV_DECIMALS)
        small = len(mesh.positions) <= 0xFFFF
        indices = mesh.triangles.astype("<u2" if small else "<u4").tobytes()
        self.accessors.append(
            {
                "bufferView": self.view(indices, ELEMENT_ARRAY_BUFFER),
                "componentType": UINT16 if small else UINT32,
                "count": mesh.triangles.size,
                "type": "SCALAR",
            }
        )
        return {
            "attributes": attributes,
            "indices": len(self.accessors) - 1,
            "material": index,
        }

    def node(self, node: Node) -> int:
        entry: dict[str, Any] = {"name": node.name}
        self.nodes.append(entry)
        index = len(self.nodes) - 1
        if node.mesh is not None:
            entry["mesh"] = self.mesh_index[node.mesh]
        if any(node.translation):
            moved = to_y_up(np.array(node.translation, dtype=float))
            entry["translation"] = [float(v) for v in np.round(moved, POSITION_DECIMALS) + 0.0]
        if node.rotation is not None:
            q = quaternion(node.rotation)
            turned = np.append(to_y_up(q[:3]), q[3])
            entry["rotation"] = [float(v) for v in np.round(turned, 8) + 0.0]
        if node.children:
            entry["children"] = [self.node(child) for child in node.children]
        return index

    def material(self, material: Material) -> dict[str, Any]:
        surface: dict[str, Any] = {
            "baseColorFactor": [*material.color, 1.0],
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        }
        if material.texture:
            surface["baseColorTexture"] = {
                "index": list(self.document.images).index(material.texture)
            }
        entry: dict[str, Any] = {"name": material.name, "pbrMetallicRoughness": surface}
        if any(material.emissive):
            entry["emissiveFactor"] = list(material.emissive)
        return entry


def _pack(content: dict[str, Any], binary: bytes) -> bytes:
    text = json.dumps(content, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    total = 12 + 8 + len(text) + 8 + len(binary)
    return (
        struct.pack("<4sII", b"glTF", 2, total)
        + struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", len(binary), b"BIN\0")
        + binary
    )


def indexed_png(pixels: NDArray[np.uint8], palette: NDArray[np.uint8]) -> bytes:
    """A palette PNG of (H, W) indices and (n, 3) sRGB colours.

    The data is stored, not compressed: a compressor's output differs between versions of zlib.
    """
    height, width = pixels.shape
    rows = np.concatenate([np.zeros((height, 1), np.uint8), pixels], axis=1).tobytes()
    blocks = [rows[i : i + 0xFFFF] for i in range(0, len(rows), 0xFFFF)]
    stored = b"".join(
        struct.pack("<BHH", i == len(blocks) - 1, len(block), len(block) ^ 0xFFFF) + block
        for i, block in enumerate(blocks)
    )
    data = b"\x78\x01" + stored + struct.pack(">I", zlib.adler32(rows))
    header = struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)
    chunks = [(b"IHDR", header), (b"PLTE", palette.astype(np.uint8).tobytes())]
    chunks += [(b"IDAT", data), (b"IEND", b"")]
    body = b"".join(
        struct.pack(">I", len(d)) + tag + d + struct.pack(">I", zlib.crc32(tag + d))
        for tag, d in chunks
    )
    return b"\x89PNG\r\n\x1a\n" + body
