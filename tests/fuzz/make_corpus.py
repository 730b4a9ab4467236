"""Makes the seeds of the fuzzers: small valid files that reach every branch of the readers.

Run it to write them anew:  python tests/fuzz/make_corpus.py
"""

from __future__ import annotations

import base64
import json
import struct
import zlib
from io import BytesIO
from pathlib import Path
from typing import Any

import DracoPy
import meshoptimizer
import numpy as np
from PIL import Image

CORPUS = Path(__file__).parent / "corpus"

Json = dict[str, Any]

POSITIONS = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0)
UVS = struct.pack("<8f", 0, 1, 1, 1, 1, 0, 0, 0)
NORMALS = struct.pack("<12f", *(0, 0, 1) * 4)
INDICES = struct.pack("<6H", 0, 1, 2, 0, 2, 3)


def png() -> bytes:
    """Two by two RGB texels."""

    def chunk(kind: bytes, body: bytes) -> bytes:
        crc = zlib.crc32(kind + body)
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", crc)

    rows = b"\0\xff\0\0\0\xff\0" + b"\0\0\0\xff\xff\xff\xff"
    header = struct.pack(">2I5B", 2, 2, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(rows, 9))
        + chunk(b"IEND", b"")
    )


class Buffer:
    """Blocks of one buffer, with their views and accessors."""

    def __init__(self) -> None:
        self.data = b""
        self.views: list[Json] = []
        self.accessors: list[Json] = []

    def view(self, block: bytes, **more: int) -> int:
        self.data += b"\0" * (-len(self.data) % 4)
        self.views.append(
            {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(block), **more}
        )
        self.data += block
        return len(self.views) - 1

    def accessor(self, kind: str, component: int, count: int, **more: Any) -> int:
        self.accessors.append({"type": kind, "componentType": component, "count": count, **more})
        return len(self.accessors) - 1

    def add(self, block: bytes, kind: str, component: int, count: int) -> int:
        return self.accessor(kind, component, count, bufferView=self.view(block))

    def document(self, **more: Any) -> Json:
        return {
            "asset": {"version": "2.0"},
            "buffers": [{"byteLength": len(self.data)}],
            "bufferViews": self.views,
            "accessors": self.accessors,
            **more,
        }


def as_glb(buffer: Buffer, document: Json) -> bytes:
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    data = buffer.data + b"\0" * (-len(buffer.data) % 4)
    chunks = struct.pack("<2I", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<2I", len(data), 0x004E4942) + data
    return struct.pack("<3I", 0x46546C67, 2, 12 + len(chunks)) + chunks


def as_gltf(buffer: Buffer, document: Json) -> bytes:
    uri = "data:application/octet-stream;base64," + base64.b64encode(buffer.data).decode()
    document["buffers"][0]["uri"] = uri
    return json.dumps(document, separators=(",", ":")).encode()


def textured() -> bytes:
    """Every map, a texture transform, normals, tangents to compute, an image in the buffer."""
    b = Buffer()
    attributes = {
        "POSITION": b.add(POSITIONS, "VEC3", 5126, 4),
        "NORMAL": b.add(NORMALS, "VEC3", 5126, 4),
        "TEXCOORD_0": b.add(UVS, "VEC2", 5126, 4),
    }
    indices = b.add(INDICES, "SCALAR", 5123, 6)
    transform = {"offset": [0.1, 0.2], "rotation": 0.3, "scale": [2, 3], "texCoord": 0}
    slot = {"index": 0, "extensions": {"KHR_texture_transform": transform}}
    material = {
        "name": "m",
        "pbrMetallicRoughness": {
            "baseColorFactor": [1, 0.5, 0.2, 1],
            "metallicFactor": 0.5,
            "roughnessFactor": 0.4,
            "baseColorTexture": slot,
            "metallicRoughnessTexture": {"index": 0},
        },
        "normalTexture": {"index": 0, "scale": 0.5},
        "emissiveTexture": {"index": 0},
        "emissiveFactor": [1, 1, 1],
        "alphaMode": "MASK",
        "alphaCutoff": 0.3,
        "doubleSided": True,
        "extensions": {"KHR_materials_unlit": {}},
    }
    primitive = {"attributes": attributes, "indices": indices, "material": 0}
    return as_glb(
        b,
        b.document(
            meshes=[{"primitives": [primitive]}],
            nodes=[
                {"children": [1], "scale": [-1, 2, 1]},
                {"mesh": 0, "rotation": [0, 0, 0.6, 0.8]},
            ],
            scenes=[{"nodes": [0]}],
            scene=0,
            images=[{"bufferView": b.view(png()), "mimeType": "image/png"}],
            samplers=[{"wrapS": 33071, "wrapT": 33648}],
            textures=[{"source": 0, "sampler": 0}],
            materials=[material],
            extensionsUsed=["KHR_texture_transform", "KHR_materials_unlit"],
        ),
    )


def sparse_and_strided() -> bytes:
    """Interleaved vertices, byte indices, sparse values, colours, a fan and a strip."""
    b = Buffer()
    rows = b"".join(
        POSITIONS[12 * i : 12 * i + 12] + bytes([50 * i, 255, 9, 255]) + struct.pack("<2H", i, 9)
        for i in range(4)
    )
    view = b.view(rows, byteStride=20)
    values = b.view(struct.pack("<3f", 0, 2, 0))
    attributes = {
        "POSITION": b.accessor(
            "VEC3",
            5126,
            4,
            bufferView=view,
            sparse={
                "count": 1,
                "indices": {"bufferView": b.view(b"\3"), "componentType": 5121},
                "values": {"bufferView": values},
            },
        ),
        "COLOR_0": b.accessor("VEC4", 5121, 4, bufferView=view, byteOffset=12, normalized=True),
        "TEXCOORD_1": b.accessor("VEC2", 5123, 4, bufferView=view, byteOffset=16, normalized=True),
    }
    order = b.add(bytes([0, 1, 2, 3]), "SCALAR", 5121, 4)
    modes = [{"attributes": attributes, "indices": order, "mode": mode} for mode in (5, 6, 1)]
    return as_gltf(
        b,
        b.document(
            meshes=[{"name": "mesh", "primitives": modes}],
            nodes=[{"mesh": 0, "matrix": [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 5, 6, 7, 1]}],
            extras={"any": [1, {"thing": None}]},
        ),
    )


def quantised() -> bytes:
    """Integer attributes, 32-bit indices, no node."""
    b = Buffer()
    attributes = {
        "POSITION": b.add(struct.pack("<12h", 0, 0, 0, 9, 0, 0, 9, 9, 0, 0, 9, 0), "VEC3", 5122, 4),
        "NORMAL": b.accessor(
            "VEC3",
            5120,
            4,
            bufferView=b.view(bytes([0, 0, 127, 0] * 4), byteStride=4),
            normalized=True,
        ),
    }
    order = b.add(struct.pack("<6I", 0, 1, 2, 0, 2, 3), "SCALAR", 5125, 6)
    return as_glb(
        b,
        b.document(
            meshes=[{"primitives": [{"attributes": attributes, "indices": order}]}],
            extensionsUsed=["KHR_mesh_quantization"],
            extensionsRequired=["KHR_mesh_quantization"],
        ),
    )


def animated() -> bytes:
    """A node below another, turned by steps and moved along a spline."""
    b = Buffer()
    positions = b.add(POSITIONS, "VEC3", 5126, 4)
    times = b.add(struct.pack("<2f", 0, 1), "SCALAR", 5126, 2)
    turns = b.add(struct.pack("<8b", 0, 0, 0, 127, 0, 90, 0, 90), "VEC4", 5120, 2)
    b.accessors[turns]["normalized"] = True
    places = b.add(struct.pack("<18f", *range(18)), "VEC3", 5126, 6)
    target = {"node": 1}
    return as_glb(
        b,
        b.document(
            meshes=[{"primitives": [{"attributes": {"POSITION": positions}, "mode": 5}]}],
            nodes=[{"children": [1], "scale": [1, -2, 1]}, {"mesh": 0, "name": "flag"}],
            animations=[
                {
                    "name": "wave",
                    "channels": [
                        {"sampler": 0, "target": {**target, "path": "rotation"}},
                        {"sampler": 1, "target": {**target, "path": "translation"}},
                    ],
                    "samplers": [
                        {"input": times, "output": turns, "interpolation": "STEP"},
                        {"input": times, "output": places, "interpolation": "CUBICSPLINE"},
                    ],
                }
            ],
        ),
    )


def webp(lossless: bool) -> bytes:
    """The square with a WebP image that has alpha."""
    b = Buffer()
    attributes = {
        "POSITION": b.add(POSITIONS, "VEC3", 5126, 4),
        "TEXCOORD_0": b.add(UVS, "VEC2", 5126, 4),
    }
    texels = np.arange(9 * 7 * 4, dtype=np.uint8).reshape(7, 9, 4)
    file = BytesIO()
    Image.fromarray(texels, "RGBA").save(file, "WEBP", lossless=lossless, quality=60)
    image = b.view(file.getvalue())
    return as_glb(
        b,
        b.document(
            meshes=[{"primitives": [{"attributes": attributes, "material": 0, "mode": 6}]}],
            images=[{"bufferView": image, "mimeType": "image/webp"}],
            textures=[{"extensions": {"EXT_texture_webp": {"source": 0}}}],
            materials=[{"emissiveTexture": {"index": 0}, "emissiveFactor": [1, 1, 1]}],
            extensionsUsed=["EXT_texture_webp"],
            extensionsRequired=["EXT_texture_webp"],
        ),
    )


GRID = 4  # vertices along a side of the grid below
GRID_POINTS = [(x, y, x * y % 3) for y in range(GRID) for x in range(GRID)]
GRID_CORNERS = [
    c
    for y in range(GRID - 1)
    for x in range(GRID - 1)
    for a in [GRID * y + x]
    for c in (a, a + 1, a + 1 + GRID, a, a + 1 + GRID, a + GRID)
]


def draco(level: int) -> bytes:
    """A bumpy grid with normals and texture coordinates; level 0 is the sequential method."""
    points = np.array(GRID_POINTS, np.float32)
    data = DracoPy.encode(
        points,
        np.array(GRID_CORNERS).reshape(-1, 3),
        quantization_bits=8,
        compression_level=level,
        tex_coord=points[:, :2].astype(float) / (GRID - 1),
        tex_coord_quantization_bits=8,
        normals=np.tile([0.0, 0.0, 1.0], (len(points), 1)),
        normal_quantization_bits=8,
    )
    kinds = {0: "POSITION", 1: "NORMAL", 3: "TEXCOORD_0"}  # GeometryAttribute::Type
    ids = {kinds[a["attribute_type"]]: a["unique_id"] for a in DracoPy.decode(data).attributes}
    b = Buffer()
    view = b.view(data)
    count = len(points)
    attributes = {
        name: b.accessor("VEC2" if name == "TEXCOORD_0" else "VEC3", 5126, count) for name in ids
    }
    indices = b.accessor("SCALAR", 5123, len(GRID_CORNERS))
    extension = {"KHR_draco_mesh_compression": {"bufferView": view, "attributes": ids}}
    primitive = {"attributes": attributes, "indices": indices, "extensions": extension}
    return as_glb(
        b,
        b.document(
            meshes=[{"primitives": [primitive]}],
            nodes=[{"mesh": 0}],
            extensionsUsed=["KHR_draco_mesh_compression"],
            extensionsRequired=["KHR_draco_mesh_compression"],
        ),
    )


def meshopt(triangles: bool) -> bytes:
    """The same grid as exponents, its normals as an octahedron, its corners in either mode."""
    meshoptimizer.encode_vertex_version(0)  # the extension's
    b = Buffer()
    fallback = 0

    def view(data: bytes, count: int, stride: int, mode: str, filtering: str) -> int:
        nonlocal fallback
        at = b.view(data)
        extension = {**b.views[at], "byteStride": stride, "count": count, "mode": mode}
        extension["filter"] = filtering
        b.views[at] = {
            "buffer": 1,
            "byteOffset": fallback,
            "byteLength": count * stride,
            "extensions": {"EXT_meshopt_compression": extension},
        }
        if mode == "ATTRIBUTES":
            b.views[at]["byteStride"] = stride
        fallback += count * stride
        return at

    points = np.array(GRID_POINTS, np.int64)
    count = len(points)
    exponent = -2
    words = ((exponent & 0xFF) << 24 | (points * 4 & 0xFFFFFF)).astype(np.uint32)
    normals = np.tile(np.array([0, 0, 127, 0], np.int8), (count, 1)).view(np.uint8)
    corners = np.array(GRID_CORNERS, np.uint32)
    encode = meshoptimizer.encode_index_buffer if triangles else meshoptimizer.encode_index_sequence
    mode = "TRIANGLES" if triangles else "INDICES"
    attributes = {
        "POSITION": b.accessor(
            "VEC3",
            5126,
            count,
            bufferView=view(
                meshoptimizer.encode_vertex_buffer(words), count, 12, "ATTRIBUTES", "EXPONENTIAL"
            ),
        ),
        "NORMAL": b.accessor(
            "VEC3",
            5120,
            count,
            normalized=True,
            bufferView=view(
                meshoptimizer.encode_vertex_buffer(normals), count, 4, "ATTRIBUTES", "OCTAHEDRAL"
            ),
        ),
    }
    at = view(encode(corners, len(corners), count), len(corners), 2, mode, "NONE")
    indices = b.accessor("SCALAR", 5123, len(corners), bufferView=at)
    extensions = ["EXT_meshopt_compression", "KHR_mesh_quantization"]
    document = b.document(
        meshes=[{"primitives": [{"attributes": attributes, "indices": indices}]}],
        nodes=[{"mesh": 0}],
        extensionsUsed=extensions,
        extensionsRequired=extensions,
    )
    document["buffers"].append(
        {"byteLength": fallback, "extensions": {"EXT_meshopt_compression": {"fallback": True}}}
    )
    return as_glb(b, document)


SEEDS = {
    "gltf/textured.glb": textured,
    "gltf/sparse.gltf": sparse_and_strided,
    "gltf/quantised.glb": quantised,
    "gltf/webp_lossless.glb": lambda: webp(True),
    "gltf/webp_lossy.glb": lambda: webp(False),
    "gltf/draco_sequential.glb": lambda: draco(0),
    "gltf/draco_edgebreaker.glb": lambda: draco(1),
    "gltf/draco_valence.glb": lambda: draco(10),
    "gltf/meshopt_triangles.glb": lambda: meshopt(True),
    "gltf/meshopt_indices.glb": lambda: meshopt(False),
    "gltf/animated.glb": animated,
}


def main() -> None:
    for name, make in SEEDS.items():
        path = CORPUS / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(make())


if __name__ == "__main__":
    main()
