"""Compares the labels of images with those rendered from the configuration, file by file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.export.check.colour import ColourCheck
from perilune.export.check.differences import Tolerance, differences
from perilune.export.check.findings import Report
from perilune.export.check.png import PngError, read_png
from perilune.export.check.reopened import Remake
from perilune.export.writers.bop_files import (
    CAMERA_FILE,
    COCO_FILE,
    FRAMES_FILE,
    GT_FILE,
    INFO_FILE,
    KEYPOINTS_FILE,
)
from perilune.sample import Sample


def json_files(record: Any) -> dict[str, Any]:
    """File -> expected content for one image; annotations without their ids."""
    entry = json.loads(json.dumps(vars(record)))
    names = {"camera": CAMERA_FILE, "gt": GT_FILE, "gt_info": INFO_FILE, "annotations": COCO_FILE}
    names |= {"frame": FRAMES_FILE, "keypoints": KEYPOINTS_FILE}
    return {name: entry[key] for key, name in names.items() if entry.get(key) is not None}


class RemadeScene:
    """Renders the images of a scene again in a separate folder, and compares."""

    def __init__(self, report: Report, remake: Remake, folder: Path, colour: ColourCheck) -> None:
        self.report = report
        self.remake = remake
        self.folder = folder
        self.scene_id = int(folder.name)
        self.colour = colour
        self.made = remake.job.folder(self.scene_id)
        self.tables = {name: _load(folder / name) for name in self.made.json_files}
        self.tables[COCO_FILE] = _annotations(_load(folder / COCO_FILE))
        self.made.prepare()

    def compare(self, im_id: int, index: int) -> None:
        """Makes one image again and compares all its files; colour as `colour` asks for."""
        try:
            sample = self.colour.sample(index, self.remake.job.channels)
        except Exception as error:  # of a hook, anything
            self.report.note(f"{self.folder.name}: image {im_id} cannot be made again: {error}")
            return
        self._labels(im_id, sample)

    def _labels(self, im_id: int, sample: Sample) -> None:
        record = self.remake.job.write_image(self.made, im_id, sample)
        for name, expected in json_files(record).items():
            found = self.tables[name].get(str(im_id))
            if found is None:
                continue  # reported by the comparison of the tables
            for where, what in differences(found, expected, self.remake.tolerance):
                self.report.add(self.folder / name, f"image {im_id}: {_who(where)} {what}")
        pictures = set(self.made.pictures)
        for made in sorted(self.made.folder.glob(f"*/{im_id:06d}*")):
            path = self.folder / made.relative_to(self.made.folder)
            folder = made.parent.name
            if folder.startswith(".") or not path.is_file():
                continue  # reported by the comparison of folder and labels
            if folder in pictures:
                self.colour.compare(path, sample, folder)
            elif self.colour.holds(folder) and path.read_bytes() != made.read_bytes():
                self._label_file(path, made)
            made.unlink()

    def _label_file(self, path: Path, made: Path) -> None:
        """Says how a picture that is a label differs."""
        try:
            found, expected = _pixels(path), _pixels(made)
        except (OSError, ValueError, PngError):
            return  # reported when it was read
        if found.shape != expected.shape or found.dtype != expected.dtype:
            text = f"is {_kind(found)}, must be {_kind(expected)}"
            self.report.add(path, text)
            return
        if expected.dtype.names is not None:
            self.report.add(path, "differs from the table of the frame made again")
            return
        text_or_none = label_difference(found, expected, self.remake.tolerance)
        if text_or_none:
            self.report.add(path, text_or_none)


def _who(where: str) -> str:
    """[2].cam_t_m2c -> instance 2: cam_t_m2c."""
    if where.startswith("["):
        number, _, key = where[1:].partition("]")
        return f"instance {number}: {key.lstrip('.')}".rstrip()
    return where


def _load(path: Path) -> dict[str, Any]:
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}  # reported when it was read
    return value if isinstance(value, dict) else {}


def _annotations(coco: Mapping[str, Any]) -> dict[str, Any]:
    """Image id -> its annotations, without their ids."""
    found: dict[str, Any] = {str(image["id"]): [] for image in coco.get("images", [])}
    for entry in coco.get("annotations", []):
        own = {key: value for key, value in entry.items() if key != "id"}
        found.setdefault(str(own.get("image_id")), []).append(own)
    return found


def _pixels(path: Path) -> NDArray[Any]:
    if path.suffix == ".npy":
        return np.asarray(np.load(path, allow_pickle=False))
    return read_png(path)


def _kind(array: NDArray[Any]) -> str:
    return f"{' x '.join(map(str, array.shape))} of {array.dtype}"


def label_difference(
    found: NDArray[Any], expected: NDArray[Any], tolerance: Tolerance
) -> str | None:
    """Difference of two label pictures of the same shape; None if they are equal."""
    same = (found == expected) | ((found != found) & (expected != expected))
    other = ~(same if same.ndim == 2 else same.reshape(*same.shape[:2], -1).all(axis=2))
    count = int(np.count_nonzero(other))
    lit = int(np.count_nonzero(expected)) if expected.dtype == np.uint8 else expected.size
    if count <= tolerance.pixels_of(lit) * (count > 0):
        return None
    rows, columns = np.nonzero(other)
    column, row = int(columns[0]), int(rows[0])
    return (
        f"{count} of {other.size} pixels differ from what the configuration makes, the first at "
        f"column {column}, row {row}: {found[row, column]}, must be {expected[row, column]}"
    )
