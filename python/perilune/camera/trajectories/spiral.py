"""spiral: around a target in a plane or on a cone, with a radius that changes evenly."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.camera.trajectories.progress import progress
from perilune.camera.trajectories.view import aimed, distance_noise_m
from perilune.config.trajectory import Spiral
from perilune.world import World

F64 = NDArray[np.float64]

_AXES = np.eye(3)
_PLANES = {"xy": (0, 2), "yz": (1, 0), "zx": (2, 1)}
"""Name -> first axis and normal."""


def plane(spec: Spiral) -> tuple[F64, F64]:
    """First axis and normal of the plane, in the axes of the trajectory."""
    if spec.normal is None:
        first, normal = _PLANES[spec.plane or "xy"]
        return _AXES[first], _AXES[normal]
    normal_axis = np.array(spec.normal)
    for axis in _AXES[:2]:
        across = axis - float(axis @ normal_axis) * normal_axis
        size = float(np.linalg.norm(across))
        if size > 1e-9:
            break
    return across / size, normal_axis


def spiral(world: World) -> F64:
    """At share s: rotated by 2 pi s rotations from the start, at r_start + s (r_end - r_start)."""
    spec = world.camera.trajectory
    assert isinstance(spec, Spiral)
    first, normal = plane(spec)
    if spec.start_m is not None:
        start = np.array(spec.start_m)
    else:
        turn = rotations.axis_angle(normal, math.radians(spec.start_angle_deg))
        start = rotations.rotate(turn, first) * (spec.r_start_m or 0.0)
    begin = float(np.linalg.norm(start))
    end = begin if spec.r_end_m is None else spec.r_end_m
    noise = distance_noise_m(world, spec.distance_noise_m)
    shares = progress(world, spec).share

    def place(when: int) -> F64:
        angle = 2.0 * math.pi * spec.rotations * shares[when]
        radius = (1.0 - shares[when]) * begin + shares[when] * end + noise
        return rotations.rotate(rotations.axis_angle(normal, angle), start / begin) * radius

    up = spec.up or tuple(normal.tolist())
    return aimed(world, spec.model_copy(update={"up": up}), place)
