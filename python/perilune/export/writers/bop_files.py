"""The files of a BOP scene folder: names, number formats, whole-or-nothing writing, what is done.

Layout and number formats follow the BOP toolkit's format document: millimetres, ids of six digits
in paths and without padding in JSON, 16-bit depth with a scale an image.
"""

from __future__ import annotations

import errno
import json
import os
import shutil
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.export.writers.bop_labels import CocoHeader
from perilune.export.writers.whole import is_whole

MM_PER_M = 1000.0
LARGEST_DEPTH = 65534
"""Largest depth value written; 65535 is left out because readers take it for saturation."""
SMALLEST_EXPONENT = -3
"""Finest depth scale is 10^-3 mm."""

CAMERA_FILE = "scene_camera.json"
GT_FILE = "scene_gt.json"
INFO_FILE = "scene_gt_info.json"
COCO_FILE = "scene_gt_coco.json"
SCENE_FILES = (CAMERA_FILE, GT_FILE, INFO_FILE, COCO_FILE)
RGB_FOLDER = "rgb"
PNG_LEVEL = 6
LABEL_FOLDERS = ("depth", "mask", "mask_visib")
TEMPORARY = ".tmp"
"""Suffix of files that are being written."""
PARTIAL = ".partial"
"""Hidden folder of a scene that is being written."""


def make_folder(folder: str | Path) -> None:
    """Makes a folder that files can be written to; OSError that names it otherwise."""
    path = Path(folder)
    try:
        path.mkdir(parents=True, exist_ok=True)
        # Only a file tells: permissions, read-only mounts and quotas have no common question.
        probe = path / f".writable.{os.getpid()}.tmp"
        probe.write_bytes(b"")
        probe.unlink()
    except OSError as error:
        reason = "a file stands there" if isinstance(error, FileExistsError) else error.strerror
        raise OSError(error.errno, f"cannot be written to: {reason}", str(path)) from error


def write_bytes(path: Path, parts: Iterable[bytes | memoryview], sync: bool = True) -> None:
    """Writes a file through a temporary one and a rename: it is whole or not there.

    sync: its content is on the disk before it gets its name, whatever happens to the power."""
    temporary = path.with_name(f"{path.name}.{os.getpid()}{TEMPORARY}")
    try:
        with open(temporary, "wb") as file:
            for part in parts:
                file.write(part)
            file.flush()
            if sync:
                os.fsync(file.fileno())
        os.replace(temporary, path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise OSError(error.errno, f"cannot be written: {error.strerror}", str(path)) from error
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def write_text(path: Path, text: str, sync: bool = True) -> None:
    """The same for text."""
    write_bytes(path, [text.encode("utf-8")], sync)


def write_other_text(path: Path, text: str) -> None:
    """The same, unless the file holds that very text already."""
    try:
        if path.read_bytes() == text.encode("utf-8"):
            return
    except FileNotFoundError:
        pass
    write_text(path, text)


def sync_folder(folder: Path) -> None:
    """Brings the names of a folder's files to the disk."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno != errno.EINVAL:  # some network disks have nothing to bring
            raise
    finally:
        os.close(descriptor)


def sync_files(paths: Iterable[Path]) -> None:
    """Brings the content of files that are written to the disk."""
    for path in paths:
        with open(path, "rb") as file:
            os.fsync(file.fileno())


def remove_temporary(folder: Path) -> None:
    """Removes what killed runs have left half written. Only who holds the folder's lock may."""
    for name in _names(folder):
        if name.endswith(TEMPORARY):
            (folder / name).unlink(missing_ok=True)


def json_text(value: Any) -> str:
    """Sorted keys; Python's shortest digits that give the same double back."""
    return json.dumps(value, indent=2, sort_keys=True, allow_nan=False) + "\n"


def json_by_id(entries: Mapping[int, Any]) -> str:
    """An object keyed by ids in the order of numbers, one entry a line."""
    lines = [
        f'  "{key}": {json.dumps(entries[key], sort_keys=True, allow_nan=False)}'
        for key in sorted(entries)
    ]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def json_rows(rows: Iterable[Any]) -> str:
    """A list, one entry a line."""
    lines = [f"  {json.dumps(row, sort_keys=True, allow_nan=False)}" for row in rows]
    return "[\n" + ",\n".join(lines) + "\n]" if lines else "[]"


def json_sections(sections: Mapping[str, Any]) -> str:
    """An object of lists and of small values, every entry of a list on its own line."""
    lines = []
    for name in sorted(sections):
        value = sections[name]
        text = json_rows(value) if isinstance(value, list) else json.dumps(value, sort_keys=True)
        lines.append(f"{json.dumps(name)}: {text}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def depth_scale_mm(z_max_mm: float) -> float:
    """Smallest of 1, 2, 5 x 10^k (k from -3) that brings z_max_mm into LARGEST_DEPTH steps."""
    if not np.isfinite(z_max_mm) or z_max_mm < 0.0:
        raise ValueError(f"depth scale: largest depth is {z_max_mm} mm; must be finite")
    exponent = SMALLEST_EXPONENT
    while True:
        for digit in (1, 2, 5):
            scale = float(f"{digit}e{exponent}")
            if z_max_mm / scale <= LARGEST_DEPTH:
                return scale
        exponent += 1


def encode_depth(depth_m: NDArray[np.floating], scale_mm: float) -> NDArray[np.uint16]:
    """Depth in steps of the scale; 0 where there is none or where it lies beyond the last step."""
    steps = np.rint(depth_m.astype(np.float64) * (MM_PER_M / scale_mm))
    steps[~((steps > 0.0) & (steps <= LARGEST_DEPTH))] = 0.0
    return steps.astype(np.uint16)


@dataclass(frozen=True)
class Record:
    """What the JSON files of a scene say of one image."""

    camera: dict[str, Any]
    gt: list[dict[str, Any]]
    gt_info: list[dict[str, Any]]
    annotations: list[dict[str, Any]]
    """Of the COCO file, without their ids, which count through the scene."""

    @classmethod
    def from_json(cls, value: Mapping[str, Any]) -> Record | None:
        """None if the value is not what `vars` of a record gives."""
        names = {field.name for field in fields(cls)}
        return cls(**value) if set(value) == names else None


def load_object(path: Path) -> dict[str, Any]:
    """A JSON object, or an empty one if the file is absent or broken: then it is made again."""
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except (FileNotFoundError, json.JSONDecodeError, UnicodeDecodeError):
        return {}
    return value if isinstance(value, dict) else {}


class SceneFolder:
    """One scene folder, and which of its images are finished.

    An image is finished when its files are there and the scene's JSON names it, or, while the scene
    is being written, a record of it lies in a hidden folder. The record is written after the files.
    """

    def __init__(
        self,
        folder: Path,
        pictures: Iterable[str] = (RGB_FOLDER,),
        channels: Mapping[str, str] | None = None,
    ) -> None:
        """pictures: the folders of the images that are no labels. channels: the folders of what is
        written beside BOP, each with the suffix of its files."""
        self.folder = folder
        self.pictures = tuple(pictures)
        self.channels = dict(channels or {})
        self._partial = folder / PARTIAL

    def prepare(self) -> None:
        """Makes the folders, and removes what an interrupted run left half written."""
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
        """An image that is no label; name: one of `pictures`."""
        return self.folder / name / f"{im_id:06d}.png"

    def channel(self, im_id: int, name: str) -> Path:
        """A file beside BOP; name: one of `channels`."""
        return self.folder / name / f"{im_id:06d}.{self.channels[name]}"

    def depth(self, im_id: int) -> Path:
        return self.folder / "depth" / f"{im_id:06d}.png"

    def mask(self, im_id: int, gt_id: int) -> Path:
        """The whole silhouette, as if nothing hid it."""
        return self.folder / "mask" / f"{im_id:06d}_{gt_id:06d}.png"

    def mask_visib(self, im_id: int, gt_id: int) -> Path:
        return self.folder / "mask_visib" / f"{im_id:06d}_{gt_id:06d}.png"

    def listed(self) -> dict[int, Record]:
        """Images that all JSON files of the scene name; none if one of the files is damaged."""
        cameras, gts, infos, coco = (load_object(self.folder / name) for name in SCENE_FILES)
        try:
            annotations: dict[str, list[dict[str, Any]]] = {
                str(image["id"]): [] for image in coco.get("images", [])
            }
            for entry in coco.get("annotations", []):
                own = {key: value for key, value in entry.items() if key != "id"}
                annotations[str(entry["image_id"])].append(own)
            return {
                int(key): Record(cameras[key], gts[key], infos[key], annotations[key])
                for key in cameras
                if key in gts and key in infos and key in annotations
            }
        except (KeyError, TypeError, ValueError, AttributeError):
            return {}

    def finished(self, known: Collection[int] | None = None) -> dict[int, Record]:
        """Images that need not be rendered again: named, and with all their files whole.

        known: those of which this has been found out before; their files are not read again."""
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
        """True when nothing of the scene is still being written."""
        return not (self._partial.exists() or self._has_temporary()) and all(
            (self.folder / name).is_file() for name in SCENE_FILES
        )

    def _has_temporary(self) -> bool:
        """Whether a killed run has left something half written."""
        folders = [self.folder, *(self.folder / name for name in self.image_folders)]
        return any(name.endswith(TEMPORARY) for folder in folders for name in _names(folder))

    def keep(self, im_id: int, record: Record) -> None:
        """Notes that the files of an image are complete, once they are on the disk."""
        sync_files(self.folder / name for name in sorted(self.files_of(im_id, len(record.gt))))
        text = json.dumps(vars(record), sort_keys=True, allow_nan=False)
        # The note itself may be lost with the power: then the image is made again.
        write_text(self._partial / f"{im_id:06d}.json", text, sync=False)

    def complete(self, records: Mapping[int, Record], header: CocoHeader) -> None:
        """Writes the scene's JSON files, the last step; then the records are not needed.

        Called again, it finishes what a stop has left of this."""
        tables: dict[str, dict[int, Any]] = {
            CAMERA_FILE: {im_id: record.camera for im_id, record in records.items()},
            GT_FILE: {im_id: record.gt for im_id, record in records.items()},
            INFO_FILE: {im_id: record.gt_info for im_id, record in records.items()},
        }
        for name, table in tables.items():
            write_text(self.folder / name, json_by_id(table))
        coco = header.file({im_id: record.annotations for im_id, record in records.items()})
        write_text(self.folder / COCO_FILE, json_sections(coco))
        for name in ("", *self.image_folders):
            sync_folder(self.folder / name)
        shutil.rmtree(self._partial)


def _names(folder: Path) -> list[str]:
    try:
        return os.listdir(folder)
    except FileNotFoundError:
        return []
