"""Checks for content that the configuration asks for but the dataset lacks."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from perilune.export.check.findings import Report
from perilune.export.writers.bop_files import CAMERA_FILE, GT_FILE, INFO_FILE, MM_PER_M
from perilune.export.writers.config_file import CONFIG_FILE
from perilune.export.writers.files import load_object
from perilune.frame.unseen import target_of
from perilune.simulation import Simulation

_FAR_OFF = 100.0
"""Distance of the view from a target, in its sizes, beyond which the camera is not meant to see it,
as in a star tracker."""
_PIXELS = 4.0
"""Size of a target's bounding sphere in pixels that is certain to show; pixel centres can miss thin
objects."""


def _seen(folders: Sequence[Path]) -> Iterator[tuple[int, bool]]:
    """(object, whether it is visible) for all instances of all images."""
    for folder in folders:
        told: dict[str, Any] = load_object(folder / INFO_FILE)
        for im_id, rows in load_object(folder / GT_FILE).items():
            for row, info in zip(rows, told.get(im_id, []), strict=False):
                yield row["obj_id"], info["px_count_visib"] > 0


def check_intent(report: Report, sim: Simulation, folders: Sequence[Path]) -> None:
    """Reports classes of parts without a part, and a camera's target that no image shows."""
    path = report.folder / CONFIG_FILE
    for key, text in sim.unmatched_part_classes():
        report.add(path, f"{key}: {text}")
    target = target_of(sim.config)
    if target is None:
        return
    obj_id = sim.models[target].obj_id
    if any(visible for found, visible in _seen(folders) if found == obj_id):
        return
    text = f"camera.trajectory.target: '{target}' is visible in no image"
    size_m = 2.0 * sim.models[target].radius_m
    offset_m = math.hypot(*getattr(sim.config.camera.trajectory, "aim_offset_m", (0.0,)))
    if offset_m > _FAR_OFF * size_m or _smallest_px(folders, obj_id, size_m) < _PIXELS:
        report.note(f"{text}: the camera looks far beside it, or it is too small in some")
    else:
        report.add(path, text)


def _smallest_px(folders: Sequence[Path], obj_id: int, size_m: float) -> float:
    """Size of an object in the image where it is farthest; inf if it is in none."""
    sizes = [float("inf")]
    for folder in folders:
        cameras = load_object(folder / CAMERA_FILE)
        for im_id, rows in load_object(folder / GT_FILE).items():
            focal_px = cameras[im_id]["cam_K"][0] if im_id in cameras else 0.0
            for row in rows:
                if row["obj_id"] == obj_id:
                    away_mm = max(math.hypot(*row["cam_t_m2c"]), 1e-9)
                    sizes.append(focal_px * MM_PER_M * size_m / away_mm)
    return min(sizes)
