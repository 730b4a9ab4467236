"""Checks the models of a dataset: meshes, and models_info.json against them."""

from __future__ import annotations

from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from perilune.export.check.findings import Report
from perilune.export.check.ply import Mesh, PlyError, read_ply
from perilune.export.check.records import EvalInfo, ModelInfo, PartInfo, by_id, read_json
from perilune.export.check.retrace import Shapes
from perilune.export.writers.bop_models import EVAL, MODELS, PARTS
from perilune.export.writers.diameter import diameter

F64 = NDArray[np.float64]

_SIZES = 1e-6
"""Relative tolerance; sizes are exact except for rounding in sums."""
_CENTRE = 1e-5
"""Largest distance of the box's centre from the origin, relative to the diameter: single
precision."""
_NORMALS = 1e-3
ROTATION = 1e-9
"""Largest deviation of R^T R from the identity."""


def rotation_fault(R: F64) -> str | None:
    """Reason why a 3x3 matrix is no rotation."""
    off = float(np.abs(R @ R.T - np.eye(3)).max())
    if off > ROTATION:
        return f"is not orthonormal: R R^T differs from 1 by {off:.3g}"
    return None if np.linalg.det(R) > 0.0 else "has determinant -1: a reflection, no rotation"


def _check_mesh(report: Report, path: Path, mesh: Mesh) -> bool:
    if not report.need(len(mesh.faces) > 0, path, "has no triangle"):
        return False
    if not report.need(bool(np.isfinite(mesh.points).all()), path, "has non-finite vertices"):
        return False
    inside = bool(mesh.faces.min() >= 0 and mesh.faces.max() < len(mesh.points))
    report.need(inside, path, "has a face of a vertex that does not exist")
    lengths = np.linalg.norm(mesh.normals, axis=1)
    bad = np.count_nonzero(~(np.abs(lengths - 1.0) <= _NORMALS))
    report.need(bad == 0, path, f"has {bad} normals that are not of unit length")
    return True


def _check_info(report: Report, path: Path, key: str, info: ModelInfo, mesh: Mesh) -> None:
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    longest = diameter(mesh.points)
    truth = {"diameter": longest}
    for axis, name in enumerate("xyz"):
        truth[f"min_{name}"] = float(low[axis])
        truth[f"size_{name}"] = float(high[axis] - low[axis])
    for name, value in truth.items():
        stated = getattr(info, name)
        close = abs(stated - value) <= _SIZES * longest
        report.need(close, path, f"{key}.{name} is {stated:g}, the model has {value:g}")
    cut = info.faces_cut_in_part <= len(mesh.faces)
    report.need(cut, path, f"{key}.faces_cut_in_part exceeds the model's {len(mesh.faces)} faces")
    centre = float(np.abs(low + high).max()) / 2.0
    report.need(
        isinstance(info, (PartInfo, EvalInfo)) or centre <= _CENTRE * longest,
        path,
        f"{key}: the model's box is centred {centre:g} mm from the origin",
    )
    for k, matrix in enumerate(info.symmetries_discrete):
        R = np.reshape(matrix, (4, 4))
        fault = rotation_fault(R[:3, :3])
        report.need(fault is None, path, f"{key}.symmetries_discrete[{k}] {fault}")
        last = R[3].tolist() == [0.0, 0.0, 0.0, 1.0]
        report.need(last, path, f"{key}.symmetries_discrete[{k}]: last row must be 0 0 0 1")
    for k, line in enumerate(info.symmetries_continuous):
        unit = abs(float(np.linalg.norm(line.axis)) - 1.0) <= ROTATION
        report.need(unit, path, f"{key}.symmetries_continuous[{k}].axis is not of unit length")


def check_shapes(report: Report) -> Shapes:
    """Checks all models and their moving parts; returns their geometry for rays."""
    infos, meshes = _check_models(report, MODELS, ModelInfo)
    if (report.folder / EVAL).exists():
        _check_models(report, EVAL, EvalInfo)
    parts: dict[int, list[tuple[PartInfo, Mesh]]] = {}
    if (report.folder / PARTS).exists():
        entries, pieces = _check_models(report, PARTS, PartInfo)
        for number, mesh in pieces.items():
            if mesh is not None:
                parts.setdefault(entries[number].obj_id, []).append((entries[number], mesh))
    return Shapes(meshes, infos, parts)


Kind = TypeVar("Kind", bound=ModelInfo)


def _check_models(
    report: Report, name: str, kind: type[Kind]
) -> tuple[dict[int, Kind], dict[int, Mesh | None]]:
    """Checks a folder of models; returns the entry and the mesh of every listed model, None for an
    invalid mesh."""
    folder = report.folder / name
    infos = read_json(report, folder / "models_info.json", by_id(kind)) or {}
    meshes: dict[int, Mesh | None] = dict.fromkeys(map(int, infos))
    names = {f"obj_{int(key):06d}.ply": key for key in infos}
    present = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
    for name in sorted(present - set(names) - {"models_info.json"}):
        report.add(folder / name, "is not in models_info.json")
    for name, key in names.items():
        path = folder / name
        try:
            mesh = read_ply(path)
        except FileNotFoundError:
            report.add(path, "is missing")
            continue
        except (OSError, PlyError) as error:
            report.add(path, str(error))
            continue
        if _check_mesh(report, path, mesh):
            _check_info(report, folder / "models_info.json", key, infos[key], mesh)
            meshes[int(key)] = mesh
    return {int(key): info for key, info in infos.items()}, meshes
