"""Reads the PLY files of a dataset as the BOP toolkit does: old type names, triangles only."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_TYPES = {"float": "<f4", "double": "<f8", "int": "<i4", "uint": "<u4", "uchar": "u1"}
_FACE = np.dtype([("count", "u1"), ("vertex_indices", "<i4", (3,))])
_FACE_PROPERTY = ["list", "uchar", "int", "vertex_indices"]


class PlyError(ValueError):
    """An invalid PLY file."""


@dataclass(frozen=True)
class Mesh:
    """A model in millimetres."""

    points: NDArray[np.float64]  # (V, 3)
    normals: NDArray[np.float64]  # (V, 3)
    faces: NDArray[np.int32]  # (T, 3)

    @cached_property
    def outline(self) -> NDArray[np.float64]:
        """Points with the convex hull of all vertices: without duplicates, and only the two ends of
        points on a line along x."""
        points = self.points[np.lexsort(self.points.T)]  # by z, then y, then x
        new_line = (np.diff(points[:, 1:], axis=0) != 0.0).any(axis=1)
        ends = np.ones((2, len(points)), dtype=bool)
        ends[0, 1:] = ends[1, :-1] = new_line
        return np.asarray(points[ends.any(axis=0)])


def _header(lines: list[list[str]]) -> tuple[int, np.dtype[Any], int]:
    """(vertices, type of a vertex, faces)."""
    if lines[:1] != [["ply"]] or lines[1:2] != [["format", "binary_little_endian", "1.0"]]:
        raise PlyError("is no binary little-endian PLY")
    counts: dict[str, int] = {}
    vertex: list[tuple[str, str]] = []
    element = ""
    for words in lines[2:]:
        if words[0] == "element":
            element = words[1]
            counts[element] = int(words[2])
        elif words[0] == "property" and element == "vertex":
            if words[1] not in _TYPES:
                raise PlyError(f"vertex property {words[-1]} has type {words[1]}")
            vertex.append((words[2], _TYPES[words[1]]))
        elif words[0] == "property" and (element, words[1:]) != ("face", _FACE_PROPERTY):
            raise PlyError(f"has the unknown property {' '.join(words[1:])}")
    names = {name for name, _ in vertex}
    missing = sorted({"x", "y", "z", "nx", "ny", "nz"} - names)
    if missing or set(counts) != {"vertex", "face"}:
        raise PlyError(f"lacks vertices, faces or the vertex properties {', '.join(missing)}")
    return counts["vertex"], np.dtype(vertex), counts["face"]


def read_ply(path: Path) -> Mesh:
    """The mesh of a file; PlyError with its fault."""
    header, mark, body = path.read_bytes().partition(b"end_header\n")
    try:
        if not mark:
            raise PlyError("has no end of its header")
        lines = [line.split() for line in header.decode("ascii").splitlines()]
        vertices, vertex, faces = _header([words for words in lines if words])
    except (ValueError, IndexError) as error:
        raise PlyError(str(error)) from None
    size = vertices * vertex.itemsize + faces * _FACE.itemsize
    if vertices < 0 or faces < 0 or len(body) != size:
        raise PlyError(f"has {len(body)} bytes of data, its header says {size}")
    points = np.frombuffer(body, vertex, vertices)
    triangles = np.frombuffer(body, _FACE, faces, offset=vertices * vertex.itemsize)
    if (triangles["count"] != 3).any():
        raise PlyError("has a face that is no triangle")
    return Mesh(
        np.stack([points[name].astype(np.float64) for name in ("x", "y", "z")], axis=1),
        np.stack([points[name].astype(np.float64) for name in ("nx", "ny", "nz")], axis=1),
        triangles["vertex_indices"],
    )
