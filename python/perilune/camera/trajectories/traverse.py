"""traverse: over the ground along a curve, pitch and roll from the ground."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.camera.trajectories.progress import progress
from perilune.camera.trajectories.view import finished
from perilune.config.trajectory import Traverse
from perilune.orbits.ground import way_stance
from perilune.world import World

F64 = NDArray[np.float64]


def traverse(world: World) -> F64:
    """Position and view in the axes of the way, which rotate with the body."""
    spec = world.camera.trajectory
    assert isinstance(spec, Traverse)
    ground, shares = world.ground(spec.target), progress(world, spec).share
    yaw, pitch = math.radians(spec.yaw_deg), math.radians(spec.pitch_deg)
    side = np.array([math.cos(yaw), math.sin(yaw), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    forward = math.cos(pitch) * side + math.sin(pitch) * up
    above = math.cos(pitch) * up - math.sin(pitch) * side
    footprint = spec.footprint_m or (spec.height_m, spec.height_m)

    def view(when: int) -> tuple[F64, F64]:
        body = world.poses[spec.target][when]
        stance = way_stance(ground, spec, shares[when] * spec.length_m, footprint)
        place = stance.point_m + spec.height_m * stance.axes[:, 2]
        turn = rotations.look_at(stance.axes @ forward, stance.axes @ above)
        where = body[:3] + rotations.rotate(body[3:], place)
        return where, rotations.multiply(body[3:], turn)

    return finished(world, spec, view)
