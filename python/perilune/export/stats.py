"""Distributions over the labels of a written dataset, per object."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from perilune.export.writers.bop_files import CAMERA_FILE, MM_PER_M
from perilune.export.writers.bop_finish import Instances, images_of, scene_folders
from perilune.export.writers.files import SOURCE_FILE, load_object
from perilune.export.writers.formats.opened import FORMAT_KEY
from perilune.export.writers.formats.record import records

QUANTILES = (0.0, 0.25, 0.5, 0.75, 1.0)

_Columns = dict[str, list[float]]


def _measure(instances: Instances, objects: dict[int, _Columns]) -> None:
    for gt, info in instances:
        t_m = np.array(gt["cam_t_m2c"]) / MM_PER_M
        off_axis = np.degrees(np.arctan2(np.hypot(t_m[0], t_m[1]), t_m[2]))
        width, height = info["bbox_visib"][2:]
        seen = info["px_count_visib"] > 0
        values = {
            "distance_m": float(np.linalg.norm(t_m)),
            "off_axis_deg": float(off_axis),
            "visib_fract": info["visib_fract"],
            "visible_px": info["px_count_visib"],
            "box_width_px": width + 1 if seen else 0,
            "box_height_px": height + 1 if seen else 0,
        }
        columns = objects.setdefault(gt["obj_id"], {name: [] for name in values})
        for name, value in values.items():
            columns[name].append(value)


def _distribution(values: list[float]) -> dict[str, float]:
    levels = np.quantile(values, QUANTILES)
    named = {f"q{round(100 * q)}": float(v) for q, v in zip(QUANTILES, levels, strict=True)}
    return {**named, "mean": float(np.mean(values))}


def _measure_rows(rows: list[dict[str, Any]], objects: dict[int, _Columns]) -> None:
    """The same of the objects in the record of a frame in a folder."""
    instances = []
    for row in rows:
        gt = {"cam_t_m2c": [MM_PER_M * x for x in row["t_m2c"]], "obj_id": row["obj_id"]}
        instances.append((gt, row))
    _measure(instances, objects)


def _rows(objects: dict[int, _Columns]) -> dict[str, Any]:
    rows: dict[str, Any] = {}
    for obj_id, columns in sorted(objects.items()):
        count = len(columns["visible_px"])
        distributions = {name: _distribution(values) for name, values in columns.items()}
        rows[str(obj_id)] = {"instances": count, **distributions}
    return rows


def folder_statistics(root: Path, objects: dict[int, _Columns] | None = None) -> dict[str, Any]:
    """Those of bop_statistics for a dataset in a folder; `scenes` counts the scenes of the
    timeline. Of formats without labels of objects there are no instances."""
    images, scenes = 0, set()
    objects = {} if objects is None else objects
    sensors: dict[str, int] = {}
    for record in records(root):
        images += 1
        scenes.add(record["meta"]["scene"])
        sensor = record["camera"]["sensor"]
        if sensor is not None:
            sensors[sensor] = sensors.get(sensor, 0) + 1
        _measure_rows(record.get("objects", []), objects)
    rows = _rows(objects)
    return {
        "scenes": len(scenes),
        "images": images,
        "instances": sum(row["instances"] for row in rows.values()),
        "objects": rows,
        **({"sensors": sensors} if sensors else {}),
    }


def statistics(folder: str | Path) -> dict[str, Any]:
    """Statistics of a dataset of any format."""
    return measured(folder)[0]


def measured(folder: str | Path) -> tuple[dict[str, Any], dict[int, dict[str, list[float]]]]:
    """Statistics of a dataset of any format, and what they are of: object id -> quantity -> a
    value an instance."""
    root = Path(folder)
    objects: dict[int, _Columns] = {}
    known = FORMAT_KEY in load_object(root / SOURCE_FILE)
    found = (folder_statistics if known else bop_statistics)(root, objects)
    return found, dict(sorted(objects.items()))


def bop_statistics(
    folder: str | Path, objects: dict[int, _Columns] | None = None
) -> dict[str, Any]:
    """Counts, and quantiles of each quantity by object id; scenes must be complete.

    With sensors, `sensors` has the number of images of each."""
    root = Path(folder)
    try:
        split = json.loads((root / SOURCE_FILE).read_text(encoding="utf-8"))["split"]
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{root / SOURCE_FILE}: cannot be read ({error})") from error
    scenes, images = scene_folders(root / split), 0
    objects = {} if objects is None else objects
    sensors: dict[str, int] = {}
    for scene in scenes.values():
        for camera in load_object(scene / CAMERA_FILE).values():
            if "sensor" in camera:
                sensors[camera["sensor"]] = sensors.get(camera["sensor"], 0) + 1
        for _, instances in images_of(scene):
            images += 1
            _measure(instances, objects)
    rows = _rows(objects)
    instances = sum(row["instances"] for row in rows.values())
    return {
        "scenes": len(scenes),
        "images": images,
        "instances": instances,
        "objects": rows,
        **({"sensors": sensors} if sensors else {}),
    }
