"""What must hold between poses, states, depth, silhouettes and flow of a frame: texts of what does
not, with the object."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import rotations
from perilune.export.writers.formats.base import Info, Record

Array = NDArray[Any]
Arrays = Mapping[str, Array]
F64 = NDArray[np.float64]

_TURN = 1e-9
"""Largest error of a rotation in records."""
_PLACE = 1e-13
"""Largest error of a position, relative to its distance from the root: rounding of doubles."""
_PIXELS = 0.02
"""Largest error of a flow, and of a pixel's centre from a model's box: rounding in single
precision."""
_ROUNDING = 4.0
"""Errors of depths and ranges, in steps of their number type."""
_LEAST_Z = 1e-3
"""Of the unit direction of a pixel whose depth tells where the ray ends."""


def counted(mask: Array) -> str:
    """Number of pixels, and the first one."""
    y, x = np.argwhere(mask)[0][:2].tolist()
    return f"{np.count_nonzero(mask)} pixels, the first at column {x}, row {y}"


def _optics(camera: Mapping[str, Any]) -> tuple[F64, tuple[str, F64] | None]:
    """K, and model and coefficients of the lens."""
    lens = camera["lens"]
    told = None if lens is None else (lens["model"], np.array(lens["coefficients"], np.float64))
    return np.array(camera["K"], dtype=np.float64), told


def project(camera: Mapping[str, Any], points: F64) -> F64:
    """Pixels (n, 2) of points (n, 3) in camera axes, m. camera: of a frame's record."""
    return _core.project(*_optics(camera), np.ascontiguousarray(points))


def _held(metres: Array) -> Array:
    """Where a length is what it says: in half precision the largest stands for all beyond."""
    if metres.dtype == np.float16:
        return np.asarray(metres < np.finfo(np.float16).max)
    return np.ones(metres.shape, dtype=bool)


@dataclass(frozen=True)
class View:
    """The camera of a frame, and what its pixels see."""

    camera: Mapping[str, Any]
    rays: F64
    """(H, W, 3): directions of pixels with z = 1; nan where the lens has none, and aside and
    behind."""

    @classmethod
    def of(cls, camera: Mapping[str, Any]) -> View:
        """The view of a record's camera."""
        y, x = np.mgrid[: camera["height"], : camera["width"]].astype(np.float64)
        pixels = np.stack([x.ravel(), y.ravel()], axis=1)
        directions = _core.unproject(*_optics(camera), pixels).reshape(*x.shape, 3)
        z = directions[:, :, 2:]
        rays = directions / np.where(z > _LEAST_Z, z, np.nan)
        return cls(camera, rays)

    def points(self, depth: Array, error: float = 0.0) -> F64:
        """(H, W, 3): the points that pixels see, camera axes, m; nan where there is none. error:
        added to the depths."""
        known = depth > 0
        known &= _held(depth)
        z = np.where(known, depth.astype(np.float64) + error, np.nan)
        return self.rays * z[:, :, None]


def _step(array: Array, record: Record, name: str) -> float:
    """Largest absolute error of a channel of lengths, m."""
    steps = (record.get("labels") or {}) if isinstance(record.get("labels"), dict) else {}
    if name in steps.get("metres_per_step", {}):
        return float(steps["metres_per_step"][name])
    known = array[np.isfinite(array)]
    return _ROUNDING * float(np.finfo(array.dtype).eps) * float(known.max(initial=0.0))


def pose_faults(record: Record) -> Iterator[str]:
    """Poses of spacecraft must be those of the states, seen by the camera."""
    camera, states = record["camera"], record["meta"].get("states", {})
    R_w2c = np.array(camera["R_w2c"], dtype=np.float64)
    t_w2c = np.array(camera["t_w2c"], dtype=np.float64)
    for row in record.get("objects", ()):
        state = states.get(row["name"])
        if state is None:
            continue
        place = np.array(state["position_m"], dtype=np.float64)
        t = R_w2c @ place + t_w2c
        slack = _PLACE * (1e4 + float(np.linalg.norm(place)))
        if np.abs(t - row["t_m2c"]).max() > slack:
            away = float(np.abs(t - row["t_m2c"]).max())
            yield f"object '{row['name']}': t_m2c is {away:.3g} m away from its state"
        R = R_w2c @ rotations.to_matrix(np.array(state["q_wxyz"], dtype=np.float64))
        if np.abs(R - row["R_m2c"]).max() > _TURN:
            yield f"object '{row['name']}': R_m2c is not the attitude of its state"


def _lengths(arrays: Arrays, record: Record, view: View) -> Iterator[str]:
    """Range, position and object coordinates are those of the depth."""
    if "depth" not in arrays:
        return
    points = view.points(arrays["depth"])
    slack = _step(arrays["depth"], record, "depth") * np.linalg.norm(view.rays, axis=2)
    if "range" in arrays:
        away = np.abs(np.linalg.norm(points, axis=2) - arrays["range"])
        wrong = (away > slack + _step(arrays["range"], record, "range")) & _held(arrays["range"])
        if wrong.any():
            yield f"range is not the distance of what depth tells at {counted(wrong)}"
    # Under a rolling shutter each row has a camera of its own.
    still = not record["meta"].get("rows")
    if still and "position" in arrays and arrays["position"].dtype == np.float64:
        camera = record["camera"]
        seen = arrays["position"] @ np.array(camera["R_w2c"]).T + np.array(camera["t_w2c"])
        size = np.linalg.norm(arrays["position"], axis=2)
        wrong = np.linalg.norm(seen - points, axis=2) > 2.0 * slack + _PLACE * (1e4 + size)
        if wrong.any():
            yield f"position is not where depth tells at {counted(wrong)}"


def _corners(info: Info, record: Record, name: str) -> F64 | None:
    """(8 n, 3): corners of boxes that hold an object in its frame, at rest and moved; None if its
    size is not known."""
    rows = {row["name"]: row for row in info["taxonomy"]["instances"]}
    bounds = rows.get(name, {}).get("box_m")
    if bounds is None:
        return None
    corners = np.array(np.meshgrid(*np.transpose(bounds), indexing="ij")).reshape(3, -1).T
    found = [corners]
    for node in record["meta"].get("articulation", {}).get(name, {}).values():
        motion = np.array(node["motion"], dtype=np.float64)
        found.append(corners @ motion[:3, :3].T + motion[:3, 3])
    return np.concatenate(found)


def _outside_of_box(rays: F64, R: F64, t: F64, low: F64, high: F64) -> NDArray[np.bool_]:
    """Which rays (n, 3) from the camera miss a box in an object's frame (slab test)."""
    origin, along = -R.T @ t, rays @ R
    with np.errstate(divide="ignore", invalid="ignore"):
        first, second = (low - origin) / along, (high - origin) / along
    near = np.nanmax(np.minimum(first, second), axis=1)
    far = np.nanmin(np.maximum(first, second), axis=1)
    return np.asarray((near > far) | (far < 0.0))


def _objects(info: Info, arrays: Arrays, record: Record, view: View) -> Iterator[str]:
    """Silhouettes and depths of spacecraft lie on their models' boxes, placed by their poses."""
    if record["meta"].get("rows") or "instance" not in arrays:
        return  # under a rolling shutter each row has a pose of its own
    points = view.points(arrays["depth"]) if "depth" in arrays else None
    focal = float(np.array(record["camera"]["K"])[0][0])
    for k, row in enumerate(record.get("objects", ())):
        corners = _corners(info, record, row["name"])
        if corners is None:
            continue
        R, t = np.array(row["R_m2c"], dtype=np.float64), np.array(row["t_m2c"], dtype=np.float64)
        low, high = corners.min(axis=0), corners.max(axis=0)
        room = float(np.linalg.norm(t)) * (_PIXELS / focal) + 1e-5 * float(np.ptp(corners))
        seen = arrays["instance"] == row["instance_id"]
        masks = {"it": seen}
        if "masks" in arrays and k < len(arrays["masks"]):
            masks["its mask"] = arrays["masks"][k] != 0
        for what, mask in masks.items():
            at = np.argwhere(mask & np.isfinite(view.rays).all(axis=2))
            rays = view.rays[at[:, 0], at[:, 1]]
            off = _outside_of_box(rays, R, t, low - room, high + room) if len(at) else np.zeros(0)
            if off.any():
                y, x = at[np.flatnonzero(off)[0]].tolist()
                told = f"{np.count_nonzero(off)} pixels, the first at column {x}, row {y}"
                yield f"object '{row['name']}': {what} is seen beside its model's box at {told}"
        if points is not None:
            slack = 2.0 * _step(arrays["depth"], record, "depth") + room
            local = (points - t) @ R
            far = np.maximum(low - local, local - high).max(axis=2)
            wrong = seen & (far > slack * np.linalg.norm(view.rays, axis=2))
            if wrong.any():
                yield (
                    f"object '{row['name']}': depth lies up to {float(far[wrong].max()):.3g} m "
                    f"outside of its model's box at {counted(wrong)}"
                )


def _moved(name: str, record: Record, other: Record, points: F64, articulated: bool) -> F64 | None:
    """Points (n, 3) of an object in the axes of the other frame's camera; None if it is unknown or
    has parts that move."""
    mine, then = record["meta"]["states"].get(name), other["meta"]["states"].get(name)
    if mine is None or then is None or articulated:
        return None
    to_root = np.array(record["camera"]["R_w2c"]).T
    root = (points - np.array(record["camera"]["t_w2c"])) @ to_root.T
    R, S = (rotations.to_matrix(np.array(s["q_wxyz"], np.float64)) for s in (mine, then))
    local = (root - np.array(mine["position_m"])) @ R
    placed = local @ S.T + np.array(then["position_m"])
    return np.asarray(
        placed @ np.array(other["camera"]["R_w2c"]).T + np.array(other["camera"]["t_w2c"])
    )


def _flow(
    name: str, info: Info, arrays: Arrays, record: Record, other: Record, view: View
) -> Iterator[str]:
    """Flow is where the other frame sees the points that the depth tells."""
    if not {name, "depth", "instance"} <= set(arrays) or record["meta"].get("rows"):
        return
    error = _step(arrays["depth"], record, "depth")
    y, x = np.mgrid[: view.rays.shape[0], : view.rays.shape[1]]
    for row in info["taxonomy"]["instances"]:
        mask = (arrays["instance"] == row["id"]) & np.isfinite(arrays[name]).all(axis=2)
        mask &= np.isfinite(view.rays).all(axis=2) & (arrays["depth"] > 0)
        if not mask.any():
            continue
        ends = []
        for off in (0.0, error):
            points = view.points(arrays["depth"], off)[mask]
            articulated = bool(record["meta"].get("articulation", {}).get(row["name"]))
            placed = _moved(row["name"], record, other, points, articulated)
            if placed is None:
                break
            ends.append(project(other["camera"], placed))
        if len(ends) < 2:
            continue
        found = np.stack([x[mask], y[mask]], axis=1) + arrays[name][mask]
        away = np.linalg.norm(found - ends[0], axis=1)
        room = 2.0 * np.linalg.norm(ends[1] - ends[0], axis=1)
        step = 1.0 / 64.0 if arrays[name].dtype == np.float64 else 0.0  # as KITTI rounds it
        eps = np.finfo(arrays[name].dtype).eps * np.abs(arrays[name][mask]).max()
        off_by = away > _PIXELS + room + step + _ROUNDING * eps
        if off_by.any():
            wrong = np.zeros(mask.shape, dtype=bool)
            wrong[mask] = off_by
            yield (
                f"object '{row['name']}': {name} is up to {float(away[off_by].max()):.3g} pixels "
                f"from where depth and motion lead, at {counted(wrong)}"
            )


Beside = Callable[[int], Record | None]
"""The record of the same camera in the same scene, some steps later; None if there is none."""


def geometry_faults(info: Info, record: Record, arrays: Arrays, beside: Beside) -> Iterator[str]:
    """All of these faults of a frame. Arrays must have the frame's size."""
    yield from pose_faults(record)
    if not {"depth", "instance"} & set(arrays):
        return
    view = View.of(record["camera"])
    yield from _lengths(arrays, record, view)
    yield from _objects(info, arrays, record, view)
    for name, steps in (("flow", 1), ("flow_backward", -1)):
        other = beside(steps)
        if name in arrays and other is not None:
            yield from _flow(name, info, arrays, record, other, view)
