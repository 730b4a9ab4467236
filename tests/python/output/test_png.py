"""The check's PNG reader: every filter, written here by definition, and what is no sound PNG."""

from __future__ import annotations

import zlib

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra import numpy as npst
from PIL import Image

from perilune import _core
from perilune.export.check.png import GREY8, GREY16, RGB8, PngError, read_png


@given(
    st.sampled_from([np.uint8, np.uint16]).flatmap(
        lambda kind: npst.arrays(kind, npst.array_shapes(min_dims=2, max_dims=2, max_side=7))
    ),
    st.integers(0, 4),
)
def test_png_reader_against_every_filter(tmp_path_factory, array, kind):
    """One filter for all rows, coded here by the definition of section 9 of the specification."""
    path = tmp_path_factory.mktemp("png") / "a.png"
    path.write_bytes(png(array, [kind] * len(array)))
    with Image.open(path) as image:
        np.testing.assert_array_equal(np.array(image), array)
    expected = GREY16 if array.dtype == np.uint16 else GREY8
    np.testing.assert_array_equal(read_png(path, expected, array.shape[::-1]), array)


def png(array, kinds):
    """A grey PNG whose row y is coded by filter kinds[y]."""
    height, width = array.shape
    step = array.dtype.itemsize
    rows = array.astype(array.dtype.newbyteorder(">")).view(np.uint8).reshape(height, -1)
    data = b""
    for y, kind in enumerate(kinds):
        coded = bytearray([kind])
        for x, value in enumerate(rows[y].astype(int)):
            a = int(rows[y, x - step]) if x >= step else 0
            b = int(rows[y - 1, x]) if y else 0
            c = int(rows[y - 1, x - step]) if y and x >= step else 0
            nearest = min((a, b, c), key=lambda v, p=a + b - c: abs(p - v))
            coded.append((value - (0, a, b, (a + b) // 2, nearest)[kind]) % 256)
        data += bytes(coded)

    return file_of(width, height, 8 * step, 0, zlib.compress(data))


def chunk(name, body):
    return len(body).to_bytes(4) + name + body + zlib.crc32(name + body).to_bytes(4)


def file_of(width, height, bits, color, stream, interlaced=0):
    head = width.to_bytes(4) + height.to_bytes(4) + bytes([bits, color, 0, 0, interlaced])
    body = chunk(b"IHDR", head) + chunk(b"IDAT", stream) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


ROWS = bytes(4 * 5)
WHOLE = file_of(4, 4, 8, 0, zlib.compress(ROWS))


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"", "no PNG"),
        (b"a text", "no PNG"),
        (WHOLE[:-2], "middle of a chunk"),
        (WHOLE[:-12], "cut off"),
        (WHOLE + b"x", "middle of a chunk"),
        (WHOLE[:20] + b"\1" + WHOLE[21:], "chunk IHDR has a wrong checksum"),
        (WHOLE[:8] + WHOLE[33:], "does not begin with a header"),
        (file_of(4, 4, 8, 0, zlib.compress(ROWS[:-5])), "less or more pixels"),
        (file_of(4, 4, 8, 0, zlib.compress(ROWS + ROWS)), "less or more pixels"),
        (file_of(4, 4, 8, 0, b"no stream"), "cannot be decompressed"),
        (file_of(4, 4, 8, 0, zlib.compress(b"\x09aaaa" * 4)), "cannot be decoded"),
        (file_of(4, 4, 8, 0, zlib.compress(ROWS), 1), "interlaced"),
        (file_of(4, 4, 16, 2, zlib.compress(ROWS)), "is 16-bit RGB"),
        (file_of(60000, 60000, 8, 2, zlib.compress(ROWS)), "less or more pixels"),
    ],
)
def test_damaged_files_are_told(tmp_path, data, reason):
    path = tmp_path / "a.png"
    path.write_bytes(data)
    with pytest.raises(PngError, match=reason):
        read_png(path)


def test_png_reader_on_colour(tmp_path):
    path = tmp_path / "a.png"
    colors = np.random.default_rng(5).integers(0, 256, (64, 80, 3)).astype(np.uint8)
    colors[10:50] = np.linspace(0, 255, 80)[:, None].astype(np.uint8)  # smooth: other filters
    _core.png_write(str(path), colors)
    np.testing.assert_array_equal(read_png(path, RGB8, (80, 64)), colors)
    with pytest.raises(PngError, match="must be 8-bit grey"):
        read_png(path, GREY8, (80, 64))
