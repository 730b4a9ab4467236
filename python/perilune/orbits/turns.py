"""Rotations of bodies and attitudes of spacecraft in the core's form."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import erfa
import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.base.files import Stamp, stamp
from perilune.config.attitude import (
    AttitudeTable,
    Lvlh,
    Spin,
    SunPointing,
    TargetPointing,
    Tumble,
)
from perilune.config.body import Body
from perilune.orbits.dates import tt_of, utc_of
from perilune.orbits.ephemerides import csv_table
from perilune.orbits.setting import Setting, table_name
from perilune.orbits.solar_system import Date

F64 = NDArray[np.float64]
Turn = Mapping[str, Any]

SUN = ".sun"
"""Name of the Sun's node."""


def spin_of(turn: Spin, step_s: float) -> tuple[F64, F64, float]:
    """Rotation at the epoch, spin axis in the object's own frame, and rate in rad/s.

    A spin given per step continues at a constant rate between steps."""
    q = rotations.from_rpy_deg(turn.rotation_deg)
    axis, rate = np.array(turn.spin_axis), math.radians(turn.spin_rate_deg_s)
    if turn.turns_by_step:
        step = turn.rotation_deg_step_v
        if isinstance(step, tuple):
            axis, angle = rotations.to_axis_angle(rotations.from_rpy_deg(step))
        else:
            assert step is not None  # it turns by it
            angle = math.radians(step)
        rate = angle / step_s
    if turn.rotation_mode == "global":
        axis = rotations.rotate_back(q, axis)
    return q, axis, rate


def _on(frame: Any, turn: Spin, step_s: float, **keys: Any) -> Turn:
    q, axis, rate = spin_of(turn, step_s)
    return {"frame": frame, "q": q, "axis": axis, "rate_rad_s": rate, **keys}


def earth(epoch: Date) -> Callable[[F64], F64]:
    """Earth-fixed axes to ICRF (n, 4), by the IAU 2006/2000A precession-nutation and the Earth
    rotation angle (ERFA's c2t06a).

    UT1 is taken as UTC and polar motion as zero, because no IERS table is read. This rotates the
    Earth by up to 14 arcsec (0.9 s; 420 m on the equator) and tilts it by up to 0.5 arcsec (15
    m)."""

    def axes(t_s: F64) -> F64:
        tt, utc = tt_of(epoch, t_s), utc_of(epoch, t_s)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", erfa.ErfaWarning)
            matrices = erfa.c2t06a(*tt, *utc, 0.0, 0.0)
        return np.stack([rotations.from_matrix(m.T) for m in matrices])

    return axes


def body_turn(body: Body, setting: Setting) -> Turn:
    """Rotation of a body: the given one, else the table's."""
    if isinstance(body.rotation, Spin):
        return _on("inertial", body.rotation, setting.config.time.step_s)
    name = table_name(body)
    if name == "earth":
        return {"frame": earth(setting.epoch)}
    return {"frame": "inertial"} if name is None else {"frame": "body", "body": name}


def _principal(tensor: Any) -> tuple[F64, F64]:
    """Principal moments, and the quaternion from the principal axes to the object's."""
    matrix = np.array(tensor, dtype=np.float64)
    if matrix.ndim == 1:
        return matrix, np.array([1.0, 0.0, 0.0, 0.0])
    if np.abs(matrix - matrix.T).max() > 1e-9 * np.abs(matrix).max():
        raise ValueError("attitude.inertia_kg_m2: an inertia tensor is symmetric")
    moments, axes = np.linalg.eigh(matrix)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] = -axes[:, 0]
    return moments, rotations.from_matrix(axes)


def _tumble(attitude: Tumble) -> Turn:
    moments, principal = _principal(attitude.inertia_kg_m2)
    back = rotations.conjugate(principal)
    start = rotations.multiply(rotations.from_rpy_deg(attitude.rotation_deg), principal)
    rate = rotations.rotate(back, np.radians(attitude.rate_deg_s))
    return {"frame": "tumble", "inertia": moments, "omega_rad_s": rate, "start": start, "q": back}


@lru_cache(maxsize=64)
def _attitudes(path: Path, stamp: Stamp, epoch: Date, name: str | None) -> tuple[F64, F64]:
    """An attitude table, cached until its file changes."""
    t_s, q = csv_table.attitudes(path, epoch, name)
    t_s.flags.writeable = q.flags.writeable = False
    return t_s, q


def riding_turn(attitude: Spin, axes: Callable[[F64], F64], setting: Setting) -> Turn:
    """Attitude relative to axes (n, 4) of a path's own."""
    return _on(axes, attitude, setting.config.time.step_s)


def craft_turn(name: str, attitude: Any, setting: Setting, index: Mapping[str, int]) -> Turn:
    """Attitude of a spacecraft; index: name -> node."""
    step_s = setting.config.time.step_s
    if isinstance(attitude, Tumble):
        return _tumble(attitude)
    if isinstance(attitude, SunPointing):
        return _on("sun", attitude, step_s, towards=index[SUN])
    if isinstance(attitude, TargetPointing):
        up = {} if attitude.up is None else {"up": np.array(attitude.up)}
        return _on("target", attitude, step_s, towards=index[attitude.target], **up)
    if isinstance(attitude, AttitudeTable):
        path = setting.file(attitude.file, f"spacecraft.{name}.attitude.file")
        t_s, q = _attitudes(path, stamp(path), setting.epoch, attitude.object)
        return _on("table", attitude, step_s, t_s=t_s, quats=q)
    frame = "lvlh" if isinstance(attitude, Lvlh) else attitude.pointing
    return _on(frame, attitude, step_s)
