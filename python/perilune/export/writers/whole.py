"""Tests whether files are intact after a killed run, a full disk or a power cut."""

from __future__ import annotations

import io
import json
import struct
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np

_PNG = b"\x89PNG\r\n\x1a\n"
_END_OF_HEADER = b"end_header\n"
_SIZES = {"char": 1, "uchar": 1, "short": 2, "ushort": 2, "int": 4, "uint": 4, "float": 4}
_SIZES |= {"double": 8}
_CORNERS = 3


def png_chunks(data: bytes) -> list[tuple[bytes, bytes]]:
    """Name and body of each chunk (PNG specification, section 5.3); ValueError for damage."""
    if not data.startswith(_PNG):
        raise ValueError("is no PNG")
    found, place = [], len(_PNG)
    while place + 12 <= len(data):
        (length,) = struct.unpack_from(">I", data, place)
        name, end = data[place + 4 : place + 8], place + 8 + length
        if end + 4 > len(data):
            break
        if zlib.crc32(memoryview(data)[place + 4 : end]) != struct.unpack_from(">I", data, end)[0]:
            raise ValueError(f"chunk {name.decode('latin-1')} has a wrong checksum")
        found.append((name, data[place + 8 : end]))
        place = end + 4
    if place != len(data):
        raise ValueError("ends in the middle of a chunk")
    if not found or found[-1][0] != b"IEND":
        raise ValueError("is cut off")
    return found


def _png(data: bytes) -> bool:
    """Whether the last chunk exists, and all checksums are right."""
    try:
        png_chunks(data)
    except ValueError:
        return False
    return True


def _npy(data: bytes) -> bool:
    """Whether there are as many values as the header states. NPY has no checksum."""
    file = io.BytesIO(data)
    try:
        if np.lib.format.read_magic(file) != (1, 0):
            return False
        shape, _, dtype = np.lib.format.read_array_header_1_0(file)
    except ValueError:
        return False
    return len(data) == file.tell() + int(np.prod(shape, dtype=np.int64)) * dtype.itemsize


def _ply(data: bytes) -> bool:
    """Whether a binary file of triangles has as many bytes as its header states."""
    header, mark, body = data.partition(_END_OF_HEADER)
    size, count = 0, 0
    try:
        for line in header.decode("ascii").splitlines():
            words = line.split()
            if words[0] == "element":
                count = int(words[2])
            elif words[:2] == ["property", "list"]:
                size += count * (_SIZES[words[2]] + _CORNERS * _SIZES[words[3]])
            elif words[0] == "property":
                size += count * _SIZES[words[1]]
    except (ValueError, KeyError, IndexError):
        return False
    return bool(mark) and len(body) == size


def _json(data: bytes) -> bool:
    try:
        json.loads(data)
    except ValueError:
        return False
    return True


_KINDS: dict[str, Callable[[bytes], bool]] = {
    ".png": _png,
    ".npy": _npy,
    ".ply": _ply,
    ".json": _json,
}


def is_whole(path: Path) -> bool:
    """Whether a file of a dataset is complete and valid for its format."""
    try:
        return _KINDS[path.suffix](path.read_bytes())
    except FileNotFoundError:
        return False
