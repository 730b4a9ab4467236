"""What a dataset does not hold though its configuration asks for it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from perilune.check.findings import Report
from perilune.simulation import Simulation
from perilune.unseen import target_of
from perilune.writers.bop_config import CONFIG_FILE
from perilune.writers.bop_files import GT_FILE, INFO_FILE, load_object


def _seen(folders: Sequence[Path]) -> Iterator[tuple[int, bool]]:
    """(object, whether it is visible) of all instances of all images."""
    for folder in folders:
        told: dict[str, Any] = load_object(folder / INFO_FILE)
        for im_id, rows in load_object(folder / GT_FILE).items():
            for row, info in zip(rows, told.get(im_id, []), strict=False):
                yield row["obj_id"], info["px_count_visib"] > 0


def check_intent(report: Report, sim: Simulation, folders: Sequence[Path]) -> None:
    """Classes of parts that no part has, and a camera's target that no image shows."""
    path = report.folder / CONFIG_FILE
    for key, text in sim.unmatched_part_classes():
        report.add(path, f"{key}: {text}")
    target = target_of(sim.config)
    if target is None:
        return
    obj_id = sim.models[target].obj_id
    if not any(visible for found, visible in _seen(folders) if found == obj_id):
        report.add(path, f"camera.trajectory.target: '{target}' is visible in no image")
