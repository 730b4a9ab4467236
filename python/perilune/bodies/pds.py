"""Images of the Planetary Data System (PDS3 labels): LOLA's and MOLA's grids and their like.

The samples of an image are mapped into memory. Labels: PDS Standards Reference 3.8, chapter 12 and
the catalogues of map projections of the LOLA and MOLA data sets."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.bodies.places import Place, Reference

_LINE = re.compile(r"^\s*(\^?[A-Z0-9_:]+)\s*=\s*(.*?)\s*$", re.MULTILINE)
_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
_NUMBER = re.compile(r"^\(?\s*([-+]?[0-9.]+(?:[ED][-+]?[0-9]+)?)\s*(?:<\s*([A-Z/ ]+?)\s*>)?", re.I)
_LABEL_MAX = 1 << 20
_TYPES = {
    "LSB_INTEGER": "<i", "MSB_INTEGER": ">i", "INTEGER": ">i", "VAX_INTEGER": "<i",
    "SUN_INTEGER": ">i", "PC_INTEGER": "<i", "MAC_INTEGER": ">i",
    "LSB_UNSIGNED_INTEGER": "<u", "MSB_UNSIGNED_INTEGER": ">u", "UNSIGNED_INTEGER": ">u",
    "PC_UNSIGNED_INTEGER": "<u", "SUN_UNSIGNED_INTEGER": ">u", "MAC_UNSIGNED_INTEGER": ">u",
    "PC_REAL": "<f", "IEEE_REAL": ">f", "REAL": ">f", "SUN_REAL": ">f", "MAC_REAL": ">f",
}  # fmt: skip
"""SAMPLE_TYPE -> NumPy's byte order and kind."""


@dataclass(frozen=True)
class Label:
    """Keywords of a label."""

    path: Path
    words: Mapping[str, str]
    start: int = 0
    """Bytes of a label at the start of the image's own file."""

    def text(self, key: str, default: str | None = None) -> str:
        value = self.words.get(key, default)
        if value is None:
            raise ValueError(f"{self.path}: a label without {key}")
        return value.strip().strip('"').strip()

    def number(self, key: str, default: float | None = None, unit: str = "") -> float:
        """A number; in metres or degrees, where the label gives kilometres or nothing. unit: the
        label's unit where it says none."""
        if key not in self.words and default is not None:
            return default
        match = _NUMBER.match(self.text(key))
        if match is None:
            raise ValueError(f"{self.path}: {key} = {self.text(key)}: not a number")
        value = float(match[1].upper().replace("D", "E"))
        kilo = (match[2] or unit).upper().startswith("K")
        return 1e3 * value if kilo else value


def find_label(path: Path) -> Label | None:
    """The label of an image: at the start of its file, or in a file .lbl beside it."""
    with path.open("rb") as file:
        start = file.read(_LABEL_MAX)
    if start.startswith((b"PDS_VERSION_ID", b"CCSD3Z")):
        return _parsed(path, start.decode("latin-1"))
    for suffix in (".lbl", ".LBL"):
        beside = path.with_suffix(suffix)
        if beside.is_file():
            return _parsed(beside, beside.read_bytes()[:_LABEL_MAX].decode("latin-1"))
    return None


def _parsed(path: Path, text: str) -> Label:
    end = re.search(r"^\s*END\s*$", text, re.MULTILINE)
    text = _COMMENT.sub("", text[: end.start()] if end else text)
    words: dict[str, str] = {}
    for key, value in _LINE.findall(text.replace("\r", "\n")):
        words.setdefault(key, value)
    return Label(path, words)


def samples(path: Path, label: Label) -> NDArray[Any]:
    """(lines, samples) mapped into memory, in the file's byte order."""
    if label.number("BANDS", 1.0) != 1.0:
        raise ValueError(f"{label.path}: an image of {label.text('BANDS')} bands; supported is one")
    kind = _TYPES.get(label.text("SAMPLE_TYPE").upper())
    if kind is None:
        name = label.text("SAMPLE_TYPE")
        raise ValueError(f"{label.path}: SAMPLE_TYPE = {name}; supported: {', '.join(_TYPES)}")
    dtype = np.dtype(f"{kind}{int(label.number('SAMPLE_BITS')) // 8}")
    shape = int(label.number("LINES")), int(label.number("LINE_SAMPLES"))
    before = int(label.number("LINE_PREFIX_BYTES", 0.0))
    after = int(label.number("LINE_SUFFIX_BYTES", 0.0))
    if before or after:
        raise ValueError(f"{label.path}: lines with prefixes or suffixes are not supported")
    return mapped(path, dtype, shape, _offset(path, label))


def _offset(path: Path, label: Label) -> int:
    """Byte at which the image starts: ^IMAGE counts records from 1, of its own file or another."""
    pointer = label.words.get("^IMAGE", "")
    number = re.search(r"(?:^|,)\s*\(?\s*(\d+)\s*(<BYTES>)?\s*\)?\s*$", pointer, re.IGNORECASE)
    if number is None:
        return 0
    first = int(number[1]) - 1
    return first if number[2] else first * int(label.number("RECORD_BYTES"))


def mapped(
    path: Path, dtype: np.dtype[Any], shape: tuple[int, int], offset: int = 0
) -> NDArray[Any]:
    """Numbers of a file, mapped into memory; ValueError if it is too short."""
    wanted, there = offset + dtype.itemsize * shape[0] * shape[1], path.stat().st_size
    if shape[0] < 1 or shape[1] < 1 or wanted > there:
        size = f"{shape[0]} rows of {shape[1]} {dtype} from byte {offset}"
        raise ValueError(f"{path}: has {there} bytes, but {size} need {wanted}")
    return np.memmap(path, dtype, "r", offset, shape)


def place(label: Label) -> Place | None:
    """Where the image lies; None if the label does not say it."""
    if "MAP_PROJECTION_TYPE" not in label.words:
        return None
    if label.text("POSITIVE_LONGITUDE_DIRECTION", "EAST").upper() != "EAST":
        raise ValueError(f"{label.path}: longitudes that count to the west are not supported")
    kind = label.text("MAP_PROJECTION_TYPE").upper().replace("_", " ")
    if kind in ("SIMPLE CYLINDRICAL", "EQUIRECTANGULAR", "EQUIDISTANT CYLINDRICAL"):
        return _cylindrical(label)
    if kind in ("POLAR STEREOGRAPHIC", "ORTHOGRAPHIC"):
        return _centred(label, kind)
    raise ValueError(
        f"{label.path}: MAP_PROJECTION_TYPE = {kind}; supported: SIMPLE CYLINDRICAL, "
        "EQUIRECTANGULAR, POLAR STEREOGRAPHIC, ORTHOGRAPHIC"
    )


def _origin(label: Label, axis: str, count: str) -> float:
    """Column or row, counted from 0, of the projection's origin; the middle where labels count from
    1 or leave it out."""
    middle = 0.5 * (label.number(count) - 1.0)
    given = label.number(f"{axis}_PROJECTION_OFFSET", middle)
    return middle if abs(given - middle) <= 1.0 else given


def _cylindrical(label: Label) -> Place:
    """From the edges, if they agree with the resolution; else from the offset of the origin."""
    equatorial_m = label.number("A_AXIS_RADIUS", 0.0, "km")
    polar_m = label.number("C_AXIS_RADIUS", equatorial_m, "km")
    graphic = "GRAPHIC" in label.text("COORDINATE_SYSTEM_NAME", "").upper()
    columns, rows = label.number("LINE_SAMPLES"), label.number("LINES")
    reference = Reference("geographic", equatorial_m, polar_m if graphic else equatorial_m)
    west, east = label.number("WESTERNMOST_LONGITUDE"), label.number("EASTERNMOST_LONGITUDE")
    north, south = label.number("MAXIMUM_LATITUDE"), label.number("MINIMUM_LATITUDE")
    east += 360.0 if east <= west else 0.0
    across, down = (east - west) / columns, (north - south) / rows
    resolution = label.number("MAP_RESOLUTION", 0.0)
    step = 1.0 / resolution if resolution > 0.0 else down
    if abs(down - step) * rows <= 0.5 * step and abs(across - step) * columns <= 0.5 * step:
        return reference.place(west + 0.5 * across, north - 0.5 * down, across, -down)
    if "MAP_SCALE" in label.words and equatorial_m > 0.0:
        step = np.degrees(label.number("MAP_SCALE") / equatorial_m)
        across = step / np.cos(np.radians(label.number("CENTER_LATITUDE", 0.0)))
    else:
        across = step
    x0 = label.number("CENTER_LONGITUDE", 0.0) - across * label.number("SAMPLE_PROJECTION_OFFSET")
    return reference.place(x0, step * label.number("LINE_PROJECTION_OFFSET"), across, -step)


def _centred(label: Label, kind: str) -> Place:
    radius_m = label.number("A_AXIS_RADIUS", unit="km")
    step = label.number("MAP_SCALE")
    lat0_deg = label.number("CENTER_LATITUDE")
    lon0_deg = label.number("CENTER_LONGITUDE", 0.0)
    if kind == "POLAR STEREOGRAPHIC" and abs(lat0_deg) != 90.0:
        raise ValueError(f"{label.path}: a polar map with CENTER_LATITUDE = {lat0_deg:g}")
    geometry: Any = "stereographic" if kind == "POLAR STEREOGRAPHIC" else "orthographic"
    reference = Reference(geometry, radius_m, radius_m, lon0_deg, lat0_deg)
    x0 = -step * _origin(label, "SAMPLE", "LINE_SAMPLES")
    return reference.place(x0, step * _origin(label, "LINE", "LINES"), step, -step)
