"""Channels as files that several formats share: PNG, NPY, and runs of ids."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base.colors import id_colors
from perilune.export.writers.files import PNG_LEVEL, npy_parts
from perilune.export.writers.formats.base import Array
from perilune.export.writers.formats.channels import IMAGE, Channel
from perilune.export.writers.whole import png_chunks

IDS = ("semantic", "part", "instance", "hazard", "shadow")
"""Channels of ids that dataset_info.json names."""
_LARGEST_16 = 65535


def npy(array: Array) -> bytes:
    """An array as NPY, version 1.0."""
    return b"".join(npy_parts(array))


_PIECES, _PIECE = 16, 1024
_WORTH = 0.5


def deflates(array: Array) -> bool:
    """Whether deflate halves an array: of numbers that differ from pixel to pixel in all their
    bits, as depths, it wins a sixth, and takes as long as rendering them. Tried on some bytes."""
    _, data = npy_parts(array)
    if len(data) <= _PIECES * _PIECE:
        return True
    step = (len(data) - _PIECE) // (_PIECES - 1)
    tried = b"".join(data[k * step : k * step + _PIECE] for k in range(_PIECES))
    return len(zlib.compress(tried, 1)) < _WORTH * len(tried)


def from_npy(data: bytes) -> Array:
    """The array of an NPY file; ValueError for a damaged one."""
    found: Array = np.lib.format.read_array(io.BytesIO(data), allow_pickle=False)
    return found


def png(array: Array, palette: NDArray[np.uint8] | None = None) -> bytes:
    """An array of uint8 or uint16 as PNG. Two layers become red and green, and blue is 0."""
    if array.ndim == 3 and array.shape[2] == 1:
        array = array[:, :, 0]
    if array.ndim == 3 and array.shape[2] == 2:
        array = np.concatenate([array, np.zeros_like(array[:, :, :1])], axis=2)
    return _core.png_encode(np.ascontiguousarray(array), PNG_LEVEL, palette)


def from_png(data: bytes) -> Array:
    """Values of a PNG, indices of one with a palette; ValueError for a damaged one.

    Of 16-bit colour Pillow keeps 8 bits: such files are read here, with the filters that ours
    have (PNG specification, section 9: none and sub)."""
    chunks = png_chunks(data)
    width, height, bits, color, *_ = struct.unpack(">IIBBBBB", chunks[0][1])
    if (bits, color) != (16, 2):
        from PIL.PngImagePlugin import PngImageFile  # not Image.open, which refuses large pictures

        picture = PngImageFile(io.BytesIO(data))
        return np.asarray(picture, np.uint16 if bits == 16 else np.uint8)
    stream = zlib.decompress(b"".join(body for name, body in chunks if name == b"IDAT"))
    rows = np.frombuffer(stream, np.uint8).reshape(height, 1 + 6 * width)
    values = rows[:, 1:].reshape(height, width, 6).copy()
    subs = rows[:, 0] == 1
    values[subs] = np.cumsum(values[subs], axis=1, dtype=np.uint8)
    if not np.isin(rows[:, 0], (0, 1)).all():
        raise ValueError("has filters that Perilune does not write")
    return values.view(">u2").astype(np.uint16)


def fits_png(channel: Channel) -> bool:
    """Whether a channel's values are those of a PNG, as they are."""
    return (
        channel.kind == IMAGE
        and channel.dtype in ("uint8", "uint16")
        and channel.components in (0, 1, 2, 3, 4)
        and channel.name != "semantic"
    )


def largest_id(names: Mapping[str, Any]) -> int:
    """Largest id of a table of names."""
    return max(map(int, names), default=0)


def ids_image(values: Array, names: Mapping[str, Any]) -> bytes:
    """Ids as PNG: with a colour for each if all are below 256, else 16 bits, grey.

    ValueError for an id above 65535."""
    largest = max(largest_id(names), int(values.max(initial=0)))
    if largest < 256:
        return png(values.astype(np.uint8), id_colors(np.arange(largest + 1)))
    if largest > _LARGEST_16:
        raise ValueError(f"id {largest} is above {_LARGEST_16}, the largest of a PNG")
    return png(values.astype(np.uint16))
