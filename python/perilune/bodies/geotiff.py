"""Numbers on an equirectangular grid from GeoTIFF files (GeoTIFF 1.1, OGC 19-008), by tifffile.

The grid is geographic, in degrees, or equirectangular about the equator, in metres for a stated
radius. Compressions beyond deflate need the package imagecodecs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from perilune.base import tiff

if TYPE_CHECKING:
    from tifffile import TiffPage

_BYTES_MAX = 1 << 32
"""Largest unpacked size to accept, whatever a file's header claims."""
_PROJECTED, _GEOGRAPHIC = 1, 2
_EQUIRECTANGULAR, _USER_DEFINED = 17, 32767


@dataclass(frozen=True)
class Raster:
    """Values of cells of equal size in longitude and latitude."""

    values: NDArray[Any]
    """(height, width, bands); rows from north to south."""
    west_deg: float
    north_deg: float
    step_deg: tuple[float, float]
    """Size of a cell in longitude and latitude."""

    @property
    def south_deg(self) -> float:
        return self.north_deg - self.step_deg[1] * float(self.values.shape[0])

    @property
    def goes_round(self) -> bool:
        """Whether the columns cover all longitudes."""
        return math.isclose(self.step_deg[0] * self.values.shape[1], 360.0, rel_tol=1e-6)


def read(path: Path) -> Raster:
    """The grid of a file; ValueError that names a file that cannot be read."""
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    try:
        with tiff.first_page(path) as page:
            return _raster(page)
    except ModuleNotFoundError as error:
        raise ValueError(f"{path}: {error}") from None
    except Exception as error:  # whatever a decoder makes of a broken file
        raise ValueError(f"{path}: not a GeoTIFF that is read here: {error}") from None


def _degrees_per_unit(keys: Mapping[str, Any]) -> float:
    model = int(keys["GTModelTypeGeoKey"])
    if model == _GEOGRAPHIC:
        return 1.0
    projection = int(keys.get("ProjCoordTransGeoKey", _EQUIRECTANGULAR))
    straight = projection in (_EQUIRECTANGULAR, _USER_DEFINED)
    if model != _PROJECTED or not straight or "GeogSemiMajorAxisGeoKey" not in keys:
        raise ValueError("neither a geographic nor an equirectangular grid of a stated radius")
    return math.degrees(1.0 / float(keys["GeogSemiMajorAxisGeoKey"]))


def _raster(page: TiffPage) -> Raster:
    keys = page.geotiff_tags
    if not keys:
        raise ValueError("no GeoTIFF keys")
    if page.nbytes > _BYTES_MAX:
        raise ValueError(f"claims {page.nbytes} bytes, more than {_BYTES_MAX}")
    values = np.atleast_3d(page.asarray())
    if page.axes == "SYX":
        values = np.moveaxis(values, 0, -1)
    return Raster(values, *place(page))


def place(page: TiffPage) -> tuple[float, float, tuple[float, float]]:
    """West and north edge and cell size in longitude and latitude, degrees, of a page with GeoTIFF
    keys; ValueError if they do not define them."""
    keys = page.geotiff_tags or {}
    if missing := {"GTModelTypeGeoKey", "ModelTiepoint", "ModelPixelScale"} - set(keys):
        raise ValueError(f"GeoTIFF keys without {', '.join(sorted(missing))}")
    column, row, _, x, y = keys["ModelTiepoint"][:5]
    unit = _degrees_per_unit(keys)
    step = float(keys["ModelPixelScale"][0]) * unit, float(keys["ModelPixelScale"][1]) * unit
    return x * unit - column * step[0], y * unit + row * step[1], step
