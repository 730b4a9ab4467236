"""Makes a dataset again from the configuration that it holds, and compares every file."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path

from perilune.export.check.colour import ColourCheck
from perilune.export.check.findings import Report
from perilune.export.check.intent import check_intent
from perilune.export.check.records import Source
from perilune.export.check.remade_image import RemadeScene
from perilune.export.check.reopened import Remake, compare_root, open_remake
from perilune.export.check.scene import Step
from perilune.export.writers.bop_files import CAMERA_FILE
from perilune.export.writers.files import SOURCE_FILE, load_object

_MEMORY = "/dev/shm"
_ROOM = 2 << 30
"""Bytes of free space needed there: for models, and one image at a time."""
_OF_FILES = f"files_sha256 in {SOURCE_FILE} names"
_SAME = "what is there now makes the very same dataset"


def _scratch() -> str | None:
    """A folder in memory, which needs no disk; None: any other."""
    try:
        roomy = shutil.disk_usage(_MEMORY).free >= _ROOM
    except OSError:
        return None
    return _MEMORY if roomy and os.access(_MEMORY, os.W_OK) else None


def _indices(folders: list[Path], chunk_size: int) -> dict[Path, dict[int, int]]:
    """Scene folder -> image id -> frame index, from the cameras' files."""
    found: dict[Path, dict[int, int]] = {}
    for folder in folders:
        im_ids = sorted(int(key) for key in load_object(folder / CAMERA_FILE) if key.isdecimal())
        found[folder] = {im_id: int(folder.name) * chunk_size + im_id for im_id in im_ids}
    return found


def _spread_over(indices: Sequence[int], count: int) -> frozenset[int]:
    """This many of the indices, evenly spread over them."""
    total = len(indices)
    count = min(count, total)
    return frozenset(indices[(2 * k + 1) * total // (2 * count)] for k in range(count))


def _compare_frames(
    report: Report, remake: Remake, folders: list[Path], rerender: int | None, step: Step
) -> None:
    """Compares all images with the frames rendered again."""
    frames = _indices(folders, remake.chunk_size)
    every = [index for rows in frames.values() for index in rows.values()]
    exact = None if rerender is None else _spread_over(every, rerender)
    colour = ColourCheck(report, remake, exact)
    for folder, rows in frames.items():
        scene = RemadeScene(report, remake, folder, colour)
        for im_id, index in rows.items():
            scene.compare(im_id, index)
            step()
    told = f"all {len(every)}" if colour.in_full == len(every) else str(colour.in_full)
    text = f"colour of {told} of {len(every)} images was rendered again in full"
    if colour.in_full < len(every):
        few = f"{colour.few} of {colour.samples} samples"
        text += f", that of the others compared at {few} (--rerender all: all in full)"
    report.note(f"models and labels of all images were made again; {text}")


def compare_with_config(
    report: Report,
    source: Source,
    folders: list[Path],
    rerender: int | None,
    base: Path | None,
    step: Step,
) -> bool:
    """Makes the dataset again from its configuration, and compares. False if that is impossible."""
    with tempfile.TemporaryDirectory(prefix="perilune-check-", dir=_scratch()) as name:
        remake = open_remake(report, source, Path(name), base)
        if remake is None:
            return False
        own = Report(report.folder)
        compare_root(own, remake, Path(name))
        _compare_frames(own, remake, folders, rerender, step)
        check_intent(own, remake.sim, folders)
    if remake.changed and own.total:
        told = f"{own.total} differences from what is made of them are not told"
        report.note(f"files of the configuration are no longer those that {_OF_FILES}: {told}")
        return False
    for name in remake.changed:
        report.add(report.folder / SOURCE_FILE, f"files_sha256.{name} is not of the file: {_SAME}")
    report.join(own)
    return True
