"""Checks the files of channels that are written in addition to BOP's."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from perilune.export.check.png import GREY8, GREY16, RGB8, PngError, read_png
from perilune.export.check.records import Channel


def fault(path: Path, channel: Channel, size: tuple[int, int]) -> str | None:
    """Reason why a file does not match its channel in dataset_info.json; None if it does, or is
    missing.

    size: width, height."""
    try:
        if channel.file == "npy":
            return _array_fault(path, channel, size)
        kind = RGB8 if channel.components else GREY16 if channel.dtype == "uint16" else GREY8
        read_png(path, kind, size)
    except FileNotFoundError:
        return None  # reported by the comparison of folder and labels
    except (OSError, PngError) as error:
        return str(error)
    return None


def _array_fault(path: Path, channel: Channel, size: tuple[int, int]) -> str | None:
    try:
        array = np.lib.format.read_array(io.BytesIO(path.read_bytes()), allow_pickle=False)
    except ValueError as error:
        return f"is no NPY file: {error}"
    if channel.dtype == "table":
        good = array.ndim in (1, 2) and array.dtype.names is not None
        return None if good else "is no table: must be one array with named fields"
    if array.dtype != np.dtype(channel.dtype):
        return f"holds {array.dtype}, must be {channel.dtype}"
    shape = (size[1], size[0]) if channel.components == 0 else (size[1], size[0], -1)
    count = channel.components
    good = array.ndim == len(shape) and array.shape[:2] == shape[:2]
    if not good or (count and array.shape[2] != count):
        told = " x ".join(map(str, [*shape[:2], *([count or "any"] if len(shape) == 3 else [])]))
        return f"has the shape {' x '.join(map(str, array.shape))}, must be {told}"
    return None
