"""Reads star catalogues: CSV, and the Bright Star Catalogue as JSON."""

from __future__ import annotations

import csv
import json
import logging
import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.config.errors import nearest

F64 = NDArray[np.float64]

SUN_K = 5772.0
"""Effective temperature of the Sun (IAU 2015 resolution B3)."""

_LOG = logging.getLogger(__name__)
_HOURS = re.compile(r"(\d+)h\s*(\d+)m\s*(\d+(?:\.\d*)?)s")
_DEGREES = re.compile(r"([+-]?)(\d+)\u00b0\s*(\d+)\u2032\s*(\d+(?:\.\d*)?)\u2033")
_NEEDED = ("ra_deg", "dec_deg", "vmag")
_COLUMNS = (*_NEEDED, "number", "bv", "temperature_k", "pm_ra_mas_yr", "pm_dec_mas_yr")
_BV = (-0.6, 6.0)
_KELVIN = (500.0, 1e6)


@dataclass(frozen=True)
class StarTable:
    """Stars of a file, one row each."""

    number: NDArray[np.int64]
    ra_rad: F64
    dec_rad: F64
    vmag: F64
    temperature_k: F64
    """Temperature of a black body of the star's colour; the Sun's if the file has none."""
    motion_rad_yr: F64
    """(n, 2): proper motion along the sky, eastwards and northwards."""
    skipped: int
    """Rows without a magnitude."""


def temperature_k(bv: float) -> float:
    """Temperature of a black body with the colour index B - V (Ballesteros 2012, equation 14)."""
    return 4600.0 * (1.0 / (0.92 * bv + 1.7) + 1.0 / (0.92 * bv + 0.62))


class _Row:
    """One star of a file, with its place for errors."""

    def __init__(self, where: str, fields: Mapping[str, Any]) -> None:
        self.where, self.fields = where, fields

    def text(self, key: str) -> str:
        value = self.fields.get(key)
        return "" if value is None else str(value).strip()

    def fail(self, key: str, complaint: str) -> ValueError:
        return ValueError(f"{self.where}: {key}: {complaint}, not '{self.text(key)}'")

    def number(self, key: str, low: float, high: float) -> float | None:
        """A number; None for an empty field."""
        text = self.text(key)
        if not text:
            return None
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not low <= value <= high:
            raise self.fail(key, f"must be a number from {low:g} to {high:g}")
        return value

    def needed(self, key: str, low: float, high: float) -> float:
        value = self.number(key, low, high)
        if value is None:
            raise self.fail(key, f"must be a number from {low:g} to {high:g}")
        return value

    def whole(self, key: str, default: int) -> int:
        text = self.text(key)
        if not text:
            return default
        if not re.fullmatch(r"-?\d{1,18}", text):
            raise self.fail(key, "must be a whole number")
        return int(text)

    def sexagesimal(self, key: str, pattern: re.Pattern[str], example: str) -> float:
        """An angle in the unit of its first number."""
        match = pattern.fullmatch(self.text(key))
        if match is None:
            raise self.fail(key, f"must be such as {example}")
        *sign, first, minutes, seconds = match.groups()
        if float(minutes) >= 60.0 or float(seconds) >= 60.0:
            raise self.fail(key, "minutes and seconds must be below 60")
        value = float(first) + float(minutes) / 60.0 + float(seconds) / 3600.0
        return -value if sign == ["-"] else value


_Star = tuple[int, float, float, float, float, float, float]
"""Number, right ascension and declination in degrees, V, K, proper motion in mas/yr."""


def _csv_star(row: _Row, line: int) -> _Star | None:
    bv, kelvin = row.number("bv", *_BV), row.number("temperature_k", *_KELVIN)
    ra, dec = row.needed("ra_deg", -360.0, 360.0), row.needed("dec_deg", -90.0, 90.0)
    motion = [row.number(f"pm_{key}_mas_yr", -1e6, 1e6) or 0.0 for key in ("ra", "dec")]
    vmag = row.number("vmag", -30.0, 60.0)
    if vmag is None:
        return None
    if kelvin is None:
        kelvin = SUN_K if bv is None else temperature_k(bv)
    return (row.whole("number", line), ra, dec, vmag, kelvin, motion[0], motion[1])


def _json_star(row: _Row, place: int) -> _Star | None:
    ra = row.sexagesimal("RA", _HOURS, "00h 05m 09.9s")
    dec = row.sexagesimal("Dec", _DEGREES, "+45\u00b0 13\u2032 45\u2033")
    if ra >= 24.0:
        raise row.fail("RA", "must be below 24h")
    if abs(dec) > 90.0:
        raise row.fail("Dec", "must be from -90 to 90 degrees")
    vmag, kelvin = row.number("V", -30.0, 60.0), row.number("K", *_KELVIN)
    if vmag is None:
        return None
    return (row.whole("HR", place), 15.0 * ra, dec, vmag, kelvin or SUN_K, 0.0, 0.0)


def _read_csv(path: Path) -> Iterator[_Star | None]:
    with path.open(newline="", encoding="utf-8-sig") as file:
        reader = csv.DictReader(file, strict=True)
        columns = [name.strip() for name in reader.fieldnames or ()]
        reader.fieldnames = columns
        for name in columns:
            if name not in _COLUMNS:
                text = f"a column '{name}' is not known{nearest(name, _COLUMNS)}"
                raise ValueError(f"{path}: line 1: {text}")
        for name in _NEEDED:
            if name not in columns:
                have = ", ".join(columns) or "nothing"
                raise ValueError(f"{path}: line 1: no column '{name}'; there is {have}")
        try:
            for count, fields in enumerate(reader, start=1):
                where = f"{path}: line {reader.line_num}"
                if None in fields:
                    raise ValueError(f"{where}: more fields than the {len(columns)} columns")
                yield _csv_star(_Row(where, fields), count)
        except csv.Error as error:
            raise ValueError(f"{path}: line {reader.line_num}: {error}") from None


def _read_json(path: Path) -> Iterator[_Star | None]:
    try:
        rows = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path}: {error}") from None
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise ValueError(f"{path}: must be a list of mappings {{RA, Dec, V, K, HR}}")
    for place, fields in enumerate(rows, start=1):
        name = f" (HR {fields['HR']})" if "HR" in fields else ""
        yield _json_star(_Row(f"{path}: star {place}{name}", fields), place)


_READERS: dict[str, Callable[[Path], Iterator[_Star | None]]] = {
    ".csv": _read_csv,
    ".json": _read_json,
}


def read_stars(path: Path) -> StarTable:
    """The stars of a file in its order; those without a magnitude are skipped and counted.

    ValueError with file, line (in JSON: star) and field for invalid content."""
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise ValueError(f"{path}: a catalogue of stars is one of {', '.join(_READERS)}")
    try:
        rows = list(reader(path))
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: {error}") from None
    kept = [row for row in rows if row is not None]
    skipped = len(rows) - len(kept)
    if skipped:
        _LOG.warning("%s: %d stars without a magnitude are left out", path, skipped)
    columns = np.array([row[1:] for row in kept], np.float64).reshape(-1, 6).T
    return StarTable(
        number=np.array([row[0] for row in kept], np.int64),
        ra_rad=np.radians(columns[0]),
        dec_rad=np.radians(columns[1]),
        vmag=columns[2],
        temperature_k=columns[3],
        motion_rad_yr=np.radians(columns[4:6].T / 3.6e6),
        skipped=skipped,
    )
