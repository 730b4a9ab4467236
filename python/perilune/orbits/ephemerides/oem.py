"""Reads and writes CCSDS orbit ephemeris messages in their text form (KVN).

Source: CCSDS 502.0-B-3, Orbit Data Messages, section 5. Covariances and accelerations are
ignored."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from perilune.base import files
from perilune.config.errors import nearest
from perilune.orbits.dates import SCALES, seconds_of
from perilune.orbits.ephemerides.frames import to_icrf
from perilune.orbits.solar_system import Date

F64 = NDArray[np.float64]

_PAIR = re.compile(r"([A-Z_0-9]+)\s*=\s*(.*)")
_NEXT = {
    ("meta", "META_STOP"): "data",
    ("data", "COVARIANCE_START"): "covariance",
    ("covariance", "COVARIANCE_STOP"): "data",
}
"""(Part of a segment, line that ends it) -> the next part."""
_NEEDED = ("OBJECT_NAME", "OBJECT_ID", "CENTER_NAME", "REF_FRAME", "TIME_SYSTEM")


@dataclass
class Segment:
    """One META block with its data lines."""

    meta: dict[str, str]
    line: int
    """Line number of META_START, from 1."""
    times: list[str] = field(default_factory=list)
    rows: list[list[float]] = field(default_factory=list)
    """x, y, z in km and vx, vy, vz in km/s."""
    lines: list[int] = field(default_factory=list)
    """Line number in the file of each row."""


def _row(text: str, where: str) -> tuple[str, list[float]]:
    parts = text.split()
    if len(parts) not in (7, 10):
        raise ValueError(f"{where}: a line has a date and 6 numbers (or 9), not {len(parts)} words")
    try:
        numbers = [float(part) for part in parts[1:7]]
    except ValueError:
        raise ValueError(f"{where}: not a number in '{text.strip()}'") from None
    if not np.isfinite(numbers).all():
        raise ValueError(f"{where}: a number is not finite")
    return parts[0], numbers


def _checked(segment: Segment, path: Path) -> Segment:
    where = f"{path}, line {segment.line}"
    for key in _NEEDED:
        if key not in segment.meta:
            raise ValueError(f"{where}: the segment has no {key}")
    if segment.meta["TIME_SYSTEM"] not in SCALES:
        scale = segment.meta["TIME_SYSTEM"]
        raise ValueError(f"{where}: TIME_SYSTEM '{scale}' is not read{nearest(scale, SCALES)}")
    if len(segment.times) < 2:
        raise ValueError(f"{where}: the segment has {len(segment.times)} states; 2 are needed")
    return segment


def parse(path: Path) -> list[Segment]:
    """All segments of a file; ValueError that names file and line."""
    segments: list[Segment] = []
    part = "header"
    version = False
    for number, raw in enumerate(files.text(path).splitlines(), 1):
        text, where = raw.strip(), f"{path}, line {number}"
        pair = _PAIR.fullmatch(text)
        if not text or text.startswith("COMMENT"):
            continue
        if text == "META_START":
            part = "meta"
            segments.append(Segment({}, number))
        elif (part, text) in _NEXT:
            part = _NEXT[part, text]
        elif part == "covariance":
            continue
        elif part == "data" and pair is None:
            time, numbers = _row(text, where)
            segments[-1].times.append(time)
            segments[-1].rows.append(numbers)
            segments[-1].lines.append(number)
        elif pair is not None and part in ("header", "meta"):
            if part == "meta":
                segments[-1].meta[pair[1]] = pair[2].strip()
            version = version or pair[1] == "CCSDS_OEM_VERS"
        else:
            raise ValueError(f"{where}: '{text}' is not expected here")
        if not version:
            raise ValueError(f"{where}: an OEM begins with CCSDS_OEM_VERS")
    if not segments:
        raise ValueError(f"{path}: no META_START: not an OEM")
    return [_checked(segment, path) for segment in segments]


def of_object(segments: Iterable[Segment], name: str | None, path: Path) -> list[Segment]:
    """Segments of one object, by OBJECT_NAME or OBJECT_ID; without a name there must be only one
    object."""
    found, names = [], []
    for segment in segments:
        known = (segment.meta["OBJECT_NAME"], segment.meta["OBJECT_ID"])
        names.append(known[0])
        if name is None or name in known:
            found.append(segment)
    if not found:
        raise ValueError(f"{path}: no object '{name}'{nearest(name, dict.fromkeys(names))}")
    if len({(row.meta["OBJECT_NAME"], row.meta["OBJECT_ID"]) for row in found}) > 1:
        text = nearest("", dict.fromkeys(names))
        raise ValueError(f"{path}: has several objects: say which by the key `object`{text}")
    return found


def states(segment: Segment, epoch: Date, path: Path) -> tuple[F64, F64]:
    """Times (n,) in seconds after the epoch, and states (n, 6), m and m/s, in ICRF axes."""
    meta, where = segment.meta, f"{path}, line {segment.line}"
    try:
        t_s = seconds_of(segment.times, meta["TIME_SYSTEM"], epoch)
        turn = to_icrf(meta["REF_FRAME"], epoch, t_s)
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None
    late = np.flatnonzero(np.diff(t_s) <= 0.0)
    if late.size:
        line = segment.lines[int(late[0]) + 1]
        raise ValueError(f"{path}, line {line}: its time is not after that of the line before")
    rows = np.array(segment.rows) * 1e3
    both = [np.einsum("nij,nj->ni", turn, rows[:, k : k + 3]) for k in (0, 3)]
    return t_s, np.concatenate(both, axis=1)


def degree(segment: Segment, path: Path) -> int | None:
    """INTERPOLATION_DEGREE, if the file states it."""
    text = segment.meta.get("INTERPOLATION_DEGREE")
    if text is None:
        return None
    if not text.isdigit() or int(text) < 1:
        raise ValueError(f"{path}, line {segment.line}: INTERPOLATION_DEGREE '{text}' is no degree")
    return int(text)


def write_header(file: TextIO, created_utc: str, originator: str) -> None:
    """Writes the first lines of a message."""
    file.write(f"CCSDS_OEM_VERS = 2.0\nCREATION_DATE = {created_utc}\nORIGINATOR = {originator}\n")


def write_segment(
    file: TextIO, meta: Mapping[str, str], times_utc: Sequence[str], states_m: F64
) -> None:
    """Writes one object's states (n, 6), m and m/s, at UTC times without a Z; meta: names and
    frame."""
    file.write("\nMETA_START\n")
    span = {"TIME_SYSTEM": "UTC", "START_TIME": times_utc[0], "STOP_TIME": times_utc[-1]}
    for key, value in {**meta, **span}.items():
        file.write(f"{key} = {value}\n")
    file.write("META_STOP\n\n")
    for time, row in zip(times_utc, states_m, strict=True):
        # 17 digits give the same double when read back.
        file.write(" ".join([time, *(f"{value / 1e3:.16e}" for value in row)]) + "\n")
