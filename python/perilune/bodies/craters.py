"""Craters of a body: the core's field of a configuration, and catalogues of real ones."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.bodies.size_laws import core_settings
from perilune.config.craters import Craters

_SMALLEST_M, _LARGEST_M = 0.1, 300e3

CATALOGUED = np.dtype(
    [
        ("id", "<i8"),
        ("name", "<U24"),
        ("lon_rad", "<f8"),
        ("lat_rad", "<f8"),
        ("diameter_m", "<f8"),
        ("direction", "<f8", (3,)),
    ]
)
"""A catalogued crater: its number in the file from 1 on, its name or the catalogue's own id, east
longitude, planetocentric latitude, diameter, and the unit direction of its centre."""


def crater_field(given: Craters, radius_m: float, below_m: float = math.inf) -> _core.CraterField:
    """The core's field of craters on a body of a mean radius. ValueError names the key.

    below_m: diameter of the smallest crater of a catalogue, from which on none is drawn."""
    settings = core_settings(given, radius_m, _SMALLEST_M, _LARGEST_M)
    if settings["min_diameter_m"] >= below_m:
        least = settings["min_diameter_m"]
        raise ValueError(
            f"craters.min_diameter_m: {least:g} m: must be below the smallest crater of "
            f"crater_catalogue, {below_m:g} m"
        )
    settings["max_diameter_m"] = min(settings["max_diameter_m"], below_m)
    for key, value in settings.pop("rays", {}).items():
        settings[f"ray_{key}"] = value
    return _core.CraterField(settings)


_COLUMNS = {
    "lat": ("lat", "latitude", "lat_circ_img"),
    "lon": ("lon", "long", "longitude", "lon_circ_img"),
    "diam": ("diam", "diameter", "diam_km", "diam_m", "diam_circ_img"),
    "name": ("name", "crater_id", "crater_name", "clean_name"),
}
"""Names of columns without units, in lower case: those of Head et al. (2010), Povilaitis et al.
(2018), Robbins (2018), and the lists of the IAU."""


def _plain(header: str) -> str:
    return header.strip().lower().split("(")[0].strip().replace(" ", "_")


def _columns(path: Path, header: Sequence[str]) -> dict[str, int]:
    names = [_plain(name) for name in header]
    found = {}
    for key, allowed in _COLUMNS.items():
        places = [names.index(name) for name in allowed if name in names]
        if places:
            found[key] = places[0]
        elif key != "name":
            raise ValueError(
                f"{path}: no column of {key}: must be named {' or '.join(allowed)}; the file has "
                f"{', '.join(header)}"
            )
    return found


def _metres(header: str) -> float:
    """Unit of a column of diameters: kilometres, unless its name says metres."""
    name = header.strip().lower()
    return 1.0 if name.endswith("(m)") or name.endswith("_m") else 1e3


def _number(path: Path, line: int, header: str, text: str, low: float, high: float) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not low <= value <= high:
        raise ValueError(f"{path}: line {line}: {header} is {text!r}; must be {low:g} to {high:g}")
    return value


def read_catalogue(path: Path) -> NDArray[np.void]:
    """Craters of a CSV file, with a header and columns of latitude, longitude (degrees east, -180
    to 360) and diameter (km, or m if the header says so). (n,) of CATALOGUED."""
    with path.open(newline=None, encoding="utf-8-sig") as file:
        rows = list(csv.reader(file))
    if not rows:
        raise ValueError(f"{path}: empty; must have a header and a line a crater")
    header = rows[0]
    at = _columns(path, header)
    unit_m = _metres(header[at["diam"]])
    lines = [(number, row) for number, row in enumerate(rows[1:], 2) if row]
    out = np.zeros(len(lines), CATALOGUED)
    bounds = {"lat": (-90.0, 90.0), "lon": (-180.0, 360.0), "diam": (1e-6, 1e6)}
    for k, (line, row) in enumerate(lines):
        if len(row) < len(header):
            raise ValueError(f"{path}: line {line}: {len(row)} of {len(header)} columns")
        lat, lon, diam = (
            _number(path, line, header[at[key]], row[at[key]], *bounds[key]) for key in bounds
        )
        name = row[at["name"]].strip() if "name" in at else ""
        out[k] = (k + 1, name, math.radians(lon), math.radians(lat), unit_m * diam, (0, 0, 0))
    lon_rad, lat_rad = out["lon_rad"], out["lat_rad"]
    out["direction"] = np.stack(
        [np.cos(lat_rad) * np.cos(lon_rad), np.cos(lat_rad) * np.sin(lon_rad), np.sin(lat_rad)], -1
    )
    return out
