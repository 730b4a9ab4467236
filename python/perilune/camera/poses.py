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
    """Poses (2, 7) of a camera beside a target and looking at it, for camera hooks to return.

    A pose is x, y, z, qw, qx, qy, qz: the camera's position in the root frame (ICRF axes, origin at
    the root body's centre), metres, and the unit quaternion that rotates the camera's axes (x
    right, y down, z forward) into the root's. The rows are at the opening and the closing of the
    shutter: the camera moves with its target, and rotates with it unless frame is icrf.

    world: the hook's World. target: name of a spacecraft or body. position_m: (3,), position from
    its centre in the axes of `frame`: icrf; target, its own; lvlh or rsw, those of its orbit (see
    the key `frame` of camera.trajectory). aim_m: (3,), the point to look at, in the same axes. up:
    (3,), the up direction of the image, in the same axes; if it is along the view, another axis is
    used.

    Raises ValueError for unknown names, numbers that are not finite, and a position equal to the
    point to look at."""
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
