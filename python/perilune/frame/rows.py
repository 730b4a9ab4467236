"""Poses row by row under a rolling shutter, which the labels of each row refer to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import rotations
from perilune.config import Config
from perilune.frame.shutter import between
from perilune.spacecraft.articulation import Rig, in_object_frame

F64 = NDArray[np.float64]

EFFECT = "rolling_shutter"
_NEAR_PX = 0.01
"""Largest error, in pixels, of linear interpolation between two of the rows."""


def row_poses(
    config: Config,
    request: _core.FrameRequest,
    plan: Sequence[_core.PlanRow],
    rigs: Mapping[str, Rig],
    scales: Mapping[str, float],
) -> list[dict[str, Any]]:
    """Poses of some rows in the middle of their exposure; empty for a global shutter.

    Each entry: row; R_w2c (3, 3), t_w2c (3,) m; objects: spacecraft or annotated body -> {R_m2c (3,
    3), t_m2c (3,) m, articulation: node -> motion (4, 4) as in Sample.meta}. Between two entries,
    interpolate positions linearly and rotations by the shorter arc, in camera axes. The first and
    the last row are included."""
    motion = request["motion"]
    if motion is None or not any(row["name"] == EFFECT and row["on"] for row in plan):
        return []
    exposure_s, line_s, held = motion["times"]
    height = request["height"]
    window_s = exposure_s + line_s * (height - 1)
    rows = _rows(motion["camera"], height, exposure_s, line_s, bool(held), request["K"][0, 0])
    shares = [(row * line_s + 0.5 * exposure_s) / window_s for row in rows]
    return [
        {"row": row, **_entry(config, motion, _key(share, motion, bool(held)), rigs, scales)}
        for row, share in zip(rows, shares, strict=True)
    ]


def _key(share: float, motion: Mapping[str, Any], held: bool) -> float:
    """Position among the keys; that of the nearest key where nothing is known in between."""
    at = min(max(share, 0.0), 1.0) * (len(motion["camera"]) - 1)
    return float(np.floor(at + 0.5)) if held else at


def _rows(
    camera: F64, height: int, exposure_s: float, line_s: float, held: bool, focal_px: float
) -> list[int]:
    """The rows nearest to keys, as many between them as the camera's rotation needs, and both ends.

    If poses are constant between keys: the last row of each key and the first row of the next."""
    steps = len(camera) - 1
    window_s = exposure_s + line_s * (height - 1)
    places = (np.arange(height) * line_s + 0.5 * exposure_s) / window_s * steps
    if held:
        nearest = np.floor(places + 0.5)
        jumps = np.flatnonzero(np.diff(nearest))
        return sorted({0, *jumps.tolist(), *(jumps + 1).tolist(), height - 1})
    turn = max(_turn_rad(camera[k, 3:], camera[k + 1, 3:]) for k in range(steps))
    # The arc is angle^2 / 8 off its chord, of a length of one focal length.
    finer = max(1, int(np.ceil(turn * np.sqrt(abs(focal_px) / (8.0 * _NEAR_PX)))))
    wanted = np.arange(steps * finer + 1) / finer
    wanted = wanted[(wanted > places[0]) & (wanted < places[-1])]
    near = np.rint(np.interp(wanted, places, np.arange(height))).astype(int)
    return sorted({0, *near.tolist(), height - 1})


def _turn_rad(a: F64, b: F64) -> float:
    return rotations.to_axis_angle(rotations.multiply(rotations.conjugate(a), b))[1]


def _at(keys: F64, key: float) -> F64:
    """A pose (7,) at a position among keys (n, 7)."""
    first = min(int(key), len(keys) - 2)
    return between(keys[first : first + 2], key - first)


def _placed(pose: F64, camera: F64, R_w2c: F64) -> dict[str, Any]:
    """A pose (7,) of the root frame in camera axes."""
    return {
        "R_m2c": R_w2c @ rotations.to_matrix(pose[3:]),
        "t_m2c": R_w2c @ (pose[:3] - camera[:3]),
    }


def _entry(
    config: Config,
    motion: Mapping[str, Any],
    key: float,
    rigs: Mapping[str, Rig],
    scales: Mapping[str, float],
) -> dict[str, Any]:
    camera = _at(motion["camera"], key)
    R_w2c = rotations.to_matrix(camera[3:]).T
    first = min(int(key), len(motion["camera"]) - 2)
    movers = motion["movers"]
    now = movers[first] + (key - first) * (movers[first + 1] - movers[first])
    objects, used = {}, 0
    for k, name in enumerate(config.spacecraft):
        pose = _at(motion["objects"][k], key)
        row = _placed(pose, camera, R_w2c)
        if name in rigs:
            rig = rigs[name]
            moved = now[used : used + len(rig.nodes)]
            row["articulation"] = dict(
                zip(rig.nodes, in_object_frame(moved, rig.offset, scales[name]), strict=True)
            )
            used += len(rig.nodes)
        objects[name] = row
    for k, name in enumerate(config.bodies):
        if name in config.objects:
            pose = _at(motion["bodies"][k], key)
            objects[name] = _placed(pose, camera, R_w2c)
    return {"R_w2c": R_w2c, "t_w2c": -R_w2c @ camera[:3], "objects": objects}
