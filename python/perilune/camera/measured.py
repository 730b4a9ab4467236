"""Measured flat fields and point-spread functions of the section `sensor`, from files."""

from __future__ import annotations

import warnings
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import files, tiff

F64 = NDArray[np.float64]
_SIDE_MAX = 16384


def _tiff(path: Path) -> NDArray[np.generic]:
    with tiff.first_page(path) as page:
        if page.size > _SIDE_MAX**2:
            raise ValueError(f"{page.size} numbers are too many")
        return np.asarray(page.asarray())


def _numbers(path: Path) -> NDArray[np.generic]:
    suffix = path.suffix.lower()
    if suffix == ".npy":
        return np.asarray(np.load(path, allow_pickle=False, mmap_mode="r"))
    if suffix in (".tif", ".tiff"):
        return _tiff(path)
    if suffix == ".png":
        return _core.png_grey(path.read_bytes(), str(path))
    raise ValueError("files of images of numbers end in .npy, .tif, .tiff or .png")


@lru_cache(maxsize=16)
def _read(path: Path, stamp: files.Stamp) -> F64:
    try:
        numbers = _numbers(path)
    except Exception as error:  # whatever a decoder makes of a broken file
        text = str(error).removeprefix(f"{path}: ")
        raise ValueError(f"{path}: not an image of numbers: {text}") from None
    if numbers.ndim != 2 or numbers.dtype.kind not in "buif" or not numbers.size:
        raise ValueError(
            f"{path}: must hold real numbers in (height, width), "
            f"not {numbers.dtype} in {numbers.shape}"
        )
    if max(numbers.shape) > _SIDE_MAX:
        raise ValueError(f"{path}: sides are at most {_SIDE_MAX}, not {numbers.shape}")
    result = numbers.astype(np.float64)
    if not np.isfinite(result).all() or float(result.min()) < 0.0:
        raise ValueError(f"{path}: has numbers that are negative, infinite or none")
    result.flags.writeable = False
    return result


def read(path: Path) -> F64:
    """The numbers (height, width) of a .npy, .tif, .tiff or grey .png file, at least 0.

    Integers are those of the file, except for PNG, whose n-bit numbers are scaled to 0..65535.
    Cached until the file changes. ValueError that names the file."""
    return _read(path, files.stamp(path))


@lru_cache(maxsize=16)
def _kernel(path: Path, stamp: files.Stamp) -> F64:
    numbers = _read(path, stamp)
    total = float(numbers.sum())
    if not total > 0.0:
        raise ValueError(f"{path}: a kernel must hold some light")
    counts = bool((numbers == np.floor(numbers)).all())  # of a detector: their sum says nothing
    if not counts and abs(total - 1.0) > 0.01:
        warnings.warn(f"{path}: the kernel's sum is {total:g}; it is divided by it", stacklevel=2)
    result = numbers / total
    result.flags.writeable = False
    return result


def kernel(path: Path) -> F64:
    """A point-spread function normalised to a sum of 1; UserWarning if it holds fractions whose sum
    differs from 1 by more than 1 %."""
    return _kernel(path, files.stamp(path))


@lru_cache(maxsize=16)
def _flat(path: Path, stamp: files.Stamp) -> NDArray[np.float32]:
    numbers = _read(path, stamp)
    height, width = numbers.shape
    rows = slice((9 * height) // 20, (9 * height) // 20 + max(1, height // 10))
    columns = slice((9 * width) // 20, (9 * width) // 20 + max(1, width // 10))
    middle = float(numbers[rows, columns].mean())
    if not middle > 0.0 or float(numbers.max()) > 100.0 * middle:
        raise ValueError(f"{path}: its middle is too dark for a flat field")
    result = (numbers / middle).astype(np.float32)
    result.flags.writeable = False
    return result


def flat_field(path: Path) -> NDArray[np.float32]:
    """A flat field divided by the mean of its middle tenth, so that it is 1 on the axis."""
    return _flat(path, files.stamp(path))
