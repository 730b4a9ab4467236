"""Models of a BOP dataset: PLY files in millimetres about the centre of their box, and their
sizes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.export.writers.bop_files import MM_PER_M
from perilune.export.writers.diameter import diameter

F64 = NDArray[np.float64]

MODELS = "models"
PARTS = "models_parts"
"""Folder of the moving parts of articulated objects."""
EVAL = "models_eval"
"""Folder of the models for the evaluation of pose errors."""
FOLDERS = (MODELS, PARTS, EVAL)
MODELS_INFO = "models_info.json"

_VERTEX = np.dtype(
    [(name, "<f4") for name in ("x", "y", "z", "nx", "ny", "nz")]
    + [(name, "u1") for name in ("red", "green", "blue")]
)
DOUBLE = np.dtype(
    [(name, "<f8" if name in "xyz" else _VERTEX[name].str) for name in _VERTEX.names or ()]
)
"""Vertices of models that reach far beyond their details."""
_FACE = np.dtype([("count", "u1"), ("vertex_indices", "<i4", (3,))])
_PLY_TYPE = {"f8": "double", "f4": "float", "u1": "uchar"}
"""Old names of types; the toolkit's reader does not know float32 and uint8."""


@dataclass(frozen=True)
class Surfaces:
    """Visibility of a model's triangles, and the moving nodes above them."""

    double_sided: NDArray[np.bool_]  # (T,), whose backs can be seen from outside
    presence: NDArray[np.uint8]  # (T,), 0: nothing of it, 1: perhaps a part, 2: all
    nodes: Sequence[tuple[str, ...]] = ()
    """Chains of moving nodes, nearest first."""
    triangle_nodes: NDArray[np.int64] | None = None  # (T,), index into `nodes`; None: nothing moves


@dataclass(frozen=True)
class BopModel:
    """A model in BOP's form, and the position of its origin in the object's own frame.

    It has the faces that are rendered, so that a renderer with back-face culling shows the same:
    single-sided triangles once, double-sided ones once from each side, those that alpha cuts in
    part at the end, and none that alpha removes."""

    obj_id: int
    vertices: NDArray[Any]  # of _VERTEX or DOUBLE, mm
    faces: NDArray[np.int32]  # (F, 3)
    center_m: F64  # (3,), the origin in the object's frame, metres
    symmetries_discrete: Sequence[tuple[F64, F64]]  # rotation (3, 3), about a point (3,), m, there
    symmetries_continuous: Sequence[tuple[F64, F64]]  # axis, offset in the object's frame (m)
    counts: Mapping[str, int | str]
    """Keys of models_info.json in addition to BOP's: numbers of special faces; what a body is."""
    nodes: Sequence[tuple[str, ...]] = ()
    """Chains of moving nodes, nearest first; empty if nothing moves."""
    face_nodes: NDArray[np.int64] | None = None  # (F,), index into `nodes`

    @property
    def positions_mm(self) -> F64:
        return np.stack([self.vertices[name].astype(np.float64) for name in "xyz"], axis=1)

    def pieces(self) -> list[tuple[tuple[str, ...], BopModel]]:
        """The parts that move separately, in the frame of the whole, with their moving nodes."""
        if self.face_nodes is None:
            return []
        found = []
        for k, chain in enumerate(self.nodes):
            mine = self.face_nodes == k
            if mine.any():
                used, faces = np.unique(self.faces[mine], return_inverse=True)
                piece = replace(
                    self,
                    vertices=self.vertices[used],
                    faces=faces.reshape(-1, 3).astype(np.int32),
                    symmetries_discrete=(),
                    symmetries_continuous=(),
                    counts={},
                    nodes=(),
                    face_nodes=None,
                )
                found.append((chain, piece))
        return found


def _vertex_colors(mesh: dict[str, NDArray[Any]], count: int) -> NDArray[np.uint8]:
    """Mean colour of the triangles at each vertex. Materials share no vertex, so their colours do
    not mix."""
    corners = mesh["indices"].ravel()
    uses = np.maximum(np.bincount(corners, minlength=count), 1)
    colors = np.empty((count, 3), dtype=np.uint8)
    for channel in range(3):
        weights = np.repeat(mesh["triangle_color"][:, channel].astype(np.float64), 3)
        total = np.bincount(corners, weights=weights, minlength=count)
        colors[:, channel] = np.rint(total / uses)
    return colors


def _faces(
    indices: NDArray[np.int64], surfaces: Surfaces
) -> tuple[NDArray[np.int64], NDArray[np.int64], dict[str, int]]:
    """Corners (F, 3) of the faces to write, the triangle (F,) of each, and their counts."""
    order, corners = [], []
    for presence in (2, 1):
        fronts = np.flatnonzero(surfaces.presence == presence)
        backs = fronts[surfaces.double_sided[fronts]]
        order += [fronts, backs]
        corners += [indices[fronts], indices[backs][:, ::-1]]
    counts = {
        "faces_one_sided": int(len(order[0]) - len(order[1]) + len(order[2]) - len(order[3])),
        "faces_cut_in_part": len(order[2]) + len(order[3]),
        "triangles_left_out": int(np.count_nonzero(surfaces.presence == 0)),
    }
    told = {name: count for name, count in counts.items() if count}
    return np.concatenate(corners), np.concatenate(order), told


def bop_model(
    obj_id: int,
    mesh: dict[str, NDArray[Any]],
    surfaces: Surfaces,
    offset: F64,
    metres_per_unit: float,
    symmetries_discrete: Sequence[tuple[F64, F64]] = (),
    symmetries_continuous: Sequence[tuple[F64, F64]] = (),
    dtype: np.dtype[Any] | None = None,
) -> BopModel:
    """Converts a mesh in model units to a BOP model.

    A model point p is at metres_per_unit * (p - offset) in the object's frame. BOP's origin is the
    centre of the bounding box of the vertices of faces, at `center_m` in the object's frame.
    dtype: of a vertex."""
    corners, triangles, counts = _faces(mesh["indices"].astype(np.int64), surfaces)
    used, faces = np.unique(corners, return_inverse=True)
    if used.size == 0:
        raise ValueError(f"object {obj_id}: its model has no triangle that is seen; BOP needs some")
    positions = mesh["positions"][used].astype(np.float64)
    center = 0.5 * (positions.min(axis=0) + positions.max(axis=0))
    positions_mm = (positions - center) * (metres_per_unit * MM_PER_M)
    vertices = np.zeros(used.size, dtype=dtype or _VERTEX)
    for axis in range(3):
        vertices["xyz"[axis]] = positions_mm[:, axis]
        vertices["n" + "xyz"[axis]] = mesh["normals"][used, axis]
    colors = _vertex_colors(mesh, len(mesh["positions"]))[used]
    for channel, name in enumerate(("red", "green", "blue")):
        vertices[name] = colors[:, channel]
    moving = surfaces.triangle_nodes
    return BopModel(
        obj_id,
        vertices,
        faces.reshape(-1, 3).astype(np.int32),
        metres_per_unit * (center - np.asarray(offset, dtype=np.float64)),
        symmetries_discrete,
        symmetries_continuous,
        counts,
        surfaces.nodes,
        None if moving is None else moving[triangles],
    )


def ply_bytes(model: BopModel) -> Iterable[bytes]:
    """A binary little-endian PLY with normals and vertex colours."""
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {len(model.vertices)}"]
    layout = model.vertices.dtype
    for name in layout.names or ():
        lines.append(f"property {_PLY_TYPE[layout[name].str[1:]]} {name}")
    lines += [
        f"element face {len(model.faces)}",
        "property list uchar int vertex_indices",
        "end_header",
    ]
    faces = np.zeros(len(model.faces), dtype=_FACE)
    faces["count"] = 3
    faces["vertex_indices"] = model.faces
    return ["\n".join(lines).encode("ascii") + b"\n", model.vertices.tobytes(), faces.tobytes()]


def about_origin(model: BopModel, rotation: F64, point_m: F64) -> F64:
    """(4, 4), mm: a rotation about a point of the object's frame, in the BOP model's frame."""
    point_mm = (np.asarray(point_m, dtype=np.float64) - model.center_m) * MM_PER_M
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = point_mm - rotation @ point_mm
    return matrix


def _discrete(model: BopModel) -> list[list[float]]:
    return [
        [float(value) for value in about_origin(model, rotation, point_m).ravel()]
        for rotation, point_m in model.symmetries_discrete
    ]


def _continuous(model: BopModel) -> list[dict[str, list[float]]]:
    lines = []
    for axis, offset in model.symmetries_continuous:
        unit = np.asarray(axis, dtype=np.float64) / np.linalg.norm(axis)
        moved_mm = (np.asarray(offset, dtype=np.float64) - model.center_m) * MM_PER_M
        lines.append({"axis": unit.tolist(), "offset": moved_mm.tolist()})
    return lines


def model_info(model: BopModel) -> dict[str, Any]:
    """One entry of models_info.json, from the vertices as written."""
    positions = model.positions_mm
    low, high = positions.min(axis=0), positions.max(axis=0)
    info: dict[str, Any] = {"diameter": diameter(positions), **model.counts}
    for axis, name in enumerate("xyz"):
        info[f"min_{name}"] = float(low[axis])
        info[f"size_{name}"] = float(high[axis] - low[axis])
    if model.symmetries_discrete:
        info["symmetries_discrete"] = _discrete(model)
    if model.symmetries_continuous:
        info["symmetries_continuous"] = _continuous(model)
    return info
