"""Poses of instances under a rolling shutter, row by row."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.export.check.records import Pose, PoseRow

F64 = NDArray[np.float64]


def stated(pose: Pose) -> list[Pose | PoseRow]:
    """All poses given for an instance: in the middle of the frame, and of some rows."""
    return [pose, *(pose.rows or ())]


def matrices(at: Pose | PoseRow) -> tuple[F64, F64]:
    """R (3, 3) and t (3,), mm."""
    return np.reshape(at.cam_R_m2c, (3, 3)), np.array(at.cam_t_m2c)


def fault(pose: Pose, height: int) -> str | None:
    """Reason why the rows cannot belong to an image of that height."""
    rows = [at.row for at in pose.rows or ()]
    if not rows:
        return None
    if rows != sorted(set(rows)):
        return "rows are out of order, or one occurs twice"
    if (rows[0], rows[-1]) != (0, height - 1):
        return f"rows go from {rows[0]} to {rows[-1]}, must from 0 to {height - 1}"
    return None


def at_rows(pose: Pose, rows: NDArray[Any]) -> tuple[F64, F64]:
    """R (n, 3, 3) and t (n, 3), mm, at the image's rows (n,), or at positions between them."""
    if not pose.rows:
        R, t = matrices(pose)
        return np.broadcast_to(R, (len(rows), 3, 3)), np.broadcast_to(t, (len(rows), 3))
    places = np.array([at.row for at in pose.rows])
    wanted, which = np.unique(rows, return_inverse=True)
    Rs, ts = np.empty((len(wanted), 3, 3)), np.empty((len(wanted), 3))
    for k, row in enumerate(wanted):
        first = int(np.clip(np.searchsorted(places, row, side="right") - 1, 0, len(places) - 2))
        (R0, t0), (R1, t1) = matrices(pose.rows[first]), matrices(pose.rows[first + 1])
        part = float((row - places[first]) / (places[first + 1] - places[first]))
        axis, angle = rotations.to_axis_angle(rotations.from_matrix(R0.T @ R1))
        Rs[k] = R0 @ rotations.to_matrix(rotations.axis_angle(axis, part * angle))
        ts[k] = t0 + part * (t1 - t0)
    return Rs[which], ts[which]
