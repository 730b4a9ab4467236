"""The record of a frame, `frames/NNNNNN.json`: all that is known of it, and sums of its files.

Keys: camera (K, R_w2c, t_w2c, width, height, lens, sensor), meta (as Sample.meta, without times),
objects (rows of Sample.objects, if rendered), files (path -> bytes, crc32), labels (of the format),
and crc32, which is the sum of the rest. It is written after the frame's files: a frame with a
record that agrees with its files is finished."""

from __future__ import annotations

import json
import math
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from perilune.export.writers.files import write_text
from perilune.sample import Sample

FOLDER = "frames"
_CRC = "crc32"
_NOT_KEPT = ("timings_s",)
"""Keys of metadata that differ from run to run."""


def plain(value: Any) -> Any:
    """A value as JSON has it: arrays as lists, numbers that are not finite as null."""
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(entry) for entry in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value


def _objects(sample: Sample, names: list[str]) -> list[dict[str, Any]]:
    rows = sample.objects
    fields = rows.dtype.names or ()
    columns = {field: np.asarray(rows[field]).tolist() for field in fields}
    return [
        {"name": name, **{field: plain(columns[field][k]) for field in fields}}
        for k, name in enumerate(names)
    ]


def record_of(sample: Sample, names: list[str] | None) -> dict[str, Any]:
    """The record of a sample, without files. names: its objects, in their order; None: without
    objects."""
    camera = sample.camera
    lens = camera.lens
    told: dict[str, Any] = {
        "K": camera.K.tolist(),
        "R_w2c": camera.R_w2c.tolist(),
        "t_w2c": camera.t_w2c.tolist(),
        "width": camera.width,
        "height": camera.height,
        "lens": None if lens is None else {"model": lens[0], "coefficients": plain(lens[1])},
        "sensor": camera.sensor,
    }
    meta = {key: plain(value) for key, value in sample.meta.items() if key not in _NOT_KEPT}
    record: dict[str, Any] = {"index": sample.meta["index"], "camera": told, "meta": meta}
    if names is not None:
        record["objects"] = _objects(sample, names)
    return record


def sums(data: bytes) -> dict[str, int]:
    """Length and CRC-32 of a file."""
    return {"bytes": len(data), _CRC: zlib.crc32(data)}


def _sum(record: Mapping[str, Any]) -> int:
    rest = {key: value for key, value in record.items() if key != _CRC}
    return zlib.crc32(json.dumps(rest, sort_keys=True, allow_nan=False).encode("utf-8"))


def path_of(root: Path, index: int) -> Path:
    """File of a frame's record."""
    return root / FOLDER / f"{index:06d}.json"


def text_of(record: Mapping[str, Any]) -> str:
    """The text of a record's file; a key a line."""
    whole = {**record, _CRC: _sum(record)}
    lines = [
        f"{json.dumps(key)}: {json.dumps(whole[key], sort_keys=True, allow_nan=False)}"
        for key in sorted(whole)
    ]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def write(root: Path, record: Mapping[str, Any]) -> None:
    """Writes a record, atomically."""
    write_text(path_of(root, record["index"]), text_of(record))


def read(path: Path) -> dict[str, Any] | None:
    """A record; None if it is missing or damaged."""
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
        good = value[_CRC] == _sum(value) and f"{value['index']:06d}" == path.stem
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return value if good and isinstance(value.get("files"), dict) else None


def paths(root: Path) -> list[Path]:
    """Files of all records, by index."""
    found = [path for path in (root / FOLDER).glob("*.json") if path.stem.isdecimal()]
    return sorted(found, key=lambda path: int(path.stem))


def records(root: Path) -> Iterator[dict[str, Any]]:
    """All records, by index; ValueError for a damaged one."""
    for path in paths(root):
        record = read(path)
        if record is None:
            raise ValueError(f"{path}: is damaged; render its frame again")
        yield record


def matches(data: bytes, stated: Any) -> bool:
    """Whether a file has the length and sum that its record states."""
    return bool(sums(data) == stated)
