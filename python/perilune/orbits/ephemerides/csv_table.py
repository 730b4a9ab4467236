"""CSV tables of states and attitudes: columns by name, with their units."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from perilune.base import files
from perilune.config.errors import nearest
from perilune.orbits.dates import seconds_of
from perilune.orbits.solar_system import Date

F64 = NDArray[np.float64]

_UNITS_M = {"_m": 1.0, "_km": 1e3}


@dataclass(frozen=True)
class Columns:
    """The columns of a table."""

    path: Path
    names: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    lines: tuple[int, ...]
    """Line number in the file of each row."""

    def only(self, name: str) -> Columns:
        """The rows of an object; ValueError without a column `object` or such an object."""
        if "object" not in self.names:
            raise ValueError(f"{self.path}: has no column 'object'")
        column = self.names.index("object")
        kept = [k for k, row in enumerate(self.rows) if row[column] == name]
        if not kept:
            names = dict.fromkeys(row[column] for row in self.rows)
            raise ValueError(f"{self.path}: no object '{name}'{nearest(name, names)}")
        rows, lines = tuple(self.rows[k] for k in kept), tuple(self.lines[k] for k in kept)
        return Columns(self.path, self.names, rows, lines)

    def texts(self, name: str) -> list[str]:
        """A column as text."""
        column = self.names.index(name)
        return [row[column] for row in self.rows]

    def numbers(self, name: str) -> F64:
        """A column of finite numbers."""
        values = np.empty(len(self.rows))
        for k, (text, line) in enumerate(zip(self.texts(name), self.lines, strict=True)):
            try:
                values[k] = float(text)
            except ValueError:
                text = f"{self.path}, line {line}, column {name}: '{text}' is not a number"
                raise ValueError(text) from None
            if not np.isfinite(values[k]):
                raise ValueError(f"{self.path}, line {line}, column {name}: not finite")
        return values

    def times_s(self, epoch: Date) -> F64:
        """Seconds of each row after the epoch, ascending."""
        if "time_utc" in self.names:
            try:
                t_s = seconds_of(self.texts("time_utc"), "UTC", epoch)
            except ValueError as error:
                raise ValueError(f"{self.path}, column time_utc: {error}") from None
        elif "t_s" in self.names:
            t_s = self.numbers("t_s")
        else:
            raise ValueError(f"{self.path}: needs a column t_s or time_utc")
        late = np.flatnonzero(np.diff(t_s) <= 0.0)
        if late.size:
            line = self.lines[int(late[0]) + 1]
            text = f"{self.path}, line {line}: its time is not after that of the line before"
            raise ValueError(text)
        return t_s

    def vectors(self, prefix: str, suffix: str = "") -> F64 | None:
        """(n, 3) in SI units from the columns of x, y, z with a prefix and a unit; None if
        missing."""
        for unit, factor in _UNITS_M.items():
            names = [f"{prefix}{axis}{unit}{suffix}" for axis in "xyz"]
            given = [name for name in names if name in self.names]
            if given and len(given) < 3:
                missing = next(name for name in names if name not in given)
                raise ValueError(f"{self.path}: has {given[0]} but no {missing}")
            if given:
                return factor * np.stack([self.numbers(name) for name in names], axis=1)
        return None


def read(path: Path) -> Columns:
    """A CSV file whose first line names the columns; lines that begin with # are skipped."""
    content = files.text(path).splitlines()
    lines = [(k, line) for k, line in enumerate(content, 1) if line.strip() and line[0] != "#"]
    try:
        table = list(csv.reader((line for _, line in lines), strict=True))
    except csv.Error as error:
        raise ValueError(f"{path}: {error}") from None
    if not table:
        raise ValueError(f"{path}: empty")
    if len(table) != len(lines):
        raise ValueError(f"{path}: a quoted field goes over several lines")
    names = tuple(name.strip() for name in table[0])
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"{path}: column '{twice}' occurs twice")
    for row, (number, _) in zip(table, lines, strict=True):
        if len(row) != len(names):
            text = f"has {len(row)} fields; the first line names {len(names)} columns"
            raise ValueError(f"{path}, line {number}: {text}")
    if len(table) < 3:
        raise ValueError(f"{path}: needs at least two lines of states")
    rows = tuple(tuple(field.strip() for field in row) for row in table[1:])
    return Columns(path, names, rows, tuple(number for number, _ in lines[1:]))


def states(
    path: Path,
    epoch: Date,
    name: str | None = None,
    around: str | None = None,
    around_root: bool = False,
) -> tuple[F64, F64]:
    """Times (n,) in seconds after the epoch, and states (n, 6), or positions (n, 3) without
    velocities.

    In a table with a column `object`, positions are relative to the root. The positions of `around`
    at the same times are subtracted, unless it is the root (around_root) and not in the table."""
    table = read(path)
    if "object" in table.names:
        if name is None:
            raise ValueError(f"{path}: has a column 'object': say which by the key `object`")
        t_s, rows = _states(table.only(name), epoch)
        if around_root and around not in table.texts("object"):
            return t_s, rows
        centre = table.only(around or "")
        t_centre, rows_centre = _states(centre, epoch)
        if t_s.shape != t_centre.shape or np.abs(t_s - t_centre).max() > 0.0:
            raise ValueError(f"{path}: {name} and {around} are not given at the same times")
        return t_s, rows - rows_centre
    if name is not None:
        raise ValueError(f"{path}: has no column 'object'")
    return _states(table, epoch)


def _states(table: Columns, epoch: Date) -> tuple[F64, F64]:
    places = table.vectors("")
    if places is None:
        raise ValueError(f"{table.path}: needs columns x_km, y_km, z_km (or x_m, y_m, z_m)")
    velocities = table.vectors("v", "_s")
    parts = [places] if velocities is None else [places, velocities]
    return table.times_s(epoch), np.concatenate(parts, axis=1)


def attitudes(path: Path, epoch: Date, name: str | None = None) -> tuple[F64, F64]:
    """Times (n,) in seconds after the epoch, and unit quaternions (n, 4) to ICRF axes."""
    table = read(path)
    if name is not None:
        table = table.only(name)
    elif "object" in table.names:
        raise ValueError(f"{path}: has a column 'object': say which by the key `object`")
    for key in ("qw", "qx", "qy", "qz"):
        if key not in table.names:
            raise ValueError(f"{path}: needs the column {key}")
    q = np.stack([table.numbers(key) for key in ("qw", "qx", "qy", "qz")], axis=1)
    norms = np.linalg.norm(q, axis=1)
    if not (norms > 0.0).all():
        line = table.lines[int(np.flatnonzero(norms <= 0.0)[0])]
        raise ValueError(f"{path}, line {line}: a quaternion is zero")
    return table.times_s(epoch), q / norms[:, None]
