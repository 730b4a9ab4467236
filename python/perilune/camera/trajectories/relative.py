"""relative: free motion beside a target, by the Clohessy-Wiltshire equations."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from perilune.camera.trajectories.progress import progress
from perilune.camera.trajectories.view import aimed, orbit_axes
from perilune.config.trajectory import Relative
from perilune.config.trajectory.runs import RelativeEllipse
from perilune.world import World

F64 = NDArray[np.float64]

_FROM_LVLH = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""From lvlh (forward, minus normal, down) to rsw (outward, forward, normal)."""


def clohessy_wiltshire(position_m: F64, velocity_m_s: F64, rate_rad_s: float, t_s: float) -> F64:
    """Position (3,) after t_s in the axes rsw of a circular orbit of angular rate rate_rad_s.

    Clohessy and Wiltshire, Terminal guidance system for satellite rendezvous, Journal of the
    Aerospace Sciences 27 (1960) 653; the form of Curtis, Orbital Mechanics for Engineering
    Students, section 7.4. Linear in the distance over the orbit's radius, which must be small, and
    for a circular orbit: the error grows with eccentricity times distance.
    """
    x, y, z = position_m.tolist()
    vx, vy, vz = velocity_m_s.tolist()
    n, angle = rate_rad_s, rate_rad_s * t_s
    s, c = math.sin(angle), math.cos(angle)
    one_minus_c = 2.0 * math.sin(0.5 * angle) ** 2
    return np.array(
        [
            (4.0 - 3.0 * c) * x + s / n * vx + 2.0 / n * one_minus_c * vy,
            6.0 * (s - angle) * x + y - 2.0 / n * one_minus_c * vx
            + (4.0 * s - 3.0 * angle) / n * vy,
            c * z + s / n * vz,
        ]
    )  # fmt: skip


def ellipse_state(ellipse: RelativeEllipse, rate_rad_s: float) -> tuple[F64, F64]:
    """Position and velocity at the start, rsw; vy = -2 n x avoids drift."""
    phase, across = math.radians(ellipse.phase_deg), math.radians(ellipse.normal_phase_deg)
    r, w, n = ellipse.radial_m, ellipse.normal_m, rate_rad_s
    s, c = math.sin(phase), math.cos(phase)
    position = [-r * c, ellipse.ahead_m + 2.0 * r * s, w * math.sin(across)]
    velocity = [r * n * s, 2.0 * r * n * c, w * n * math.cos(across)]
    return np.array(position), np.array(velocity)


def _elapsed_s(world: World, spec: Relative, rate_rad_s: float) -> tuple[float, float]:
    """Time since the start, at opening and closing."""
    if spec.positions is None and spec.duration_s is None:
        return world.t_s, world.t_s + world.window_s
    duration = spec.duration_s or 2.0 * math.pi / rate_rad_s
    if spec.positions is not None:
        shares = progress(world, spec.model_copy(update={"duration_s": None})).share
    else:
        shares = progress(world, spec).share
    return shares[0] * duration, shares[1] * duration


def _default_up(spec: Relative, start_m: F64) -> tuple[float, float, float]:
    """The orbit's normal, along which a path in the orbital plane never looks; or away from the
    central body if the run starts near the normal. start_m: in rsw."""
    steep = abs(float(start_m[2])) > math.cos(math.radians(30.0)) * float(np.linalg.norm(start_m))
    up = np.array([1.0, 0.0, 0.0] if steep else [0.0, 0.0, 1.0])
    x, y, z = (up if spec.frame == "rsw" else _FROM_LVLH.T @ up).tolist()
    return x, y, z


def relative(world: World) -> F64:
    """Position in the rotating axes of the target's orbit."""
    spec = world.camera.trajectory
    assert isinstance(spec, Relative)
    orbit_axes(world, spec.target, spec.frame, 0)  # refuses a target without an orbit's plane
    rate = world.mean_motion_rad_s(spec.target)
    if spec.ellipse is not None:
        position, velocity = ellipse_state(spec.ellipse, rate)
    else:
        assert spec.state is not None  # the schema asks for one of the two
        position, velocity = np.array(spec.state.position_m), np.array(spec.state.velocity_m_s)
        if spec.frame == "lvlh":
            position, velocity = _FROM_LVLH @ position, _FROM_LVLH @ velocity
    elapsed = _elapsed_s(world, spec, rate)

    def place(when: int) -> F64:
        found = clohessy_wiltshire(position, velocity, rate, elapsed[when])
        return np.asarray(_FROM_LVLH.T @ found if spec.frame == "lvlh" else found)

    up = spec.up or _default_up(spec, position)
    return aimed(world, spec.model_copy(update={"up": up}), place)
