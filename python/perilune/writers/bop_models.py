"""Models of a BOP dataset: PLY files in millimetres about their box's centre, and their sizes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.writers.bop_files import MM_PER_M, json_by_id, write_bytes, write_text
from perilune.writers.diameter import diameter

F64 = NDArray[np.float64]

_VERTEX = np.dtype(
    [(name, "<f4") for name in ("x", "y", "z", "nx", "ny", "nz")]
    + [(name, "u1") for name in ("red", "green", "blue")]
)
_FACE = np.dtype([("count", "u1"), ("vertex_indices", "<i4", (3,))])
_PLY_TYPE = {"f4": "float", "u1": "uchar"}
"""The toolkit's reader knows the old type names only, not float32 and uint8."""


@dataclass(frozen=True)
class BopModel:
    """A model as BOP wants it, and where its origin lies in the object's own frame."""

    obj_id: int
    vertices: NDArray[Any]  # of _VERTEX, mm
    faces: NDArray[np.int32]  # (T, 3)
    center_m: F64  # (3,), the origin in the object's frame, metres
    symmetries_discrete: Sequence[F64]  # (3, 3) each, about the object frame's origin
    symmetries_continuous: Sequence[tuple[F64, F64]]  # axis, offset in the object's frame (m)

    @property
    def positions_mm(self) -> F64:
        return np.stack([self.vertices[name].astype(np.float64) for name in "xyz"], axis=1)


def _vertex_colors(mesh: dict[str, NDArray[Any]], count: int) -> NDArray[np.uint8]:
    """Mean colour of the triangles at each vertex. Materials share no vertex, so none blend."""
    corners = mesh["indices"].ravel()
    uses = np.maximum(np.bincount(corners, minlength=count), 1)
    colors = np.empty((count, 3), dtype=np.uint8)
    for channel in range(3):
        weights = np.repeat(mesh["triangle_color"][:, channel].astype(np.float64), 3)
        total = np.bincount(corners, weights=weights, minlength=count)
        colors[:, channel] = np.rint(total / uses)
    return colors


def bop_model(
    obj_id: int,
    mesh: dict[str, NDArray[Any]],
    offset: F64,
    metres_per_unit: float,
    symmetries_discrete: Sequence[F64] = (),
    symmetries_continuous: Sequence[tuple[F64, F64]] = (),
) -> BopModel:
    """Turns a mesh in model units into a BOP model.

    A model point p is at metres_per_unit * (p - offset) in the object's frame. BOP's origin is the
    centre of the box of the vertices that triangles use; `center_m` is where that lies.
    """
    used, faces = np.unique(mesh["indices"].astype(np.int64), return_inverse=True)
    if used.size == 0:
        raise ValueError(f"object {obj_id}: its model has no triangle; BOP needs a mesh")
    positions = mesh["positions"][used].astype(np.float64)
    center = 0.5 * (positions.min(axis=0) + positions.max(axis=0))
    positions_mm = (positions - center) * (metres_per_unit * MM_PER_M)
    vertices = np.zeros(used.size, dtype=_VERTEX)
    for axis in range(3):
        vertices["xyz"[axis]] = positions_mm[:, axis]
        vertices["n" + "xyz"[axis]] = mesh["normals"][used, axis]
    colors = _vertex_colors(mesh, len(mesh["positions"]))[used]
    for channel, name in enumerate(("red", "green", "blue")):
        vertices[name] = colors[:, channel]
    return BopModel(
        obj_id,
        vertices,
        faces.reshape(-1, 3).astype(np.int32),
        metres_per_unit * (center - np.asarray(offset, dtype=np.float64)),
        symmetries_discrete,
        symmetries_continuous,
    )


def ply_bytes(model: BopModel) -> Iterable[bytes]:
    """A binary little-endian PLY with normals and vertex colours."""
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {len(model.vertices)}"]
    for name in _VERTEX.names or ():
        lines.append(f"property {_PLY_TYPE[_VERTEX[name].str[1:]]} {name}")
    lines += [
        f"element face {len(model.faces)}",
        "property list uchar int vertex_indices",
        "end_header",
    ]
    faces = np.zeros(len(model.faces), dtype=_FACE)
    faces["count"] = 3
    faces["vertex_indices"] = model.faces
    return ["\n".join(lines).encode("ascii") + b"\n", model.vertices.tobytes(), faces.tobytes()]


def _discrete(model: BopModel) -> list[list[float]]:
    """4x4 matrices about the box's centre: x -> R (x + c) - c for a rotation about c's origin."""
    matrices = []
    for rotation in model.symmetries_discrete:
        matrix = np.eye(4)
        matrix[:3, :3] = rotation
        matrix[:3, 3] = (rotation @ model.center_m - model.center_m) * MM_PER_M
        matrices.append([float(value) for value in matrix.ravel()])
    return matrices


def _continuous(model: BopModel) -> list[dict[str, list[float]]]:
    lines = []
    for axis, offset in model.symmetries_continuous:
        unit = np.asarray(axis, dtype=np.float64) / np.linalg.norm(axis)
        moved_mm = (np.asarray(offset, dtype=np.float64) - model.center_m) * MM_PER_M
        lines.append({"axis": unit.tolist(), "offset": moved_mm.tolist()})
    return lines


def model_info(model: BopModel) -> dict[str, Any]:
    """One entry of models_info.json, of the vertices as written."""
    positions = model.positions_mm
    low, high = positions.min(axis=0), positions.max(axis=0)
    info: dict[str, Any] = {"diameter": diameter(positions)}
    for axis, name in enumerate("xyz"):
        info[f"min_{name}"] = float(low[axis])
        info[f"size_{name}"] = float(high[axis] - low[axis])
    if model.symmetries_discrete:
        info["symmetries_discrete"] = _discrete(model)
    if model.symmetries_continuous:
        info["symmetries_continuous"] = _continuous(model)
    return info


def write_models(folder: Path, models: dict[int, BopModel]) -> None:
    """The PLY of every model, and models_info.json last."""
    folder.mkdir(parents=True, exist_ok=True)
    for obj_id in sorted(models):
        write_bytes(folder / f"obj_{obj_id:06d}.ply", ply_bytes(models[obj_id]))
    infos = {obj_id: model_info(model) for obj_id, model in models.items()}
    write_text(folder / "models_info.json", json_by_id(infos))
