"""linear: a straight line relative to a target, at a speed that changes evenly."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.camera.trajectories.progress import progress
from perilune.camera.trajectories.view import aimed, axes, camera_turn, finished, origin
from perilune.config.trajectory import Linear
from perilune.world import World

F64 = NDArray[np.float64]


def way(spec: Linear, share: float) -> float:
    """Fraction of the path after a fraction of the time, at constant acceleration; 0 to 0, 1 to
    1."""
    if spec.start_speed_m_s is None or spec.end_speed_m_s is None:
        return share
    # x(t) = v0 t + (v1 - v0) t^2 / 2T over x(T) = (v0 + v1) T / 2.
    first = 2.0 * spec.start_speed_m_s / (spec.start_speed_m_s + spec.end_speed_m_s)
    return share * (first + (1.0 - first) * share)


def between(a: F64, b: F64, share: float) -> F64:
    """The rotation at a fraction from a to b, along the shorter arc."""
    turn = rotations.multiply(rotations.conjugate(a), b)
    if turn[0] < 0.0:
        turn = -turn
    sine = float(np.linalg.norm(turn[1:]))
    if sine == 0.0:
        return a
    angle = 2.0 * math.atan2(sine, float(turn[0]))
    return rotations.multiply(a, rotations.axis_angle(turn[1:] / sine, share * angle))


def linear(world: World) -> F64:
    """From the start to the end, looking at the target or rotating from pose to pose."""
    spec = world.camera.trajectory
    assert isinstance(spec, Linear)
    shares = [way(spec, share) for share in progress(world, spec).share]
    start, end = np.array(spec.start.position_m), np.array(spec.end.position_m)

    def place(when: int) -> F64:
        # Exact at both ends.
        return np.asarray((1.0 - shares[when]) * start + shares[when] * end)

    if spec.start.rotation_deg is None or spec.end.rotation_deg is None:
        return aimed(world, spec, place)
    first, last = (
        camera_turn(rotations.from_rpy_deg(angles), spec.camera_axes)
        for angles in (spec.start.rotation_deg, spec.end.rotation_deg)
    )

    def view(when: int) -> tuple[F64, F64]:
        q = axes(world, spec.target, spec.frame, when)
        turn = between(first, last, shares[when])
        where = origin(world, spec.target, when) + rotations.rotate(q, place(when))
        return where, rotations.multiply(q, turn)

    return finished(world, spec, view)
