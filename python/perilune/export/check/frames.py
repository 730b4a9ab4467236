"""Checks scene_frames.json and scene_keypoints.json of BOP's scene folders against the labels."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import JsonValue

from perilune.export.check.findings import Report
from perilune.export.check.keypoints import keypoint_faults
from perilune.export.check.records import Count, Exact, SceneCamera, Source, by_id, read_json
from perilune.export.writers.bop_files import FRAMES_FILE, KEYPOINTS_FILE, MM_PER_M

_UNIT = 1e-12
_NEEDED = ("seed", "index", "time_utc", "jd_tdb", "sun", "states", "effects")


class FrameEntry(Exact):
    """An entry of scene_frames.json."""

    index: Count
    camera: dict[str, JsonValue]
    meta: dict[str, JsonValue]


class KeypointRow(Exact):
    """A row of an entry of scene_keypoints.json."""

    name: str
    object: str
    instance_id: Count
    xy: list[float | None]
    position_m: list[float]
    visible: Count
    occluded_by: Count


def _camera_faults(told: Mapping[str, Any], camera: SceneCamera) -> Iterator[str]:
    pairs = {
        "K": (np.ravel(told["K"]), camera.cam_K),
        "R_w2c": (np.ravel(told["R_w2c"]), camera.cam_R_w2c),
        "t_w2c": (MM_PER_M * np.array(told["t_w2c"]), camera.cam_t_w2c),
    }
    for name, (found, expected) in pairs.items():
        if np.asarray(found).tolist() != list(expected):
            yield f"camera.{name} is not that of scene_camera.json"
    if told["sensor"] != camera.sensor:
        yield f"camera.sensor is {told['sensor']!r}, scene_camera.json has {camera.sensor!r}"


def _faults(
    entry: FrameEntry, camera: SceneCamera, index: int, size: tuple[int, int]
) -> Iterator[str]:
    told: Any = entry.camera
    if entry.index != index:
        yield f"index is {entry.index}, must be {index}"
    missing = [name for name in _NEEDED if name not in entry.meta]
    if missing:
        yield f"meta lacks {', '.join(missing)}"
    if (told["width"], told["height"]) != size:
        yield f"camera has {told['width']} x {told['height']} pixels, must have {size}"
    yield from _camera_faults(told, camera)
    sun: Any = entry.meta.get("sun")
    if sun is not None and abs(float(np.linalg.norm(sun["direction"])) - 1.0) > _UNIT:
        yield "meta.sun.direction is no unit vector"


def check_frames(
    report: Report,
    folder: Path,
    source: Source,
    cameras: Mapping[str, SceneCamera],
    size: tuple[int, int],
) -> None:
    """Checks both files of a scene, as far as the dataset has them."""
    path = folder / FRAMES_FILE
    entries = read_json(report, path, by_id(FrameEntry))
    points = None
    if source.keypoints is not None:
        points = read_json(report, folder / KEYPOINTS_FILE, by_id(list[KeypointRow]))
    for name, table in ((FRAMES_FILE, entries), (KEYPOINTS_FILE, points)):
        if table is not None and list(table) != list(cameras):
            report.add(folder / name, "has not the images of scene_camera.json, in their order")
            return
    for key, camera in cameras.items():
        if entries is None:
            return
        entry, index = entries[key], int(folder.name) * source.chunk_size + int(key)
        try:
            found = list(_faults(entry, camera, index, size))
        except (KeyError, TypeError, ValueError) as error:
            found = [f"is no record of a frame: {error!r}"]
        for text in found:
            report.add(path, f"image {key}: {text}")
        if points is not None and not found:
            rows = [vars(row) for row in points[key]]
            for text in (*_named(rows, source), *keypoint_faults(rows, entry.camera, entry.meta)):
                report.add(folder / KEYPOINTS_FILE, f"image {key}: {text}")


def _named(rows: list[dict[str, Any]], source: Source) -> Iterator[str]:
    """Whether the rows are those of the names in dataset_info.json."""
    found: dict[str, list[str]] = {}
    for row in rows:
        found.setdefault(row["object"], []).append(row["name"])
    if found != source.keypoints:
        yield "its keypoints are not those that dataset_info.json names, in their order"
