"""powered_descent: down to the ground by a gravity turn."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.camera.trajectories.view import finished, refuse
from perilune.config.trajectory import PoweredDescent
from perilune.orbits.descent import DescentError, Track, track
from perilune.orbits.ground import vertical
from perilune.orbits.riding import field_of
from perilune.world import World

F64 = NDArray[np.float64]


def _times_s(world: World, spec: PoweredDescent, end_s: float) -> tuple[float, float]:
    """Time since the start of the descent, at opening and closing."""
    if spec.positions is None:
        start = world.t_s
        if start < 0.0 and spec.after == "hold":
            refuse(world, "the descent starts at the epoch; time.step_s leads before it")
        if spec.after == "repeat":
            start = math.fmod(start, end_s) % end_s
    else:
        place = world.step % spec.positions
        if spec.after == "hold":
            place = min(world.step, spec.positions - 1)
        start = end_s * place / (spec.positions - 1)
    return start, start + world.window_s


def _axis(spec: PoweredDescent, found: Track, place: F64, axes: F64, down: F64) -> F64:
    if spec.look == "thrust":
        return -axes[:, 2]
    if spec.look == "nadir":
        return down
    way = found.feet_m - spec.height_m * found.up - place
    return np.asarray(way / np.linalg.norm(way))


def powered_descent(world: World) -> F64:
    """Position and view rotate with the body."""
    spec = world.camera.trajectory
    assert isinstance(spec, PoweredDescent)
    ground = world.ground(spec.target)
    try:
        field = field_of(world.system.setting, spec.target)
        found = track(spec, ground, field, spec.height_m)
    except DescentError as error:
        raise ValueError(f"camera.trajectory.{error}") from None
    times = _times_s(world, spec, found.end_s)
    tilt = math.radians(spec.tilt_deg)

    def view(when: int) -> tuple[F64, F64]:
        body = world.poses[spec.target][when]
        place, axes = found.state(times[when])[0], found.axes(times[when])
        down = -vertical(ground.radii_m, place)
        axis = _axis(spec, found, place, axes, down)
        ahead = np.cross(axis, axes[:, 1])  # the heading, across the optical axis
        ahead /= np.linalg.norm(ahead)
        forward = math.cos(tilt) * axis + math.sin(tilt) * ahead
        up = math.cos(tilt) * ahead - math.sin(tilt) * axis
        turn = rotations.look_at(forward, up)
        where = body[:3] + rotations.rotate(body[3:], place)
        return where, rotations.multiply(body[3:], turn)

    return finished(world, spec, view)
