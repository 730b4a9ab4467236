"""Reads the PNG files of a dataset strictly: 8-bit grey or RGB and 16-bit grey, complete and valid.

PNG specification, third edition (W3C): sections 5 (chunks), 9 (filters)."""

from __future__ import annotations

import io
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.export.writers.whole import png_chunks

_COLOR_NAMES = {0: "grey", 2: "RGB", 3: "palette", 4: "grey with alpha", 6: "RGB with alpha"}


class PngError(ValueError):
    """An invalid PNG file."""


@dataclass(frozen=True)
class Kind:
    """Pixel format of a picture."""

    bits: int
    color: int

    def __str__(self) -> str:
        return f"{self.bits}-bit {_COLOR_NAMES.get(self.color, f'colour type {self.color}')}"


RGB8, GREY8, GREY16 = Kind(8, 2), Kind(8, 0), Kind(16, 0)
_PIXEL_BYTES = {RGB8: 3, GREY8: 1, GREY16: 2}


def read_png(
    path: Path, kind: Kind | None = None, size: tuple[int, int] | None = None
) -> NDArray[Any]:
    """The array of a file; PngError says what is not so.

    kind, size: what it must be, the size as (width, height); default: any that is written.
    """
    data = path.read_bytes()
    try:
        chunks = png_chunks(data)
    except ValueError as error:
        raise PngError(str(error)) from None
    if chunks[0][0] != b"IHDR" or len(chunks[0][1]) != 13:
        raise PngError("does not begin with a header")
    width, height, bits, color, *methods = struct.unpack(">IIBBBBB", chunks[0][1])
    found = Kind(bits, color)
    if found not in _PIXEL_BYTES or kind not in (None, found):
        raise PngError(f"is {found}{f', must be {kind}' if kind else ''}")
    if size not in (None, (width, height)):
        raise PngError(f"is {width} x {height} pixels, must be {size[0]} x {size[1]}")
    if methods != [0, 0, 0]:
        raise PngError("is interlaced or of an unknown method")
    _check_stream(chunks, height * (1 + width * _PIXEL_BYTES[found]))
    return _decoded(data, found)


def _check_stream(chunks: list[tuple[bytes, bytes]], size: int) -> None:
    stream = zlib.decompressobj()
    try:
        # One byte more than there may be, so that a file cannot claim more memory than its header.
        found = len(stream.decompress(b"".join(b for n, b in chunks if n == b"IDAT"), size + 1))
    except zlib.error as error:
        raise PngError(f"cannot be decompressed: {error}") from None
    if found != size:
        raise PngError("holds less or more pixels than its header says")


def _decoded(data: bytes, kind: Kind) -> NDArray[Any]:
    from PIL.PngImagePlugin import PngImageFile  # not Image.open, which refuses large pictures

    try:
        return np.asarray(PngImageFile(io.BytesIO(data)), np.uint16 if kind == GREY16 else np.uint8)
    except Exception as error:  # whatever a decoder makes of a broken file
        raise PngError(f"cannot be decoded: {error}") from None
