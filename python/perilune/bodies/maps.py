"""Map files for _core.Map: pictures with 8 bits per channel, and heights at full precision.

The core reads PNG, JPEG and WebP with 8 bits itself; this module reads TIFF, and heights with more
bits."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import tiff
from perilune.bodies import geotiff
from perilune.bodies.gaps import filled, missing_in, share
from perilune.config.errors import ModelWarning

if TYPE_CHECKING:
    from tifffile import TiffPage

HeightKey: TypeAlias = Literal["height_m", "height_unit_m"]
"""Key with the height scale of a map: from black to white, or per unit of the file's numbers."""

_SIDE_MAX, _TEXELS_MAX = 65536, 1 << 28  # as of the core's images
_NO_DATA_TAG = 42113  # GDAL_NODATA
_WHITE_IS_ZERO, _BLACK_IS_ZERO, _RGB = 0, 1, 2  # PhotometricInterpretation
_TIFF_STARTS = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
_PNG_START = b"\x89PNG\r\n\x1a\n"


@dataclass(frozen=True)
class MapFile:
    """A file in the core's form."""

    source: str | NDArray[np.uint8] | NDArray[np.float32]
    """Path of the file, texels (height, width, channels), or numbers (height, width)."""
    remarks: tuple[str, ...] = ()
    """Remarks for the user, one per line."""


@dataclass(frozen=True)
class _Tiff:
    values: NDArray[Any]
    """(height, width, bands)."""
    photometric: int
    top: int
    """The largest whole number of so many bits."""
    no_data: float | None


def picture(path: Path, center_lon_deg: float | None = None) -> MapFile:
    """A picture. For TIFF: uint8, and uint16, whose values v become round(255 v / 65535).

    center_lon_deg: longitude of the centre column of a map of a whole body, which GeoTIFF tags must
    agree with. Raises ValueError that names the file."""
    if not _start(path).startswith(_TIFF_STARTS):
        return MapFile(str(path))
    read = _read_tiff(path, center_lon_deg)
    values, kinds = read.values, (_WHITE_IS_ZERO, _BLACK_IS_ZERO, _RGB)
    whole = values.dtype in (np.uint8, np.uint16) and read.top == np.iinfo(values.dtype).max
    if not whole or read.photometric not in kinds or values.shape[2] > 4:
        raise ValueError(
            f"{path}: pictures in TIFF are grey or RGB, of uint8 or uint16, not {_described(read)}"
        )
    remarks: tuple[str, ...] = ()
    if read.no_data is not None and (missing := (values == read.no_data).all(axis=2)).any():
        kept = f"marked as no-data ({read.no_data:g}) and read as this number"
        remarks = (f"{share(missing, 'texels')} {kept}",)
    if read.photometric == _WHITE_IS_ZERO:
        values = np.concatenate([read.top - values[..., :1], values[..., 1:]], axis=2)
    if values.dtype == np.uint16:  # to the nearest, as libpng has it
        values = (values.astype(np.uint32) * 255 + 32895) >> 16
    return MapFile(np.ascontiguousarray(values, np.uint8), remarks)


def told_picture(path: Path, where: str) -> str | NDArray[np.uint8] | NDArray[np.float32]:
    """The source of a picture, with a warning for each remark. where: its key."""
    read = picture(path)
    for line in read.remarks:
        warnings.warn(f"{where}: {path}: {line}", ModelWarning, stacklevel=2)
    return read.source


def heights(path: Path, key: HeightKey, center_lon_deg: float | None = None) -> MapFile:
    """Heights, from 0 to 1 (height_m) or as the file's numbers minus their mean (height_unit_m).

    Grey PNG with 16 bits and TIFF keep all of their bits. Missing numbers (not finite, beyond 1e30,
    equal to GDAL's no-data value, or the lowest of int16 and int32) are filled from their
    neighbours, with a remark. Raises ValueError that names the file."""
    start = _start(path)
    if start.startswith(_TIFF_STARTS):
        return _heights_of_tiff(path, key, _read_tiff(path, center_lon_deg))
    if not start.startswith(_PNG_START):
        if key == "height_unit_m":
            what = "height_unit_m needs a grey PNG or a TIFF; of other files give height_m"
            raise ValueError(f"{path}: {what}")
        return MapFile(str(path))
    bits = start[24] if len(start) > 24 else 8
    if key == "height_m" and bits < 16:
        return MapFile(str(path))
    spread = _core.png_grey(path.read_bytes(), str(path))
    if key == "height_m":
        return MapFile((spread / np.float32(65535)).astype(np.float32))
    return MapFile(_centred(np.rint(spread * ((2.0**bits - 1.0) / 65535.0))))


def _start(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(32)
    except OSError:
        return b""  # the core reports its fault


def _heights_of_tiff(path: Path, key: HeightKey, read: _Tiff) -> MapFile:
    kind = read.values.dtype.kind
    if kind not in "uif" or read.values.shape[2] != 1 or read.photometric > _BLACK_IS_ZERO:
        what = "heights in TIFF are one band of whole numbers or floats"
        raise ValueError(f"{path}: {what}, not {_described(read)}")
    if key == "height_m" and kind != "u":
        raise ValueError(
            f"{path}: holds {read.values.dtype}, which have no white: give height_unit_m, the "
            "metres of one of its numbers, in the place of height_m"
        )
    values = read.values[..., 0]
    missing = missing_in(values, read.no_data)
    if missing.all():
        raise ValueError(f"{path}: holds no heights: all of its numbers are no-data")
    if key == "height_m" and values.dtype == np.uint8 and read.top == 255 and not missing.any():
        return picture(path)
    remarks: tuple[str, ...] = ()
    if missing.any():
        values = filled(values, missing)
        remarks = (f"{share(missing, 'heights')} no-data: filled from those around them",)
    if key == "height_unit_m":
        return MapFile(_centred(values), remarks)
    levels = values / np.float32(read.top) if read.top < 1 << 24 else values / float(read.top)
    white_is_zero = read.photometric == _WHITE_IS_ZERO
    return MapFile((1.0 - levels if white_is_zero else levels).astype(np.float32), remarks)


def _centred(values: NDArray[Any]) -> NDArray[np.float32]:
    """The numbers minus their mean, which does not affect slopes but would cost 32-bit floats
    precision."""
    wide = values if values.dtype.kind == "f" else values.astype(np.float64)
    return np.asarray(wide - wide.mean(dtype=np.float64), np.float32)


def _described(read: _Tiff) -> str:
    bands = read.values.shape[2]
    colours = {_WHITE_IS_ZERO: "grey", _BLACK_IS_ZERO: "grey", _RGB: "RGB", 3: "palette"}
    colour = colours.get(read.photometric, f"photometric interpretation {read.photometric}")
    bits = f" ({read.top.bit_length()} bits)" if read.values.dtype.kind == "u" else ""
    return f"{bands} of {read.values.dtype}{bits}, {colour}"


def _read_tiff(path: Path, center_lon_deg: float | None) -> _Tiff:
    """The first image of a file; ValueError that names a file that cannot be read."""
    try:
        with tiff.first_page(path) as page:
            read = _page(page)
            tagged = center_lon_deg is not None and page.geotiff_tags
            place = geotiff.place(page) if tagged else None
    except ModuleNotFoundError as error:
        raise ValueError(f"{path}: {error}") from None
    except Exception as error:  # whatever a decoder makes of a broken file
        raise ValueError(f"{path}: not a TIFF that is read here: {error}") from None
    if center_lon_deg is not None and place is not None:
        _check_whole(path, place, read.values.shape, center_lon_deg)
    return read


def _page(page: TiffPage) -> _Tiff:
    width, height = page.imagewidth, page.imagelength
    if max(width, height) > _SIDE_MAX or width * height > _TEXELS_MAX:
        raise ValueError(
            f"{width} x {height} texels; at most {_SIDE_MAX} a side and {_TEXELS_MAX} in all"
        )
    if page.axes not in ("YX", "YXS", "SYX") or page.samplesperpixel > 16:
        raise ValueError(f"axes {page.axes} of {page.shape}: not one image")
    values = np.atleast_3d(page.asarray())
    if page.axes == "SYX":
        values = np.moveaxis(values, 0, -1)
    tag = page.tags.get(_NO_DATA_TAG)
    no_data = None if tag is None else float(str(tag.value).strip(" \0"))
    top = (1 << int(page.bitspersample)) - 1
    return _Tiff(values, int(page.photometric), top, no_data)


def _check_whole(
    path: Path,
    place: tuple[float, float, tuple[float, float]],
    shape: tuple[int, ...],
    center_lon_deg: float,
) -> None:
    """ValueError if the tags do not place a map over a whole body, about its centre."""
    west, north, (across, down) = place
    east, south = west + across * shape[1], north - down * shape[0]
    if (
        max(abs(east - west - 360.0) / across, abs(north - 90.0) / down, abs(south + 90.0) / down)
        > 1
    ):
        raise ValueError(
            f"{path}: its tags place it at longitudes {west:g}..{east:g} deg and latitudes "
            f"{south:g}..{north:g} deg: not over the whole body, as maps of bodies are"
        )
    center = 180.0 - (180.0 - 0.5 * (west + east)) % 360.0
    if abs((center - center_lon_deg + 180.0) % 360.0 - 180.0) > across:
        raise ValueError(
            f"{path}: its tags place its centre column at {center:g} deg: give "
            f"map_center_lon_deg: {center:g}, not {center_lon_deg:g}"
        )
