"""Opens the configuration of a dataset, and compares all files outside the scenes with its
results."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, JsonValue, TypeAdapter

from perilune.document import Document
from perilune.export.check.differences import EXACT, OTHER_BUILD, Tolerance, differences
from perilune.export.check.findings import Report
from perilune.export.check.ply import Mesh, PlyError, read_ply
from perilune.export.check.records import Source, read_json
from perilune.export.writers.bop import Job, open_job
from perilune.export.writers.config_file import CONFIG_FILE
from perilune.export.writers.files import SOURCE_FILE
from perilune.simulation import Simulation

_FREE = {"versions", "files_sha256"}
"""Keys of dataset_info.json that are compared separately."""


class StoredConfig(BaseModel):
    """config.json."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    base: str
    functions: list[str] = []
    overrides: dict[str, JsonValue] = {}
    replay: dict[str, JsonValue] | None = None
    tree: dict[str, JsonValue]


_WITHOUT = "frames, models and colour were not made again for comparison:"


@dataclass(frozen=True)
class Remake:
    """A source of a dataset's frames, made again."""

    sim: Simulation
    job: Job
    """Job of a separate dataset for comparison."""
    tolerance: Tolerance
    chunk_size: int
    changed: Sequence[str] = ()
    """Keys of models and maps that have changed since the dataset was made."""


def _opened(stored: StoredConfig, source: str, base: Path | None) -> Simulation:
    tree: Any = stored.tree
    document = Document(tree, base or Path(stored.base), source, None, stored.replay)
    document.changes = stored.overrides
    sim = Simulation(document)
    len(sim.models)  # reads the files
    return sim


def _check_hash(report: Report, stored: StoredConfig) -> None:
    tree = {key: value for key, value in stored.tree.items() if key != "seed"}
    text = json.dumps(tree, sort_keys=True, separators=(",", ":"))
    found = hashlib.sha256(text.encode("utf-8")).hexdigest()
    stated = json.loads((report.folder / SOURCE_FILE).read_text())["config_sha256"]
    reason = f"config_sha256 is {stated}, {CONFIG_FILE} has {found}"
    report.need(found == stated, report.folder / SOURCE_FILE, reason)


def reopened(report: Report, base: Path | None = None) -> Simulation | None:
    """Opens the configuration of a dataset; None, after a note with the reason, if that is
    impossible. base: folder that relative paths refer to, if it is no longer the recorded one."""
    path = report.folder / CONFIG_FILE
    stored = read_json(report, path, TypeAdapter(StoredConfig))
    if stored is None:
        report.note(f"{_WITHOUT} {CONFIG_FILE} is of no use")
        return None
    _check_hash(report, stored)
    if stored.functions:
        told = ", ".join(stored.functions)
        report.note(f"{_WITHOUT} {told} were functions given in code, which no file holds")
        return None
    try:
        return _opened(stored, str(path), base)
    except Exception as error:  # of hooks, anything
        report.note(f"{_WITHOUT} the configuration cannot be opened: {error}")
        return None


def open_remake(
    report: Report, source: Source, folder: Path, base: Path | None = None
) -> Remake | None:
    """Opens the configuration of a BOP dataset; None, after a note with the reason, if that is
    impossible.

    folder: that of the dataset made for comparison. base: as for `reopened`."""
    sim = reopened(report, base)
    if sim is None:
        return None
    try:
        job = open_job(sim, folder, source.chunk_size, source.split)
    except Exception as error:  # of hooks, anything
        report.note(f"{_WITHOUT} the configuration cannot be opened: {error}")
        return None
    tolerance, changed = _compared(report, folder)
    return Remake(sim, job, tolerance, source.chunk_size, changed)


def _compared(report: Report, folder: Path) -> tuple[Tolerance, list[str]]:
    """Compares dataset_info.json; returns the tolerance for everything else, and the changed
    files."""
    path = report.folder / SOURCE_FILE
    found, made = (json.loads((root / SOURCE_FILE).read_text()) for root in (report.folder, folder))
    for key in sorted(set(made) - _FREE):
        for where, what in differences(found.get(key), made[key], EXACT, key):
            report.add(path, f"{where} {what}")
    for key in sorted(set(found) - set(made)):
        report.add(path, f"{key} does not belong there")
    stated = found.get("versions")
    told = isinstance(stated, dict) and set(stated) == set(made["versions"])
    report.need(told, path, f"versions must be those of {', '.join(made['versions'])}")
    same = stated == made["versions"]
    if not same:
        report.note(
            f"labels made again may differ in {OTHER_BUILD.few} pixels and one in a thousand, and "
            f"{OTHER_BUILD.relative:g} of numbers: the dataset was made by {stated}"
        )
    return EXACT if same else OTHER_BUILD, _changed_files(report, found, made)


def _changed_files(report: Report, found: dict[str, Any], made: dict[str, Any]) -> list[str]:
    """Keys of models and maps whose hashes differ from those of the present files."""
    path, key = report.folder / SOURCE_FILE, "files_sha256"
    stated, now = found.get(key), made[key]
    if not isinstance(stated, dict) or set(stated) != set(now):
        report.add(path, f"{key} must name the files of {', '.join(sorted(now))}")
        return []
    return [name for name in sorted(now) if stated[name] != now[name]]


def compare_root(report: Report, remake: Remake, folder: Path) -> None:
    """Compares the files outside scenes with those made again, except dataset_info.json."""
    for made in sorted(path for path in folder.rglob("*") if path.is_file()):
        name = made.relative_to(folder)
        path = report.folder / name
        if name.name in (SOURCE_FILE, CONFIG_FILE):
            continue
        if not path.is_file():
            if name.parts[0] != "models":  # reported by the check of the models
                report.add(path, "is missing")
        elif path.read_bytes() != made.read_bytes():
            _explain(report, path, made, remake.tolerance)


def _explain(report: Report, path: Path, made: Path, tolerance: Tolerance) -> None:
    """Reports how a file differs from the one made again."""
    if path.suffix == ".json":
        try:
            found, expected = json.loads(path.read_text()), json.loads(made.read_text())
        except ValueError:
            return  # reported when it was read
        for where, what in differences(found, expected, tolerance):
            report.add(path, f"{where} {what}")
    elif path.suffix == ".ply":
        try:
            found_mesh = read_ply(path)
        except (OSError, PlyError):
            return  # reported when it was read
        text = _mesh_difference(found_mesh, read_ply(made), tolerance)
        if text:
            report.add(path, f"is not the model that the frames show: {text}")
    else:
        report.add(path, "is not what the configuration makes")


def _mesh_difference(found: Mesh, made: Mesh, tolerance: Tolerance) -> str | None:
    """Plainest difference of two models."""
    counts = (len(found.points), len(found.faces)), (len(made.points), len(made.faces))
    if counts[0] != counts[1]:
        return (
            f"it has {counts[0][0]} vertices and {counts[0][1]} faces, must have {counts[1][0]} "
            f"and {counts[1][1]}"
        )
    size = float(np.ptp(made.points, axis=0).max())
    away = float(np.abs(found.points - made.points).max())
    if not away <= tolerance.relative * size:
        scale = float(np.linalg.norm(found.points) / np.linalg.norm(made.points))
        return f"vertices are up to {away:.3g} mm away ({scale:.6g} times the size)"
    if (found.faces != made.faces).any():
        count = int((found.faces != made.faces).any(axis=1).sum())
        return f"{count} of {len(made.faces)} faces have other vertices"
    turned = float(np.abs(found.normals - made.normals).max())
    if not turned <= tolerance.relative * 10:
        return f"normals differ by up to {turned:.3g}"
    return None if tolerance.relative else "colours or names of properties differ"
