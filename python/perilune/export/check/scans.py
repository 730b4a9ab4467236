"""What must hold of the measurements of a frame, render.scans: texts of what does not."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.export.check.geometry import project
from perilune.export.writers.formats.base import Info, Record
from perilune.export.writers.scans import EVENTS, FLIGHT, POINTS, is_scan

Array = NDArray[Any]

_NEAR = 1e-6
"""Largest error of places and lengths of directions, relative; in single precision."""
_DOUBLE = 1e-12
"""The same of places in double precision."""
_PIXELS = 0.02
_UNIT = 1e-5
"""Of normals that are interpolated in single precision."""


def _rows(wrong: Array) -> str:
    """Number of rows, and the first one."""
    return f"{np.count_nonzero(wrong)} rows, the first is {int(np.flatnonzero(wrong)[0])}"


def _finite(name: str, table: Array) -> Iterator[str]:
    for field in table.dtype.names or ():
        column = table[field].reshape(len(table), -1) if len(table) else table[field]
        if column.dtype.kind == "f" and not np.isfinite(column).all():
            yield f"{name}: {field} is not finite in {_rows(~np.isfinite(column).all(axis=1))}"


def _ids(table: Array, info: Info) -> Iterator[tuple[str, Array, list[int]]]:
    """Title, ids and those that have a name: of the tables, and of semantic as PLY has it."""
    names, known = table.dtype.names or (), info["taxonomy"]
    if "instance" in names:
        yield "instance", table["instance"], [row["id"] for row in known["instances"]]
    if "part" in names:
        yield "part", table["part"], [row["id"] for row in known["parts"]]
    for k, (level, classes) in enumerate(known["classes"].items()):
        ids = [0, *classes.values()]
        if f"semantic_{level}" in names:
            yield f"semantic_{level}", table[f"semantic_{level}"], ids
        elif "semantic" in names:
            yield f"semantic of level {level}", table["semantic"][:, k], ids


def _named(name: str, table: Array, info: Info) -> Iterator[str]:
    for title, values, known in _ids(table, info):
        if (wrong := ~np.isin(values, known)).any():
            yield f"{name}: {title} has ids without a name in {_rows(wrong)}"


def _units(name: str, table: Array) -> Iterator[str]:
    """Normals of points; where a table has none, they are not looked at."""
    names = table.dtype.names or ()
    if "normal" in names:
        normal = table["normal"].astype(np.float64)
    elif "nx" in names:
        normal = np.stack([table[axis].astype(np.float64) for axis in ("nx", "ny", "nz")], axis=1)
    else:
        return
    if (wrong := np.abs(np.linalg.norm(normal, axis=1) - 1.0) > _UNIT).any():
        yield f"{name}: normal is no unit vector in {_rows(wrong)}"


def _returns(name: str, table: Array) -> Iterator[str]:
    """Returns of a LiDAR."""
    if "sensor_direction" in (table.dtype.names or ()):
        size = np.linalg.norm(table["sensor_direction"].astype(np.float64), axis=1)
        if (wrong := np.abs(size - 1.0) > _NEAR).any():
            yield f"{name}: sensor_direction is no unit vector in {_rows(wrong)}"
        ends = table["origin_m"] + table["range_m"][:, None] * table["direction"]
        away = np.linalg.norm(ends - table["position_m"], axis=1)
        size = np.linalg.norm(table["position_m"], axis=1) + table["range_m"]
        if (wrong := away > _DOUBLE * (1e4 + size)).any():
            yield f"{name}: position_m is not at the end of its beam in {_rows(wrong)}"
    else:  # as PLY has it
        place = np.stack([table[axis].astype(np.float64) for axis in "xyz"], axis=1)
        away = np.abs(np.linalg.norm(place, axis=1) - table["range_m"])
        if (wrong := away > _NEAR * (1.0 + table["range_m"])).any():
            yield f"{name}: x, y, z are not range_m away in {_rows(wrong)}"
    if (wrong := table["return_number"] > table["return_count"]).any():
        yield f"{name}: return_number is above return_count in {_rows(wrong)}"
    if (np.diff(table["beam"]) < 0).any():
        yield f"{name}: its rows are not in the order of beams"


def _points(name: str, table: Array, record: Record) -> Iterator[str]:
    """Points of pixels: those that the camera sees there."""
    names = table.dtype.names or ()
    if "camera_m" in names:
        place = np.ascontiguousarray(table["camera_m"])
    else:
        place = np.stack([table[axis].astype(np.float64) for axis in "xyz"], axis=1)
    away = np.abs(np.linalg.norm(place, axis=1) - table["range_m"])
    if (wrong := away > _NEAR * (1.0 + table["range_m"])).any():
        yield f"{name}: range_m is not the distance of the point in {_rows(wrong)}"
    seen = project(record["camera"], place)
    off = np.abs(seen - np.stack([table["u"], table["v"]], axis=1)).max(axis=1, initial=0.0)
    if (wrong := off > _PIXELS).any():
        yield f"{name}: the camera does not see the point at u, v in {_rows(wrong)}"


def _events(name: str, table: Array, record: Record) -> Iterator[str]:
    size = (record["camera"]["width"], record["camera"]["height"])
    if (np.diff(table["t_us"]) < 0.0).any():
        yield f"{name}: its rows are not in the order of time"
    if (wrong := (table["x"] >= size[0]) | (table["y"] >= size[1])).any():
        yield f"{name}: x, y lie outside of the picture in {_rows(wrong)}"
    if (wrong := ~np.isin(table["polarity"], (-1, 1))).any():
        yield f"{name}: polarity is neither 1 nor -1 in {_rows(wrong)}"


def _flight(name: str, table: Array, record: Record) -> Iterator[str]:
    size = (record["camera"]["height"], record["camera"]["width"])
    if table.shape != size:
        yield f"{name} has {table.shape} pixels, must have {size}"
        return
    for field in ("range_m", "true_range_m"):
        if np.isinf(table[field]).any() or (table[field] < 0.0).any():
            yield f"{name}: {field} is infinite or below 0"


def scan_faults(info: Info, record: Record, arrays: Mapping[str, Array]) -> Iterator[str]:
    """Faults of all tables of measurements among the channels of a frame."""
    for name in filter(is_scan, arrays):
        table = arrays[name]
        if name == FLIGHT:
            yield from _flight(name, table, record)
            continue
        yield from _finite(name, table)
        yield from _named(name, table, info)
        yield from _units(name, table)
        if name == EVENTS:
            yield from _events(name, table, record)
        elif name == POINTS:
            yield from _points(name, table, record)
        else:
            yield from _returns(name, table)
