"""What must hold of the arrays of a frame, whatever the format: texts of what does not."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.document.references import KEYPOINTS
from perilune.export.check.geometry import Beside, counted, geometry_faults
from perilune.export.check.keypoints import keypoint_faults
from perilune.export.check.scans import scan_faults
from perilune.export.writers.formats.base import Info, Record
from perilune.export.writers.formats.channels import IMAGE, STACK, TABLE, Channel
from perilune.export.writers.formats.info import channels_of
from perilune.export.writers.formats.segments import Segment, segments

Array = NDArray[Any]
Arrays = Mapping[str, Array]

_SHOWN = 5
_UNIT = 1e-5
"""Largest deviation of a normal's length from 1, in single precision with interpolation."""
_SHARE = 4e-3
"""Largest sum of a pixel's parts beyond 1, in half precision."""
_TURN = 1e-9
"""Largest deviation of a rotation from orthonormal."""


def _shape(name: str, array: Array, channel: Channel, record: Record) -> Iterator[str]:
    size = (record["camera"]["height"], record["camera"]["width"])
    found = array.shape[1:3] if channel.kind == STACK else array.shape[:2]
    if found != size:
        yield f"{name} has {found[1]} x {found[0]} pixels, must have {size[1]} x {size[0]}"


def _finite(name: str, array: Array, channel: Channel) -> Iterator[str]:
    """nan stands for nothing in channels whose description says so."""
    if array.dtype.kind != "f":
        return
    if np.isinf(array).any():
        yield f"{name} is infinite at {counted(np.isinf(array))}"
    if "nan" not in channel.doc and np.isnan(array).any():
        yield f"{name} is nan at {counted(np.isnan(array))}"


def _known_ids(name: str, array: Array, info: Info, channel: Channel) -> Iterator[str]:
    """Every id must have a name; bits must be those that have one."""
    if name not in info.get("labels", {}):
        return
    named = info["labels"][name]
    layers = (
        [(f"{name}/{row['level']}", array[..., k], row["names"]) for k, row in enumerate(named)]
        if name == "semantic"
        else [(name, array, named)]
    )
    for title, values, names in layers:
        ids = np.array(sorted(map(int, names)))
        if channel.unit == "bits":
            wrong = values & ~np.bitwise_or.reduce(ids) != 0
        else:
            wrong = ~np.isin(values, ids)
        if wrong.any():
            unknown = np.unique(values[wrong])[:_SHOWN].tolist()
            yield f"{title} has ids without a name, {unknown}, at {counted(wrong)}"


def _rotation(R: Any, what: str) -> Iterator[str]:
    m = np.array(R, dtype=np.float64).reshape(3, 3)
    if not (np.abs(m @ m.T - np.eye(3)).max() <= _TURN and np.linalg.det(m) > 0.0):
        yield f"{what} is no rotation"


def _object(row: Mapping[str, Any], segment: Segment | None, mask: Array | None) -> Iterator[str]:
    name = f"object '{row['name']}'"
    yield from _rotation(row["R_m2c"], f"{name}: R_m2c")
    count = segment.area if segment is not None else 0
    if row["px_count_visib"] != count:
        yield f"{name}: px_count_visib is {row['px_count_visib']}, instance shows {count} pixels"
    if segment is not None:
        x, y, w, h = segment.box
        stated = [int(value) for value in row["bbox_visib"]]
        if stated != [x, y, w - 1, h - 1]:
            yield f"{name}: bbox_visib is {stated}, its pixels have {[x, y, w - 1, h - 1]}"
    if row["px_count_all"] < row["px_count_visib"]:
        told = f"px_count_all is {row['px_count_all']}, below px_count_visib"
        yield f"{name}: {told}, {row['px_count_visib']}"
    share = row["px_count_visib"] / row["px_count_all"] if row["px_count_all"] else 0.0
    if abs(row["visib_fract"] - share) > 1e-6:
        yield f"{name}: visib_fract is {row['visib_fract']:g}, the counts give {share:g}"
    if mask is not None:
        inside = np.count_nonzero(mask)
        if inside > row["px_count_all"]:
            told = f"its mask has {inside} pixels, px_count_all is {row['px_count_all']}"
            yield f"{name}: {told}"
        if segment is not None and (segment.mask() & (mask == 0)).any():
            outside = segment.mask() & (mask == 0)
            yield f"{name}: is seen outside of its mask, at {counted(outside)}"


def _objects(arrays: Arrays, record: Record) -> Iterator[str]:
    """Boxes bound what is seen, counts are right, and each pixel is of one object."""
    if "objects" not in record or "instance" not in arrays:
        return
    found = segments(arrays["instance"])
    masks = arrays.get("masks")
    for k, row in enumerate(record["objects"]):
        mask = masks[k] if masks is not None and k < len(masks) else None
        yield from _object(row, found.get(row["instance_id"]), mask)
    if masks is not None and len(masks) != len(record["objects"]):
        yield f"masks has {len(masks)} masks for {len(record['objects'])} objects"


def _parts(arrays: Arrays, info: Info) -> Iterator[str]:
    """A part lies on the instance that has it."""
    if "part" not in arrays or "instance" not in arrays:
        return
    taxonomy = info["taxonomy"]
    numbers = {row["name"]: row["id"] for row in taxonomy["instances"]}
    owner = np.zeros(1 + max((row["id"] for row in taxonomy["parts"]), default=0), dtype=np.int64)
    for row in taxonomy["parts"]:
        owner[row["id"]] = numbers[row["owner"]]
    part = np.clip(arrays["part"].astype(np.int64), 0, len(owner) - 1)
    wrong = owner[part] != arrays["instance"]
    if wrong.any():
        yield f"part and instance are of different objects at {counted(wrong)}"


def _coverage(arrays: Arrays, info: Info) -> Iterator[str]:
    """Parts of pixels are sorted, are at most the whole, and belong to known instances."""
    if "coverage" in arrays:
        parts = arrays["coverage"].astype(np.float64)
        total = parts.sum(axis=2)
        wrong = (
            (parts < 0.0).any(axis=2)
            | (total > 1.0 + _SHARE)
            | (np.diff(parts) > 0.0)[..., :-1].any(axis=2)
        )
        if wrong.any():
            yield f"coverage is no parts of a pixel, the largest first, at {counted(wrong)}"
    if "coverage_instance" not in arrays:
        return
    ids = arrays["coverage_instance"]
    known = [-1, 0, *(row["id"] for row in info["taxonomy"]["instances"])]
    wrong = ~np.isin(ids, known).all(axis=2) | (ids[..., :-1] == -1).any(axis=2)
    if wrong.any():
        yield f"coverage_instance has ids of no instance at {counted(wrong)}"
    if "coverage" in arrays:
        wrong = ((arrays["coverage"] > 0.0) != (ids != 0)).any(axis=2)
        if wrong.any():
            yield f"coverage and coverage_instance have other layers at {counted(wrong)}"
    if "instance" in arrays:
        centre = arrays["instance"][..., np.newaxis]
        wrong = ~((ids == centre) | (ids == -1)).any(axis=2) & (centre[..., 0] != 0)
        if wrong.any():
            yield f"instance is in no layer of coverage_instance at {counted(wrong)}"


def _geometry(arrays: Arrays, record: Record) -> Iterator[str]:
    """Depth, range, normals and motion agree with what is hit."""
    hit = arrays["instance"] != 0 if "instance" in arrays else None
    lens = record["camera"]["lens"]
    behind = lens is not None and lens["model"] in ("fisheye", "equirectangular")
    for name in ("depth", "range"):
        if name in arrays:
            if (arrays[name] < 0).any() and not (behind and name == "depth"):
                yield f"{name} is below 0 at {counted(arrays[name] < 0)}"
            if hit is not None and arrays[name][~hit].any():
                wrong = (arrays[name] != 0) & ~hit
                yield f"{name} is not 0 where nothing is hit, at {counted(wrong)}"
    for name in ("normal", "geometric_normal"):
        if name in arrays and arrays[name].dtype == np.float32:
            length = np.linalg.norm(arrays[name].astype(np.float64), axis=2)
            wrong = (length > 0.0) & (np.abs(length - 1.0) > _UNIT)
            if wrong.any():
                yield f"{name} is no unit vector at {counted(wrong)}"
    for name in ("flow", "flow_backward"):
        hidden = name.replace("flow", "flow_occlusion", 1)
        if name in arrays and hidden in arrays:
            wrong = np.isnan(arrays[name]).any(axis=2) & (arrays[hidden] == 0)
            if wrong.any():
                yield f"{hidden} is 0 where {name} is nan, at {counted(wrong)}"


def _texts(table: Array) -> Iterator[dict[str, Any]]:
    """Rows of a table; its texts may be bytes (HDF5)."""
    for row in table:
        values = {name: row[name] for name in table.dtype.names or ()}
        yield {
            name: value.decode("utf-8") if isinstance(value, bytes) else value
            for name, value in values.items()
        }


def faults(
    info: Info, record: Record, arrays: Arrays, beside: Beside = lambda steps: None
) -> Iterator[str]:
    """Everything that is wrong with a frame's channels and its record."""
    yield from _rotation(record["camera"]["R_w2c"], "camera: R_w2c")
    known = channels_of(info)
    shaped = {}
    for name, array in arrays.items():
        channel = known.get(name)
        if channel is None or channel.kind == TABLE:
            continue
        wrong = list(_shape(name, array, channel, record))
        yield from wrong
        yield from _finite(name, array, channel)
        if channel.kind == IMAGE and array.dtype.kind in "iu":
            yield from _known_ids(name, array, info, channel)
        if not wrong:
            shaped[name] = array
    yield from _objects(shaped, record)
    yield from _parts(shaped, info)
    yield from _coverage(shaped, info)
    yield from _geometry(shaped, record)
    yield from geometry_faults(info, record, shaped, beside)
    yield from scan_faults(info, record, arrays)
    if KEYPOINTS in arrays:
        yield from keypoint_faults(_texts(arrays[KEYPOINTS]), record["camera"], record["meta"])
