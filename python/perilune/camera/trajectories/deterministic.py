"""deterministic: poses from the rows of a CSV file."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from perilune.base import files, rotations
from perilune.camera.trajectories.linear import between
from perilune.camera.trajectories.view import axes, camera_turn, finished, origin, refuse
from perilune.config.errors import ConfigError, nearest
from perilune.config.trajectory import Deterministic
from perilune.world import World

F64 = NDArray[np.float64]

COLUMNS = ("frame", "x", "y", "z", "qw", "qx", "qy", "qz")
_TIME = "t_s"


@dataclass(frozen=True)
class Rows:
    """The content of a file."""

    by_time: bool
    """Whether keys are seconds after the epoch instead of steps."""
    keys: F64
    """(n,), ascending."""
    positions: F64
    """(n, 3), in units of the file."""
    turns: F64
    """(n, 4), unit quaternions."""


def _columns(head: list[str], where: str) -> list[str] | None:
    """Names in a header line, or None for a row of numbers."""
    names = [name.strip() for name in head]
    try:
        float(names[0])
    except ValueError:
        pass
    else:
        return None
    allowed = [*COLUMNS, _TIME]
    for name in names:
        if name not in allowed:
            raise ValueError(f"{where}: no column '{name}'{nearest(name, allowed)}")
    for name in (_key(names), *COLUMNS[1:]):
        if names.count(name) != 1:
            what = "is missing" if name not in names else "occurs twice"
            raise ValueError(f"{where}: column '{name}' {what}")
    if len(names) != len(COLUMNS):
        raise ValueError(f"{where}: has both of the columns {COLUMNS[0]} and {_TIME}")
    return names


def _numbers(row: list[str], columns: int, where: str) -> list[float]:
    if len(row) != columns:
        raise ValueError(f"{where}: {len(row)} values, must be {columns}")
    try:
        values = [float(cell) for cell in row]
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None
    if not all(math.isfinite(value) for value in values):
        raise ValueError(f"{where}: a value is not finite")
    return values


def parse(text: str, source: str) -> Rows:
    """The rows of a file; ValueError that names file and line."""
    names: list[str] = list(COLUMNS)
    table: list[list[float]] = []
    reader = csv.reader(text.splitlines())
    first = True
    for row in reader:
        where = f"{source}: line {reader.line_num}"
        if not row or not "".join(row).strip():
            continue
        found = _columns(row, where) if first else None
        first = False
        if found is not None:
            names = found
            continue
        values = dict(zip(names, _numbers(row, len(names), where), strict=True))
        key = values[_key(names)]
        if table and key <= table[-1][0]:
            raise ValueError(f"{where}: {_key(names)} {key:g} does not rise from {table[-1][0]:g}")
        turn = [values[name] for name in COLUMNS[4:]]
        if not math.hypot(*turn) > 0.0:
            raise ValueError(f"{where}: the quaternion is zero")
        table.append([key, *(values[name] for name in COLUMNS[1:4]), *turn])
    if not table:
        raise ValueError(f"{source}: holds no pose")
    array = np.array(table)
    turns = array[:, 4:] / np.linalg.norm(array[:, 4:], axis=1)[:, None]
    return Rows(_key(names) == _TIME, array[:, 0], array[:, 1:4], turns)


def _key(names: list[str]) -> str:
    return _TIME if _TIME in names else COLUMNS[0]


@lru_cache(maxsize=8)
def _read(path: str, stamp: files.Stamp) -> Rows:
    """The rows of a file, cached until it changes."""
    return parse(files.text(Path(path)), path)


def read(path: str) -> Rows:
    """The rows of a file, parsed once."""
    return _read(path, files.stamp(Path(path)))


def _keys(world: World, spec: Deterministic, rows: Rows) -> tuple[float, float]:
    """Keys at opening and closing."""
    exposure, step_s = world.window_s, world.config.time.step_s
    first, last = float(rows.keys[0]), float(rows.keys[-1])
    if rows.by_time:
        if spec.first_frame != 0:
            refuse(world, f"first_frame: {spec.file} has a column t_s, and no frame")
        now, moved, period = world.t_s, exposure, last - first
    else:
        now = float(world.step + spec.first_frame)
        moved, period = (exposure / abs(step_s) if step_s else 0.0), last - first + 1.0
    if spec.after == "repeat" and now > last:
        now = first if period == 0.0 else first + math.fmod(now - first, period)
    return now, now + moved


def pose_at(rows: Rows, key: float) -> tuple[F64, F64]:
    """Pose interpolated between two rows; the first row's before it, the last row's after it."""
    after = int(np.searchsorted(rows.keys, key, side="right"))
    if after == 0 or after == len(rows.keys):
        row = min(after, len(rows.keys) - 1)
        return rows.positions[row], rows.turns[row]
    low, high = rows.keys[after - 1], rows.keys[after]
    share = float((key - low) / (high - low))
    place = (1.0 - share) * rows.positions[after - 1] + share * rows.positions[after]
    if share == 0.0:
        return place, rows.turns[after - 1]
    return place, between(rows.turns[after - 1], rows.turns[after], share)


def deterministic(world: World) -> F64:
    """The file's poses, in the root frame or relative to a target."""
    spec = world.camera.trajectory
    assert isinstance(spec, Deterministic)
    try:
        rows = read(spec.file)
    except ValueError as error:
        raise ConfigError(f"camera.trajectory.file: {error}") from error
    keys = _keys(world, spec, rows)

    def view(when: int) -> tuple[F64, F64]:
        place, turn = pose_at(rows, keys[when])
        place = place * spec.metres_per_unit + np.array(spec.offset_m)
        q = axes(world, spec.target, spec.frame, when)
        where = origin(world, spec.target, when) + rotations.rotate(q, place)
        return where, rotations.multiply(q, camera_turn(turn, spec.camera_axes))

    return finished(world, spec, view)
