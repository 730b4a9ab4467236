"""Numbers of elevation files as they are stored, a reader for each kind of file."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import tiff
from perilune.bodies import georeference, pds
from perilune.bodies.places import Place
from perilune.config.elevation import RawSamples

_NO_DATA_TAG, _METADATA_TAG = 42113, 42112  # GDAL_NODATA, GDAL_METADATA
_BYTES_MAX = 1 << 35
"""Largest unpacked size to accept, whatever a file's header claims."""


@dataclass(frozen=True)
class ElevationFile:
    """Content of a file; what it does not say is None."""

    values: NDArray[Any]
    """(rows, columns) of any numbers; may be a memory map."""
    place: Place | None = None
    misplaced: str = ""
    """Why the georeference of the file is not supported."""
    scale_m: float | None = None
    offset_m: float | None = None
    datum_m: float | None = None
    no_data: float | None = None
    unit: str = ""
    """Unit of its numbers, if it is not in scale_m."""


def read(path: Path, raw: RawSamples | None, band: int | None = None) -> ElevationFile:
    """ValueError that names a file that cannot be read. band: of a file that has several, from
    1 on; not of images and arrays."""
    if not path.is_file():
        raise ValueError(f"file: {path}: no such file")
    reader = _reader(path)
    if raw is not None and reader is not _image:
        raise ValueError(f"raw: {path}: only for images (.img) without a label")
    banded = _tiff if reader is _tiff else _rasterio
    if band is not None and reader is not banded:
        raise ValueError(f"band: {path}: only for TIFF and what rasterio reads, of several bands")
    try:
        return reader(path, raw) if band is None else banded(path, raw, band)
    except ModuleNotFoundError as error:
        raise ValueError(f"file: {path}: {error}") from None
    except ValueError as error:
        text = str(error)
        raise ValueError(
            text if text.startswith(("raw: ", "band: ")) else f"file: {text}"
        ) from None


def _reader(path: Path) -> Callable[[Path, RawSamples | None], ElevationFile]:
    with path.open("rb") as file:
        start = file.read(16)
    for first, reader in (
        (b"II*\0", _tiff), (b"MM\0*", _tiff), (b"II+\0", _tiff), (b"MM\0+", _tiff),
        (b"\x89PNG\r\n\x1a\n", _png), (b"\x93NUMPY", _numpy),
        (b"PDS_VERSION_ID", _image), (b"CCSD3Z", _image),
    ):  # fmt: skip
        if start.startswith(first):
            return reader
    return _image if path.suffix.lower() == ".img" else _rasterio


def _numpy(path: Path, _: RawSamples | None) -> ElevationFile:
    try:
        values = np.load(path, mmap_mode="r", allow_pickle=False)
    except Exception as error:  # whatever NumPy makes of a broken file
        raise ValueError(f"{path}: not an array of NumPy: {error}") from None
    if values.ndim != 2 or values.dtype.kind not in "uif" or values.dtype.itemsize > 8:
        what = f"{values.dtype} of shape {values.shape}"
        raise ValueError(f"{path}: holds {what}, not rows and columns of numbers")
    return ElevationFile(values)


def _png(path: Path, _: RawSamples | None) -> ElevationFile:
    content = path.read_bytes()
    spread = _core.png_grey(content, str(path))
    if content[24] == 16:
        return ElevationFile(spread)
    levels = (1 << content[24]) - 1
    return ElevationFile(np.rint(spread * (levels / 65535.0)).astype(np.uint8))


def _image(path: Path, raw: RawSamples | None) -> ElevationFile:
    label = pds.find_label(path)
    if label is None:
        return ElevationFile(_unlabelled(path, raw))
    if raw is not None:
        raise ValueError(f"raw: {path}: has the label {label.path}, which states its layout")
    return _labelled(path, label)


def _labelled(path: Path, label: pds.Label) -> ElevationFile:
    unit = 1e3 if label.text("UNIT", "METER").upper().startswith(("KILOM", "KM")) else 1.0
    offset_m = unit * label.number("OFFSET", 0.0)
    radius_m = label.number("A_AXIS_RADIUS", 0.0, "km")
    datum_m = offset_m if 0.5 * radius_m < offset_m else None  # numbers are radii
    missing = label.number("MISSING_CONSTANT", np.nan)
    place, misplaced = _placed(lambda: pds.place(label))
    return ElevationFile(
        pds.samples(path, label),
        place,
        misplaced,
        unit * label.number("SCALING_FACTOR", 1.0),
        0.0 if datum_m else offset_m,
        datum_m,
        None if np.isnan(missing) else missing,
    )


def _unlabelled(path: Path, raw: RawSamples | None) -> NDArray[Any]:
    layout = raw or RawSamples()
    dtype = np.dtype(layout.type).newbyteorder(layout.byte_order)
    count = path.stat().st_size // dtype.itemsize
    width = layout.width or 2 * round((count / 2) ** 0.5)
    height = count // width if width else 0
    if width * height * dtype.itemsize != path.stat().st_size or height < 1:
        rows = f"rows of {width} numbers of {dtype}"
        why = "" if layout.width else " (twice as many as rows)"
        raise ValueError(
            f"raw: {path}: has no label, and its {path.stat().st_size} bytes are no {rows}{why}; "
            "give raw.type and raw.width"
        )
    return pds.mapped(path, dtype, (height, width))


def _placed(place: Callable[[], Place | None]) -> tuple[Place | None, str]:
    """The place of a file, or why there is none."""
    try:
        return place(), ""
    except ValueError as error:
        return None, str(error)


def _tiff(path: Path, _: RawSamples | None, band: int | None = None) -> ElevationFile:
    try:
        with tiff.first_page(path) as page:
            if page.nbytes > _BYTES_MAX:
                raise ValueError(f"claims {page.nbytes} bytes, more than {_BYTES_MAX}")
            values = page.asarray()
            tag = page.tags.get(_NO_DATA_TAG)
            no_data = None if tag is None else float(str(tag.value).strip(" \0"))
            metadata = page.tags.get(_METADATA_TAG)
            text = "" if metadata is None else str(metadata.value)
            place, misplaced = _placed(lambda: georeference.of_page(page))
            planes = page.axes.startswith("S")
    except ModuleNotFoundError:
        raise
    except Exception as error:  # whatever a decoder makes of a broken file
        raise ValueError(f"{path}: not a TIFF that is read here: {error}") from None
    if band is not None:
        values = _band_of(values, planes, band, path)
    if values.ndim != 2 or values.dtype.kind not in "uif":
        what = f"{values.dtype} of shape {values.shape}"
        raise ValueError(f"{path}: holds {what}, not one band of numbers")
    says = [_gdal_item(text, role, (band or 1) - 1) for role in ("scale", "offset", "unittype")]
    scale, offset = (None if word is None else float(word) for word in says[:2])
    return ElevationFile(values, place, misplaced, scale, offset, None, no_data, says[2] or "")


def _band_of(values: NDArray[Any], planes: bool, band: int, path: Path) -> NDArray[Any]:
    """A band of (rows, columns, bands), or, with `planes`, of (bands, rows, columns)."""
    whole = (
        values[..., None] if values.ndim == 2 else np.moveaxis(values, 0, -1) if planes else values
    )
    count = whole.shape[-1]
    if whole.ndim != 3 or band > count:
        raise ValueError(f"band: {path}: {band}; the file has {count}")
    return np.ascontiguousarray(whole[:, :, band - 1])


def _gdal_item(metadata: str, role: str, sample: int) -> str | None:
    """What GDAL says of a band, from 0 on; without a number it speaks of the first."""
    for attributes, text in re.findall(r"<Item\b([^>]*)>([^<]*)</Item>", metadata):
        numbered = re.search(r'\bsample="(\d+)"', attributes)
        if f'role="{role}"' in attributes and int(numbered[1] if numbered else 0) == sample:
            return str(text).strip()
    return None


def _rasterio(path: Path, _: RawSamples | None, band: int | None = None) -> ElevationFile:
    try:
        import rasterio
    except ModuleNotFoundError:
        text = "files of this kind need the package rasterio: pip install 'perilune[geo]'"
        raise ModuleNotFoundError(text, name="rasterio") from None
    try:
        with warnings.catch_warnings(), rasterio.open(path) as file:
            warnings.simplefilter("ignore")  # of no georeference: that is told by the place
            k, count = (band or 1) - 1, int(file.count)
            values = file.read(k + 1, masked=True) if k < count else None
            no_data = None if file.nodata is None else float(file.nodata)
            scale, offset, unit = file.scales[:], file.offsets[:], file.units[:]
            words = file.crs.to_dict() if file.crs else None
            transform = tuple(file.transform)
    except Exception as error:  # whatever GDAL makes of it
        raise ValueError(f"{path}: not a raster that rasterio reads: {error}") from None
    if values is None:
        raise ValueError(f"band: {path}: {band}; the file has {count}")
    if values.dtype.kind not in "uif" or (band is None and count > 1):
        what = f"{count} bands of {values.dtype}"
        raise ValueError(f"{path}: holds {what}, not one band of numbers")
    place, misplaced = _placed(lambda: words and georeference.of_proj(words, transform))
    numbers = (float(scale[k]), float(offset[k]))
    return ElevationFile(
        _unmasked(values, no_data), place, misplaced, *numbers, None, no_data, unit[k] or ""
    )


def _unmasked(values: Any, no_data: float | None) -> NDArray[Any]:
    """The numbers, those that are masked by anything but a number of their own as NaN."""
    if no_data is not None or not np.ma.getmaskarray(values).any():
        return np.asarray(values.data)
    return np.asarray(values.astype(np.float64).filled(np.nan))
