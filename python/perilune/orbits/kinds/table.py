"""Interpolated states from a file: CCSDS OEM or CSV."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.base.files import Stamp, stamp
from perilune.config.orbit import Table
from perilune.orbits.ephemerides import csv_table, oem
from perilune.orbits.motion import propagator
from perilune.orbits.place import Motion, Place
from perilune.orbits.solar_system import Date

F64 = NDArray[np.float64]

_DEGREE = 7
_BEYOND_S = 1e-5
"""Extrapolation allowed after a table's last line, because dates in files are rounded; the motion
is straight there."""
_CSV = (".csv", ".tsv")


@dataclass(frozen=True)
class _Piece:
    """Consecutive states with an interpolating polynomial; its arrays become read-only."""

    t_s: F64
    states: F64
    degree: int | None

    def __post_init__(self) -> None:
        self.t_s.flags.writeable = self.states.flags.writeable = False


@lru_cache(maxsize=64)
def _pieces(
    path: Path,
    stamp: Stamp,
    epoch: Date,
    name: str | None,
    around: str,
    around_root: bool,
    centre: str | None,
) -> tuple[_Piece, ...]:
    if path.suffix.lower() in _CSV:
        return (_Piece(*csv_table.states(path, epoch, name, around, around_root), None),)
    segments = oem.of_object(oem.parse(path), name, path)
    for segment in segments:
        stated = segment.meta["CENTER_NAME"].lower()
        if centre is not None and stated != centre:
            text = f"CENTER_NAME is {segment.meta['CENTER_NAME']}, but the orbit is around {around}"
            raise ValueError(f"{path}, line {segment.line}: {text}")
    return tuple(_piece(segment, epoch, path) for segment in segments)


def _piece(segment: oem.Segment, epoch: Date, path: Path) -> _Piece:
    """With INTERPOLATION = LAGRANGE the velocities are ignored, as the file asks: in some makers'
    files they are not the derivatives of the positions."""
    t_s, states = oem.states(segment, epoch, path)
    lagrange = segment.meta.get("INTERPOLATION", "").upper() in ("LAGRANGE", "LINEAR")
    return _Piece(t_s, states[:, :3].copy() if lagrange else states, oem.degree(segment, path))


def _spec(piece: _Piece, degree: int | None) -> dict[str, Any]:
    chosen = degree or piece.degree or _DEGREE
    hermite = piece.states.shape[1] == 6
    if hermite and degree is None:
        chosen |= 1  # with velocities degrees are odd; a file may state one for places alone
    most = len(piece.t_s) * (2 if hermite else 1) - 1
    return {"kind": "table", "t_s": piece.t_s, "states": piece.states, "degree": min(chosen, most)}


def _joined(specs: Sequence[dict[str, Any]], path: Path, epoch: Date) -> Motion:
    """Each segment covers its own span; where two meet, the first one counts."""

    def states(t_s: F64) -> F64:
        found = np.full((len(t_s), 6), np.nan)
        for spec in specs:
            near = np.clip(t_s, spec["t_s"][0], spec["t_s"][-1])
            inside = np.isnan(found[:, 0]) & (np.abs(t_s - near) <= _BEYOND_S)
            if inside.any():
                rows = propagator(spec, epoch).states(near[inside])
                rows[:, :3] += (t_s - near)[inside, None] * rows[:, 3:]
                found[inside] = rows
        lost = np.isnan(found[:, 0])
        if lost.any():
            times = (specs[0]["t_s"][0], specs[-1]["t_s"][-1], t_s[lost][0])
            first, last, when = (epoch.after(float(t)).utc() for t in times)
            raise ValueError(f"{path}: covers {first} to {last}, not {when}")
        return found

    return states


def table(orbit: Table, place: Place) -> Motion:
    """Interpolating polynomials through the states of the file."""
    path = place.file(orbit.file, "file")
    root, centre = orbit.around == place.setting.config.root, place.parent.table
    pieces = _pieces(path, stamp(path), place.epoch, orbit.object, orbit.around, root, centre)
    return _joined([_spec(piece, orbit.degree) for piece in pieces], path, place.epoch)
