"""Camera poses: one file per kind of trajectory, and hooks.

A trajectory takes the world of a frame and returns camera-to-root poses (2, 7), at the opening and
the closing of the shutter. Its random numbers are keyed by the step, by `interval` steps or by the
run, never by the frame, so that all sensors of a step share one platform. To add a kind: its
section in perilune.config.trajectory, its file here, its line in TRAJECTORIES."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.camera.trajectories.centred_target import centred_target
from perilune.camera.trajectories.deterministic import deterministic
from perilune.camera.trajectories.fixed import fixed
from perilune.camera.trajectories.flyby import flyby
from perilune.camera.trajectories.hook import called, hook
from perilune.camera.trajectories.hover import hover
from perilune.camera.trajectories.linear import linear
from perilune.camera.trajectories.orbit_object import orbit_object
from perilune.camera.trajectories.powered_descent import powered_descent
from perilune.camera.trajectories.random_box import random_box
from perilune.camera.trajectories.relative import relative
from perilune.camera.trajectories.spiral import spiral
from perilune.camera.trajectories.traverse import traverse
from perilune.camera.trajectories.view import refuse, unclear
from perilune.config.sensors import Mounting, Transformation
from perilune.world import World

F64 = NDArray[np.float64]
Trajectory = Callable[[World], F64]

TRAJECTORIES: dict[str, Trajectory] = {
    "orbit_object": orbit_object,
    "fixed": fixed,
    "random_box": random_box,
    "hover": hover,
    "linear": linear,
    "spiral": spiral,
    "flyby": flyby,
    "centred_target": centred_target,
    "relative": relative,
    "traverse": traverse,
    "powered_descent": powered_descent,
    "deterministic": deterministic,
    "hook": hook,
}


def platform_poses(world: World, own: Callable[[World], Any] | None = None) -> F64:
    """Poses (2, 7) of the platform: the user's callable if given, else as configured."""
    if own is not None:
        target = getattr(world.camera.trajectory, "target", None)
        return called(world, own, "trajectory", {}, target)
    return TRAJECTORIES[world.camera.trajectory.kind](world)


def mounted(platform: F64, place: Transformation) -> F64:
    """Poses (2, 7) of a sensor on the platform, by its key `transformation`."""
    if isinstance(place, Mounting):
        offset, q = np.array(place.position_m), rotations.from_rpy_deg(place.rotation_deg)
    else:
        offset, q = np.array(place[:3]), np.array(place[3:])
    return np.array(
        [
            np.concatenate(
                [
                    pose[:3] + rotations.rotate(pose[3:], offset),
                    rotations.multiply(pose[3:], q),
                ]
            )
            for pose in platform
        ]
    )


def camera_poses(world: World, own: Callable[[World], Any] | None = None) -> F64:
    """Poses (2, 7) of the camera that takes the frame: the platform's, or those of a sensor on it.

    A sensor beside the platform may be nearer than `clearance_m`, but must be outside of all that
    the platform avoids."""
    poses = platform_poses(world, own)
    if world.sensor is not None:
        poses = mounted(poses, world.config.sensors[world.sensor].transformation)
    kept = getattr(world.camera.trajectory, "clearance_m", None) is not None
    clearance_m = 0.0 if kept and own is None and world.sensor is not None else None
    still = world.window_s == 0.0 and bool((poses[0] == poses[1]).all())
    for when in range(1 if still else 2):
        fault = unclear(world, poses[when, :3], clearance_m, when)
        if fault is not None and world.sensor is not None:
            raise ValueError(f"sensors.{world.sensor}: frame {world.index}: {fault}")
        if fault is not None:
            refuse(world, fault)
    return poses
