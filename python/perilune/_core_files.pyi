"""Files of images and models: `perilune._core` has their names, for type checkers."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

def png_encode(
    array: NDArray[Any], level: int = 6, palette: NDArray[np.uint8] | None = None
) -> bytes:
    """A PNG of uint8 or uint16 (H, W) or (H, W, 1..4). palette: (n, 3) colours, n to 256, of uint8
    (H, W); ValueError for a value without a colour."""

def deflate(array: NDArray[np.uint8], zlib: bool, /) -> bytes:
    """Bytes (n,) by libdeflate. zlib: with zlib's header and sum; else the stream alone."""

def exr_encode(channels: list[tuple[str, NDArray[Any]]], text: str, /) -> bytes:
    """An OpenEXR file, by ZIP, of planes (H, W): uint32, float16 or float32.
    text: the attribute `perilune` of the header."""

def exr_decode(data: bytes, name: str, /) -> dict[str, NDArray[Any]]:
    """The planes (H, W) of an OpenEXR file of one part, by name: uint32, float16 or float32.
    ValueError, with `name`, for a damaged file, tiles or subsampled channels."""

def png_grey(data: bytes, name: str, /) -> NDArray[np.uint16]:
    """(H, W): a grey PNG of n bits, times 65535 / (2^n - 1), no alpha. ValueError with `name`."""

def png_write(path: str, array: NDArray[Any], level: int = 6) -> None:
    """Writes uint8 (H,W), (H,W,3), (H,W,4) or uint16 (H,W); atomic (temporary file and rename)."""

def simplify(
    positions: NDArray[np.float32], indices: NDArray[np.uint32], target: int, error: float, /
) -> NDArray[np.uint32]:
    """Indices (n, 3) of a mesh with `target` triangles, or as few as there can be without moving its
    surface by more than `error` of its extent. positions (V, 3), which stay; indices (T, 3).
    ValueError for indices that are no vertex's, and positions that are not finite."""

def gltf_graphs(path: str, /) -> str:
    """JSON: [{index, name}] of a glTF file's materials, with `graph` of those that are used and
    have `extras.perilune_graph`; [] when there is none or the file cannot be opened. ValueError for
    a broken file with graphs, or more than 1 MB of them."""
