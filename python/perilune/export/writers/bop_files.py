"""The files of a BOP scene folder: names, number formats, progress.

Layout and number formats follow the BOP toolkit's format document: millimetres, ids with six digits
in paths and without padding in JSON, 16-bit depth with one scale per image."""

from __future__ import annotations

import json
import shutil
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.export.writers.bop_labels import CocoHeader
from perilune.export.writers.files import (
    PARTIAL,
    TEMPORARY,
    json_by_id,
    json_sections,
    load_object,
    names_in,
    remove_temporary,
    sync_files,
    sync_folder,
    write_text,
)
from perilune.export.writers.whole import is_whole

MM_PER_M = 1000.0
LARGEST_DEPTH = 65534
"""Largest depth value written; readers take 65535 for saturation."""
SMALLEST_EXPONENT = -3
"""Exponent of the finest depth scale, 10^-3 mm."""

CAMERA_FILE = "scene_camera.json"
GT_FILE = "scene_gt.json"
INFO_FILE = "scene_gt_info.json"
COCO_FILE = "scene_gt_coco.json"
FRAMES_FILE = "scene_frames.json"
"""What is known of each image beyond BOP: camera and metadata, as in the records of other
formats."""
KEYPOINTS_FILE = "scene_keypoints.json"
"""Rows of Sample.keypoints of each image, if they are asked for."""
RGB_FOLDER = "rgb"
LABEL_FOLDERS = ("depth", "mask", "mask_visib")


def depth_scale_mm(z_max_mm: float) -> float:
    """Smallest of 1, 2, 5 x 10^k (k from -3) with which z_max_mm is at most LARGEST_DEPTH steps."""
    if not np.isfinite(z_max_mm) or z_max_mm < 0.0:
        raise ValueError(f"depth scale: largest depth is {z_max_mm} mm; must be finite")
    exponent = SMALLEST_EXPONENT
    while True:
        for digit in (1, 2, 5):
            scale = float(f"{digit}e{exponent}")
            if z_max_mm / scale <= LARGEST_DEPTH:
                return scale
        exponent += 1


def scale_of(
    depth_m: NDArray[np.floating], instance: NDArray[np.integer], ids: NDArray[Any], crafts: int
) -> float:
    """The depth scale of an image: of the spacecraft that are seen; where there is none, of the
    bodies among the objects; and else of all that is seen.

    ids: of the objects in `instance`; the first `crafts` are spacecraft."""
    for own in (ids[:crafts], ids[crafts:]):
        annotated = np.isin(instance, own)
        if annotated.any():
            return depth_scale_mm(float(depth_m[annotated].max(initial=0.0)) * MM_PER_M)
    return depth_scale_mm(float(depth_m.max(initial=0.0)) * MM_PER_M)


def encode_depth(depth_m: NDArray[np.floating], scale_mm: float) -> NDArray[np.uint16]:
    """Depth in steps of the scale; 0 where there is none, or beyond the last step."""
    steps = np.rint(depth_m.astype(np.float64) * (MM_PER_M / scale_mm))
    steps[~((steps > 0.0) & (steps <= LARGEST_DEPTH))] = 0.0
    return steps.astype(np.uint16)


@dataclass(frozen=True)
class Record:
    """Entries of a scene's JSON files for one image."""

    camera: dict[str, Any]
    gt: list[dict[str, Any]]
    gt_info: list[dict[str, Any]]
    annotations: list[dict[str, Any]]
    """Annotations of the COCO file without their ids, which count through the scene."""
    frame: dict[str, Any]
    keypoints: list[dict[str, Any]] | None = None
    """None: not asked for."""

    @classmethod
    def from_json(cls, value: Mapping[str, Any]) -> Record | None:
        """None if the value is not the `vars` of a record."""
        names = {field.name for field in fields(cls)}
        return cls(**value) if set(value) == names else None


_TABLES = {CAMERA_FILE: "camera", GT_FILE: "gt", INFO_FILE: "gt_info", FRAMES_FILE: "frame"}
"""File of a scene -> the field of a record that is its entry of an image."""


class SceneFolder:
    """A scene folder and its finished images.

    An image is finished if its files exist and the scene's JSON names it, or, while the scene is
    being written, a hidden folder has its record. The record is written after the files."""

    def __init__(
        self,
        folder: Path,
        pictures: Iterable[str] = (RGB_FOLDER,),
        channels: Mapping[str, str] | None = None,
        keypoints: bool = False,
    ) -> None:
        """pictures: folders of the images other than labels. channels: folders of additional
        channels, each with the suffix of its files. keypoints: whether there is a file of them."""
        self.folder = folder
        self.pictures = tuple(pictures)
        self.channels = dict(channels or {})
        self.tables = _TABLES | ({KEYPOINTS_FILE: "keypoints"} if keypoints else {})
        self._partial = folder / PARTIAL

    @property
    def json_files(self) -> tuple[str, ...]:
        """Names of the scene's JSON files."""
        return (*self.tables, COCO_FILE)

    def prepare(self) -> None:
        """Creates the folders, and removes partial files of an interrupted run."""
        for name in (*self.image_folders, PARTIAL):
            directory = self.folder / name
            directory.mkdir(parents=True, exist_ok=True)
            remove_temporary(directory)
        remove_temporary(self.folder)

    @property
    def image_folders(self) -> tuple[str, ...]:
        """All folders of the scene."""
        return (*self.pictures, *LABEL_FOLDERS, *self.channels)

    def picture(self, im_id: int, name: str) -> Path:
        """File of an image other than a label; name: one of `pictures`."""
        return self.folder / name / f"{im_id:06d}.png"

    def channel(self, im_id: int, name: str) -> Path:
        """File of an additional channel; name: one of `channels`."""
        return self.folder / name / f"{im_id:06d}.{self.channels[name]}"

    def depth(self, im_id: int) -> Path:
        return self.folder / "depth" / f"{im_id:06d}.png"

    def mask(self, im_id: int, gt_id: int) -> Path:
        """File of the whole silhouette, as if nothing hid it."""
        return self.folder / "mask" / f"{im_id:06d}_{gt_id:06d}.png"

    def mask_visib(self, im_id: int, gt_id: int) -> Path:
        return self.folder / "mask_visib" / f"{im_id:06d}_{gt_id:06d}.png"

    def listed(self) -> dict[int, Record]:
        """Images that all JSON files of the scene name; none if one of these files is damaged."""
        coco = load_object(self.folder / COCO_FILE)
        tables = {key: load_object(self.folder / name) for name, key in self.tables.items()}
        try:
            annotations: dict[str, list[dict[str, Any]]] = {
                str(image["id"]): [] for image in coco.get("images", [])
            }
            for entry in coco.get("annotations", []):
                own = {key: value for key, value in entry.items() if key != "id"}
                annotations[str(entry["image_id"])].append(own)
            return {
                int(key): Record(
                    annotations=entries, **{name: table[key] for name, table in tables.items()}
                )
                for key, entries in annotations.items()
                if all(key in table for table in tables.values())
            }
        except (KeyError, TypeError, ValueError, AttributeError):
            return {}

    def finished(self, known: Collection[int] | None = None) -> dict[int, Record]:
        """Images that need not be rendered again: listed, and with all their files intact.

        known: images known to be finished, whose files are not read again."""
        records = self.listed()
        for path in sorted(self._partial.glob("*.json")):
            record = Record.from_json(load_object(path))
            if record is not None:
                records[int(path.stem)] = record
        return {
            im_id: record
            for im_id, record in records.items()
            if (im_id in known if known is not None else self._is_whole(im_id, record))
        }

    def _is_whole(self, im_id: int, record: Record) -> bool:
        return all(is_whole(self.folder / name) for name in self.files_of(im_id, len(record.gt)))

    def files_of(self, im_id: int, instances: int) -> set[str]:
        """The image files of one image, relative to the folder."""
        paths = [*(self.picture(im_id, name) for name in self.pictures), self.depth(im_id)]
        paths += [self.channel(im_id, name) for name in self.channels]
        for gt_id in range(instances):
            paths += [self.mask(im_id, gt_id), self.mask_visib(im_id, gt_id)]
        return {path.relative_to(self.folder).as_posix() for path in paths}

    def is_complete(self) -> bool:
        """Whether no part of the scene is still being written."""
        return not (self._partial.exists() or self._has_temporary()) and all(
            (self.folder / name).is_file() for name in self.json_files
        )

    def _has_temporary(self) -> bool:
        """Whether a killed run has left partial files."""
        folders = [self.folder, *(self.folder / name for name in self.image_folders)]
        return any(name.endswith(TEMPORARY) for folder in folders for name in names_in(folder))

    def keep(self, im_id: int, record: Record) -> None:
        """Records that the files of an image are complete, once they are on the disk."""
        sync_files(self.folder / name for name in sorted(self.files_of(im_id, len(record.gt))))
        text = json.dumps(vars(record), sort_keys=True, allow_nan=False)
        # The note itself may be lost with the power: then the image is made again.
        write_text(self._partial / f"{im_id:06d}.json", text, sync=False)

    def complete(self, records: Mapping[int, Record], header: CocoHeader) -> None:
        """Writes the scene's JSON files, the last step, after which the records are not needed.

        Calling it again finishes an interrupted call."""
        for name, key in self.tables.items():
            table = {im_id: getattr(record, key) for im_id, record in records.items()}
            write_text(self.folder / name, json_by_id(table))
        coco = header.file({im_id: record.annotations for im_id, record in records.items()})
        write_text(self.folder / COCO_FILE, json_sections(coco))
        for name in ("", *self.image_folders):
            sync_folder(self.folder / name)
        shutil.rmtree(self._partial)
