"""Poses of cameras, for hooks that place them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.camera.trajectories.view import axes, look, origin
from perilune.config.errors import nearest
from perilune.config.trajectory.common import Frame
from perilune.world import World

F64 = NDArray[np.float64]


def _vector(name: str, value: Sequence[float] | F64) -> F64:
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"look_at: {name}: must be three numbers, not {value!r}") from None
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ValueError(f"look_at: {name}: must be three finite numbers, not {array.tolist()}")
    return array


def look_at(
    world: World,
    target: str,
    position_m: Sequence[float] | F64,
    *,
    frame: Frame = "icrf",
    aim_m: Sequence[float] | F64 = (0.0, 0.0, 0.0),
    up: Sequence[float] | F64 = (0.0, 0.0, 1.0),
) -> F64:
    """Poses (2, 7) of a camera beside a target, looking at it; for hooks of the camera to return.

    A pose is x, y, z, qw, qx, qy, qz: the camera's place in the root frame (ICRF axes, the root
    body's centre at the origin), metres, and the unit quaternion that turns the camera's axes (x
    right, y down, z forward) into the root's. The rows are those at the opening and the closing of
    the shutter: the camera moves, and with frame other than icrf turns, with its target.

    world: what the hook was given. target: name of a spacecraft or body. position_m: (3,), from its
    centre, in the axes of `frame`: icrf; target, its own; lvlh or rsw, those of its orbit (as the
    key `frame` of camera.trajectory). aim_m: (3,), the point looked at, likewise. up: (3,), the
    direction that is up in the image, likewise; where it is along the view, an axis across it.

    ValueError for names that are not there, numbers that are none, and a place that is looked at.
    """
    if target not in world.poses:
        raise ValueError(f"look_at: no entry named '{target}'{nearest(target, list(world.poses))}")
    frames = ("icrf", "target", "lvlh", "rsw")
    if frame not in frames:
        raise ValueError(f"look_at: frame: no '{frame}'{nearest(frame, frames)}")
    place, aim = _vector("position_m", position_m), _vector("aim_m", aim_m)
    above = _vector("up", up)
    if not float(np.linalg.norm(above)) > 0.0:
        raise ValueError("look_at: up: must not be zero")
    rows = []
    for when in range(2):
        q = axes(world, target, frame, when)
        where = origin(world, target, when) + rotations.rotate(q, place)
        turn = rotations.multiply(q, look(world, place, aim, above))
        rows.append(np.concatenate([where, turn]))
    return np.stack(rows)
