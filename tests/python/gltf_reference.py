"""A second, independent reading of glTF geometry with NumPy, for valid files only.

Draco data are decoded by DracoPy, meshopt data by the package meshoptimizer, whose filters are
replaced by the formulas of EXT_meshopt_compression, section "Filters".
"""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import unquote

import DracoPy
import meshoptimizer
import numpy as np
from numpy.typing import NDArray

COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}

Array = NDArray[Any]


class Geometry(NamedTuple):
    """All triangles of the default scene, flattened, degenerate ones included."""

    corners: Array  # (T, 3, 3), double, z-up
    parts: int  # primitives of triangles that are placed

    @property
    def doubled_areas(self) -> Array:
        a, b, c = np.moveaxis(self.corners.astype(np.float32).astype(np.float64), 1, 0)
        return np.linalg.norm(np.cross(b - a, c - a), axis=1)


class File:
    """A file with its buffers."""

    def __init__(self, path: Path) -> None:
        data = path.read_bytes()
        self.chunk = b""
        if data[:4] == b"glTF":
            length = struct.unpack_from("<I", data, 12)[0]
            self.json = json.loads(data[20 : 20 + length])
            self.chunk = data[28 + length :]
        else:
            self.json = json.loads(data)
        self.buffers = [self._buffer(path, buffer) for buffer in self.json.get("buffers", [])]

    def _buffer(self, path: Path, buffer: dict[str, Any]) -> bytes:
        if "EXT_meshopt_compression" in buffer.get("extensions", {}):
            return b""
        uri = buffer.get("uri")
        if uri is None:
            return self.chunk
        if uri.startswith("data:"):
            return base64.b64decode(uri.partition(",")[2])
        return (path.parent / unquote(uri)).read_bytes()

    def view(self, index: int) -> bytes:
        v = self.json["bufferViews"][index]
        if compressed := v.get("extensions", {}).get("EXT_meshopt_compression"):
            return decode_meshopt(self._range(compressed), compressed).tobytes()
        return self._range(v)

    def _range(self, v: dict[str, Any]) -> bytes:
        start = v.get("byteOffset", 0)
        return self.buffers[v["buffer"]][start : start + v["byteLength"]]

    def _rows(self, view: int, offset: int, dtype: str, width: int, count: int) -> Array:
        itemsize = np.dtype(dtype).itemsize
        stride = self.json["bufferViews"][view].get("byteStride", itemsize * width)
        return np.ndarray((count, width), dtype, self.view(view), offset, (stride, itemsize))

    def accessor(self, index: int) -> Array:
        a = self.json["accessors"][index]
        dtype, width, count = COMPONENTS[a["componentType"]], WIDTHS[a["type"]], a["count"]
        out = np.zeros((count, width), dtype)
        if "bufferView" in a:
            out[:] = self._rows(a["bufferView"], a.get("byteOffset", 0), dtype, width, count)
        if sparse := a.get("sparse"):
            n, at, values = sparse["count"], sparse["indices"], sparse["values"]
            kind = COMPONENTS[at["componentType"]]
            order = self._rows(at["bufferView"], at.get("byteOffset", 0), kind, 1, n)[:, 0]
            rows = self._rows(values["bufferView"], values.get("byteOffset", 0), dtype, width, n)
            for i, row in zip(order, rows, strict=True):
                out[i] = row
        if a.get("normalized"):
            return np.maximum(out / np.iinfo(dtype).max, -1.0)
        return out


def decode_meshopt(data: bytes, extension: dict[str, Any]) -> Array:
    """The content of a view: (count, stride) bytes."""
    count, stride = extension["count"], extension["byteStride"]
    if extension["mode"] == "TRIANGLES":
        return meshoptimizer.decode_index_buffer(count, stride, data).view(np.uint8)
    if extension["mode"] == "INDICES":
        return meshoptimizer.decode_index_sequence(count, stride, data).view(np.uint8)
    rows = meshoptimizer.decode_vertex_buffer(count, stride, data, np.dtype((np.void, stride)))
    raw = rows.view(np.uint8).reshape(count, stride)
    return meshopt_filter(raw, extension.get("filter", "NONE"))


def meshopt_filter(raw: Array, name: str) -> Array:
    """(count, stride) bytes to as many."""
    if name == "OCTAHEDRAL":
        kind = np.int8 if raw.shape[1] == 4 else np.int16
        rows = raw.view(kind)
        x, y = (rows[:, :2] / rows[:, 2:3].astype(float)).T
        z = 1 - abs(x) - abs(y)
        t = np.maximum(-z, 0)  # folds the lower hemisphere back
        out = np.stack([x - np.copysign(t, x), y - np.copysign(t, y), z], axis=1)
        out = out / np.linalg.norm(out, axis=1, keepdims=True) * np.iinfo(kind).max
        return np.column_stack([np.rint(out).astype(kind), rows[:, 3]]).view(np.uint8)
    if name == "QUATERNION":
        rows = raw.view(np.int16)
        v = rows[:, :3] / (rows[:, 3:] | 3).astype(float) / np.sqrt(2)
        w = np.sqrt(np.maximum(0, 1 - (v * v).sum(axis=1)))
        out = np.empty_like(rows)
        for k, part in enumerate([w, *v.T]):
            at = (rows[:, 3] + k) % 4
            out[np.arange(len(rows)), at] = np.rint(part * 32767)
        return out.view(np.uint8)
    if name == "EXPONENTIAL":
        words = raw.view(np.int32)
        return np.ldexp(((words << 8) >> 8).astype(np.float32), words >> 24).view(np.uint8)
    return raw


def node_matrix(node: dict[str, Any]) -> Array:
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, :3] *= np.array(node.get("scale", (1, 1, 1)))
    matrix[:3, 3] = node.get("translation", (0, 0, 0))
    return matrix


def triangles(order: Array, mode: int) -> Array:
    """(T, 3) vertex numbers, whatever their winding."""
    if mode == 4:
        return order[: len(order) // 3 * 3].reshape(-1, 3)
    if len(order) < 3:
        return np.empty((0, 3), int)
    first = order[:-2] if mode == 5 else np.broadcast_to(order[0], len(order) - 2)
    return np.stack([first, order[1:-1], order[2:]], axis=1)


def placed_meshes(document: dict[str, Any]) -> list[tuple[int, Array]]:
    """(mesh, matrix) of each node of the default scene; without any node, of each mesh once."""
    nodes = document.get("nodes", [])
    if not nodes:
        return [(i, np.eye(4)) for i in range(len(document.get("meshes", [])))]
    if scenes := document.get("scenes"):
        roots = scenes[document.get("scene", 0)].get("nodes", [])
    else:
        children = {c for node in nodes for c in node.get("children", [])}
        roots = [i for i in range(len(nodes)) if i not in children]
    out = []
    stack = [(i, np.eye(4)) for i in roots]
    while stack:
        index, parent = stack.pop()
        matrix = parent @ node_matrix(nodes[index])
        if "mesh" in nodes[index]:
            out.append((nodes[index]["mesh"], matrix))
        stack += [(child, matrix) for child in nodes[index].get("children", [])]
    return out


def read(path: Path) -> Geometry:
    file = File(path)
    corners = [np.empty((0, 3, 3))]
    for mesh, matrix in placed_meshes(file.json):
        for primitive in file.json["meshes"][mesh]["primitives"]:
            attributes, mode = primitive.get("attributes", {}), primitive.get("mode", 4)
            if mode < 4 or "POSITION" not in attributes:
                continue
            draco = primitive.get("extensions", {}).get("KHR_draco_mesh_compression")
            if draco:
                decoded = DracoPy.decode(file.view(draco["bufferView"]))
                p, order, mode = decoded.points.astype(float), decoded.faces.reshape(-1), 4
            else:
                p = file.accessor(attributes["POSITION"]).astype(float)
                order = np.arange(len(p))
                if "indices" in primitive:
                    order = file.accessor(primitive["indices"])[:, 0].astype(int)
            p = p @ matrix[:3, :3].T + matrix[:3, 3]
            p = np.stack([p[:, 0], -p[:, 2], p[:, 1]], axis=1)
            corners.append(p[triangles(order, mode)])
    return Geometry(np.concatenate(corners), len(corners) - 1)
