"""Shape files: OBJ, plates and vertices of the Planetary Data System, glTF."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import files
from perilune.config.errors import nearest

F64 = NDArray[np.float64]
Indices = NDArray[np.int64]
Mesh = tuple[F64, Indices]
"""Vertices (V, 3) in the file's units, and triangles (T, 3) as vertex indices."""

_IGNORED = frozenset(("vt", "vn", "vp", "g", "o", "s", "l", "p", "mg", "mtllib", "usemtl", "lod"))
"""Keywords of OBJ other than vertices and faces."""
_WELD = 1e-7
"""Vertices closer than this fraction of the size are merged: poles are often repeated."""


class Skin(NamedTuple):
    """The model that a shape was made from, for its materials."""

    model: _core.Model
    corners: NDArray[np.uint32]
    """(T, 3): the model's vertices at the corners of the shape's triangles."""
    faces: NDArray[np.uint32]
    """(T,): the model's triangles."""

    @property
    def color(self) -> tuple[float, float, float]:
        """Mean linear base colour by area, for untraced light."""
        mesh = self.model.mesh()
        points = mesh["positions"].astype(np.float64)[mesh["indices"][self.faces]]
        normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
        area = np.linalg.norm(normals, axis=1)
        encoded = mesh["triangle_color"][self.faces] / 255.0
        linear = np.where(
            encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4
        )  # IEC 61966-2-1
        red, green, blue = (area @ linear / area.sum()).tolist()
        return red, green, blue


def read(path: Path, remarks: list[str] | None = None) -> Mesh:
    """A closed mesh, wound outwards, without duplicate vertices; ValueError that names the file.

    remarks: receives messages about what is repaired or left out."""
    return read_dressed(path, remarks)[0]


def read_dressed(path: Path, remarks: list[str] | None = None) -> tuple[Mesh, Skin | None]:
    """The same, with the materials of a glTF file that has any."""
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise ValueError(f"{path}: no kind of shape file{nearest(path.suffix, _READERS)}")
    try:
        told = [] if remarks is None else remarks
        model, vertices, triangles = reader(path, told)
        mesh, kept = _closed(vertices, triangles, told)
        return mesh, None if model is None else _skin(model, kept)
    except ValueError as error:
        text = str(error)
        raise ValueError(text if text.startswith(str(path)) else f"{path}: {text}") from None


def _skin(model: _core.Model, kept: Kept) -> Skin | None:
    """None for a file without materials, for which glTF prescribes bare metal."""
    if model.materials == ("default",):
        return None
    corners = model.mesh()["indices"][kept.faces]
    return Skin(
        model,
        np.ascontiguousarray(corners[:, ::-1] if kept.turned else corners, dtype=np.uint32),
        kept.faces.astype(np.uint32),
    )


def _read_gltf(path: Path, remarks: list[str]) -> tuple[_core.Model | None, F64, Indices]:
    model = _core.Model(str(path))
    remarks += model.warnings
    mesh = model.mesh()
    return model, mesh["positions"].astype(np.float64), mesh["indices"].astype(np.int64)


def _read_text(path: Path, _: list[str]) -> tuple[_core.Model | None, F64, Indices]:
    """Determines the format by the first word: `v x y z` and `f i j k` lines, or a table of
    numbers."""
    text = files.text(path)
    words = text.split(maxsplit=1)
    is_table = bool(words) and _number(words[0]) is not None
    return None, *(_table(text) if is_table else _lines(text))


def _number(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None


def _lines(text: str) -> Mesh:
    """OBJ, or PDS text in the same form. Faces count from 1, or from 0 if one has vertex 0."""
    vertices: list[list[float]] = []
    faces: list[tuple[int, list[int]]] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split("#", 1)[0].split()
        if not words or words[0] in _IGNORED:
            continue
        try:
            if words[0] == "v":
                vertices.append([float(word) for word in words[1:4]])
                if len(words) < 4:
                    raise ValueError
            elif words[0] == "f":
                corners = [int(word.split("/", 1)[0]) for word in words[1:]]
                if len(corners) < 3:
                    raise ValueError
                # Those that count backwards do so from the vertices before their line.
                faces.append((number, [c + len(vertices) + 1 if c < 0 else c for c in corners]))
            else:
                raise ValueError
        except ValueError:
            raise ValueError(
                f"line {number}: neither `v x y z` nor `f i j k ...`: {line.strip()[:40]!r}"
            ) from None
    first = 0 if any(0 in corners for _, corners in faces) else 1
    for number, corners in faces:
        for corner in corners:
            if not first <= corner < first + len(vertices):
                raise ValueError(f"line {number}: there is no vertex {corner} of {len(vertices)}")
    triangles = [
        (corners[0] - first, corners[k] - first, corners[k + 1] - first)
        for _, corners in faces
        for k in range(1, len(corners) - 1)
    ]
    return np.array(vertices).reshape(-1, 3), np.array(triangles, dtype=np.int64).reshape(-1, 3)


def _table(text: str) -> Mesh:
    """The number of vertices, a row `i x y z` for each, the number of plates, a row `i a b c` for
    each."""
    numbers = [_number(word) for word in text.split()]
    if None in numbers:
        raise ValueError(f"number {numbers.index(None) + 1} is none")
    values = np.array(numbers, dtype=np.float64)
    rest: F64 = values
    blocks = []
    for what in ("vertices", "plates"):
        count = int(rest[0]) if rest.size and float(rest[0]).is_integer() else -1
        if count < 0 or rest.size < 1 + 4 * count:
            raise ValueError(f"a count of {what} and a row of four numbers each do not fit")
        rows = rest[1 : 1 + 4 * count].reshape(-1, 4)
        if not np.array_equal(rows[:, 0], np.arange(1, count + 1)):
            raise ValueError(f"rows of {what} are not numbered 1 to {count}")
        blocks.append(rows[:, 1:])
        rest = rest[1 + 4 * count :]
    vertices, plates = blocks
    if rest.size or not np.array_equal(plates, np.round(plates)):
        raise ValueError("plates are whole numbers, and nothing follows them")
    if plates.size and not (plates.min() >= 1 and plates.max() <= len(vertices)):
        raise ValueError(f"plates have vertices 1 to {len(vertices)}")
    return vertices, plates.astype(np.int64) - 1


class Kept(NamedTuple):
    """Which of the file's faces are in a closed mesh, and whether they are reversed."""

    faces: Indices
    turned: bool


def _welded(vertices: F64, triangles: Indices, size: float) -> tuple[F64, Indices, Indices]:
    cells = np.round(vertices / (_WELD * size))
    _, first, place = np.unique(cells, axis=0, return_index=True, return_inverse=True)
    triangles = place.reshape(-1)[triangles]
    a, b, c = triangles.T
    kept = np.flatnonzero((a != b) & (b != c) & (c != a))
    return vertices[first], triangles[kept], kept


def _edges(triangles: Indices, count: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """Indices of the edges of all faces, in both directions."""
    a, b = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    return a * count + b, b * count + a


def _closed(vertices: F64, triangles: Indices, remarks: list[str]) -> tuple[Mesh, Kept]:
    if not triangles.size:
        raise ValueError("has no faces")
    finite = np.isfinite(vertices).all(axis=1)
    if not finite.all():
        raise ValueError(f"vertex {int(np.argmin(finite)) + 1} is not finite")
    size = float(np.ptp(vertices[triangles.ravel()], axis=0).max())
    if not size > 0.0:
        raise ValueError("has no extent")
    vertices, triangles, kept = _welded(vertices, triangles, size)
    along, against = _edges(triangles, len(vertices))
    twice = len(along) - len(np.unique(along))
    if twice:
        raise ValueError(
            f"{twice} edges are run through twice in one direction: faces overlap, or some are "
            "wound the other way round"
        )
    alone = int((~np.isin(along, against)).sum())
    if alone:
        raise ValueError(f"is not closed: {alone} edges have one face alone")
    corners = vertices[triangles]
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    if volume < 0.0:
        remarks.append("faces are wound inwards, and turned")
        triangles = triangles[:, ::-1]
    return (vertices, triangles), Kept(kept, volume < 0.0)


_READERS: dict[str, Callable[[Path, list[str]], tuple[_core.Model | None, F64, Indices]]] = {
    ".obj": _read_text,
    ".tab": _read_text,
    ".txt": _read_text,
    ".gltf": _read_gltf,
    ".glb": _read_gltf,
}
