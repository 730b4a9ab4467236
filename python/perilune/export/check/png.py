"""Reads the PNG files of a dataset, strictly: 8-bit grey or RGB and 16-bit grey, whole and sound.

PNG specification, third edition (W3C): sections 5 (chunks), 9 (filters).
"""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

U8 = NDArray[np.uint8]

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_COMPONENTS = {0: 1, 2: 3}
_COLOR_NAMES = {0: "grey", 2: "RGB", 3: "palette", 4: "grey with alpha", 6: "RGB with alpha"}
_AVERAGE, _PAETH = 3, 4


class PngError(ValueError):
    """The file is not the PNG it should be."""


@dataclass(frozen=True)
class Kind:
    """What sort of picture a file holds."""

    bits: int
    color: int

    def __str__(self) -> str:
        return f"{self.bits}-bit {_COLOR_NAMES.get(self.color, f'colour type {self.color}')}"


RGB8, GREY8, GREY16 = Kind(8, 2), Kind(8, 0), Kind(16, 0)


def _chunks(data: bytes) -> list[tuple[bytes, bytes]]:
    if not data.startswith(_SIGNATURE):
        raise PngError("is no PNG")
    found, place = [], len(_SIGNATURE)
    while place < len(data):
        if place + 12 > len(data):
            raise PngError("ends in the middle of a chunk")
        (length,) = struct.unpack_from(">I", data, place)
        name, body = data[place + 4 : place + 8], data[place + 8 : place + 8 + length]
        place += 12 + length
        if place > len(data):
            raise PngError("ends in the middle of a chunk")
        if zlib.crc32(name + body) != struct.unpack_from(">I", data, place - 4)[0]:
            raise PngError(f"chunk {name.decode('latin-1')} has a wrong checksum")
        found.append((name, body))
    if not found or found[0][0] != b"IHDR" or len(found[0][1]) != 13 or found[-1][0] != b"IEND":
        raise PngError("is cut off, or does not begin with a header")
    return found


def _inflate(chunks: list[tuple[bytes, bytes]], size: int) -> U8:
    stream = zlib.decompressobj()
    try:
        # One byte more than there may be, so that a file cannot claim more memory than its header.
        data = stream.decompress(
            b"".join(body for name, body in chunks if name == b"IDAT"), size + 1
        )
    except zlib.error as error:
        raise PngError(f"cannot be decompressed: {error}") from None
    if len(data) != size:
        raise PngError("holds less or more pixels than its header says")
    return np.frombuffer(data, dtype=np.uint8)


def _rows(coded: U8, pixel: int) -> U8:
    """Undoes the filters of rows none of which looks at decoded pixels on its left but by sums."""
    filters, rows = coded[:, 0], coded[:, 1:]
    before = np.zeros(rows.shape[1], dtype=np.uint8)
    decoded = np.empty_like(rows)
    for y, kind in enumerate(filters):
        row = rows[y]
        if kind == 1:
            row = np.cumsum(row.reshape(-1, pixel), axis=0, dtype=np.uint8).ravel()
        elif kind == 2:
            row = row + before
        decoded[y] = before = row
    return decoded


def _predicted(kind: NDArray[Any], a: NDArray[Any], b: NDArray[Any], c: NDArray[Any]) -> Any:
    """What the filters predict from the left (a), the upper (b) and the upper left byte (c)."""
    pa, pb, pc = np.abs(b - c), np.abs(a - c), np.abs(a + b - 2 * c)
    paeth = np.where((pa <= pb) & (pa <= pc), a, np.where(pb <= pc, b, c))
    return np.choose(kind, (np.zeros_like(a), a, b, (a + b) >> 1, paeth))


def _diagonals(coded: U8, width: int, pixel: int) -> U8:
    """Undoes any filters. Pixels of a diagonal x + y = t depend on earlier diagonals alone."""
    height = coded.shape[0]
    kinds = coded[:, :1].astype(np.int16)
    rows = coded[:, 1:].astype(np.int16).reshape(-1, pixel)
    # One row above and one column on the left hold zeros, as the filters want them. Along a
    # diagonal the flat index grows by the width less one.
    decoded = np.zeros(((height + 1) * (width + 1), pixel), dtype=np.int16)
    for t in range(width + height - 1):
        first, last = max(0, t - width + 1), min(height - 1, t)
        count = last - first + 1
        own = (first + 1) * (width + 1) + (t - first + 1)

        def along(start: int, step: int = width, count: int = count) -> slice:
            return slice(start, start + (count - 1) * step + 1, step)

        a, b = decoded[along(own - 1)], decoded[along(own - width - 1)]
        c = decoded[along(own - width - 2)]
        coded_t = rows[along(first * width + t - first, max(width - 1, 1))]
        value = coded_t + _predicted(kinds[first : last + 1], a, b, c)
        decoded[along(own)] = value & 255
    inner = decoded.reshape(height + 1, width + 1, pixel)[1:, 1:]
    return inner.astype(np.uint8).reshape(height, width * pixel)


def decoded_png(path: Path) -> NDArray[Any]:
    """The array of a PNG of whatever kind of those that are written."""
    width, height, bits, color = struct.unpack(">IIBB", _chunks(path.read_bytes())[0][1][:10])
    if bits not in (8, 16) or color not in _COMPONENTS:
        raise PngError(f"is {Kind(bits, color)}")
    return read_png(path, Kind(bits, color), (width, height))


def read_png(path: Path, kind: Kind, size: tuple[int, int], pixels: bool = True) -> NDArray[Any]:
    """The array of a file of that kind and size (width, height); PngError says what is not so.

    pixels: without, the file is read and decompressed, but the array holds nothing of use.
    """
    chunks = _chunks(path.read_bytes())
    width, height, bits, color, *rest = struct.unpack(">IIBBBBB", chunks[0][1])
    if Kind(bits, color) != kind:
        raise PngError(f"is {Kind(bits, color)}, must be {kind}")
    if (width, height) != size:
        raise PngError(f"is {width} x {height} pixels, must be {size[0]} x {size[1]}")
    if rest != [0, 0, 0]:
        raise PngError("is interlaced or of an unknown method")
    pixel = _COMPONENTS[color] * bits // 8
    coded = _inflate(chunks, height * (1 + width * pixel)).reshape(height, -1)
    if (coded[:, 0] > _PAETH).any():
        raise PngError("has a row of an unknown filter")
    if not pixels:
        return np.empty((0, 0), dtype=np.uint8)
    simple = not (coded[:, 0] >= _AVERAGE).any()
    decoded = _rows(coded, pixel) if simple else _diagonals(coded, width, pixel)
    if bits == 16:
        decoded = decoded.view(">u2").astype(np.uint16)
    return decoded.reshape(height, width, 3) if color == RGB8.color else decoded
