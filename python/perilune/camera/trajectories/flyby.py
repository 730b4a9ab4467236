"""flyby: a straight pass of a target at constant speed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from perilune.camera.trajectories.progress import progress
from perilune.camera.trajectories.view import aimed
from perilune.config.trajectory import Flyby
from perilune.world import World

F64 = NDArray[np.float64]


def flyby(world: World) -> F64:
    """Along `direction`, closest_m from the target's centre or over its ground at the closest
    point."""
    spec = world.camera.trajectory
    assert isinstance(spec, Flyby)
    direction, side = np.array(spec.direction), np.array(spec.side)
    side = side - float(side @ direction) * direction
    side /= np.linalg.norm(side)
    behind = spec.before_m if spec.after_m is None else spec.after_m
    shares = progress(world, spec).share
    closest_m = spec.closest_m
    if spec.altitude_above is not None:
        ground = world.ground(spec.target)
        base = ground.datum_m if spec.altitude_above == "datum" else ground.ground_m
        closest_m += float(base(side[np.newaxis])[0])

    def place(when: int) -> F64:
        along = -spec.before_m * (1.0 - shares[when]) + behind * shares[when]
        return np.asarray(closest_m * side + along * direction)

    up = spec.up or tuple(np.cross(side, direction).tolist())
    return aimed(world, spec.model_copy(update={"up": up}), place)
