"""Numbers on an equirectangular grid from GeoTIFF files (TIFF 6.0; GeoTIFF 1.1, OGC 19-008).

Read are chunky strips of integers or floats, uncompressed or deflated, placed by a tie point and a
scale in degrees (a geographic grid) or metres (an equirectangular one, of a standard parallel at
the equator). What else there is in the wild is refused with a message that says what it is.
"""

from __future__ import annotations

import math
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_WIDTH, _HEIGHT, _BITS, _COMPRESSION = 256, 257, 258, 259
_STRIPS, _SAMPLES, _STRIP_BYTES, _PLANAR, _PREDICTOR, _FORMAT = 273, 277, 279, 284, 317, 339
_SCALE, _TIE, _KEYS, _DOUBLES = 33550, 33922, 34735, 34736
_TYPES = {1: "B", 3: "H", 4: "I", 6: "b", 8: "h", 9: "i", 11: "f", 12: "d"}
_COMPRESSIONS = {1: "none", 8: "deflate", 32946: "deflate", 5: "LZW", 34925: "LZMA", 32773: "RLE"}
_KINDS = {1: "u", 2: "i", 3: "f"}
_MODEL, _SEMI_MAJOR = 1024, 2057
_PROJECTED, _GEOGRAPHIC = 1, 2


@dataclass(frozen=True)
class Raster:
    """Values at cells of equal size in longitude and latitude."""

    values: NDArray[Any]
    """(height, width, bands); rows from north to south."""
    west_deg: float
    north_deg: float
    step_deg: tuple[float, float]
    """Of a cell, in longitude and latitude."""

    @property
    def south_deg(self) -> float:
        return self.north_deg - self.step_deg[1] * float(self.values.shape[0])

    @property
    def goes_round(self) -> bool:
        """Whether the columns cover all longitudes."""
        return math.isclose(self.step_deg[0] * self.values.shape[1], 360.0, rel_tol=1e-6)


def read(path: Path) -> Raster:
    """The grid of a file; ValueError that names it for what is not read."""
    data = path.read_bytes()
    try:
        return _Reader(data).raster()
    except (ValueError, struct.error, IndexError, KeyError, zlib.error) as error:
        raise ValueError(f"{path}: not a GeoTIFF that is read here: {error}") from None


class _Reader:
    def __init__(self, data: bytes) -> None:
        self.data = data
        if data[:4] not in (b"II*\0", b"MM\0*"):
            raise ValueError("no TIFF header")
        self.order = "<" if data[:2] == b"II" else ">"
        self.tags = self._directory()

    def _unpack(self, form: str, offset: int) -> tuple[Any, ...]:
        return struct.unpack_from(self.order + form, self.data, offset)

    def _directory(self) -> dict[int, tuple[Any, ...]]:
        (offset,) = self._unpack("I", 4)
        (count,) = self._unpack("H", offset)
        tags: dict[int, tuple[Any, ...]] = {}
        for at in range(offset + 2, offset + 2 + 12 * count, 12):
            tag, kind, length = self._unpack("HHI", at)
            if kind not in _TYPES:
                continue
            form = f"{length}{_TYPES[kind]}"
            inside = struct.calcsize("=" + form) <= 4
            tags[tag] = self._unpack(form, at + 8 if inside else self._unpack("I", at + 8)[0])
        return tags

    def _one(self, tag: int, default: int | None = None) -> int:
        if tag not in self.tags and default is None:
            raise ValueError(f"no tag {tag}")
        return int(self.tags.get(tag, (default,))[0])

    def _values(self) -> NDArray[Any]:
        height, width, bands = self._one(_HEIGHT), self._one(_WIDTH), self._one(_SAMPLES, 1)
        compression = self._one(_COMPRESSION, 1)
        if compression not in (1, 8, 32946) or self._one(_PREDICTOR, 1) != 1:
            name = _COMPRESSIONS.get(compression, str(compression))
            raise ValueError(f"compression {name} (predictor {self._one(_PREDICTOR, 1)})")
        if self._one(_PLANAR, 1) != 1 or _STRIPS not in self.tags:
            raise ValueError("bands in separate planes, or tiles")
        kinds = set(zip(self.tags.get(_FORMAT, (1,) * bands), self.tags[_BITS], strict=True))
        if len(kinds) != 1:
            raise ValueError("bands of several types")
        ((form, bits),) = kinds
        strips = zip(self.tags[_STRIPS], self.tags[_STRIP_BYTES], strict=True)
        packed = [self.data[at : at + size] for at, size in strips]
        raw = b"".join(packed if compression == 1 else map(zlib.decompress, packed))
        kind = np.dtype(f"{self.order}{_KINDS[form]}{bits // 8}")
        if len(raw) != height * width * bands * kind.itemsize:
            raise ValueError(f"{len(raw)} bytes for {height} x {width} x {bands} of {kind}")
        return np.frombuffer(raw, kind).reshape(height, width, bands)

    def _degrees_per_unit(self) -> float:
        table = np.array(self.tags[_KEYS]).reshape(-1, 4)[1:]
        keys = {int(key): (int(tag), int(value)) for key, tag, _, value in table}
        model = keys[_MODEL][1]
        if model == _GEOGRAPHIC:
            return 1.0
        if model != _PROJECTED or keys.get(_SEMI_MAJOR, (0, 0))[0] != _DOUBLES:
            raise ValueError("neither a geographic nor an equirectangular grid of a stated radius")
        return math.degrees(1.0 / self.tags[_DOUBLES][keys[_SEMI_MAJOR][1]])

    def raster(self) -> Raster:
        values = self._values()
        column, row, _, x, y = self.tags[_TIE][:5]
        unit = self._degrees_per_unit()
        step = float(self.tags[_SCALE][0]) * unit, float(self.tags[_SCALE][1]) * unit
        return Raster(values, x * unit - column * step[0], y * unit + row * step[1], step)
