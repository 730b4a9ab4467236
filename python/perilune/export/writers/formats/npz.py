"""NumPy archives: a file a frame with every channel as it is."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Callable, Sequence

import numpy as np

from perilune import _core
from perilune.export.writers.files import npy_parts
from perilune.export.writers.formats.base import Array, Encoded, Format, Frame, Info, Record
from perilune.export.writers.formats.channels import Channel
from perilune.export.writers.formats.pixels import from_npy, stride_of

_META = "meta.json"


class _Runs:
    """Compresses a file as a ZipFile asks for it."""

    def __init__(self, stride: int) -> None:
        self._stride, self._parts = stride, list[bytes]()

    def compress(self, data: bytes) -> bytes:
        """Nothing yet: a stream is made of the whole."""
        self._parts.append(data)
        return b""

    def flush(self) -> bytes:
        """The stream."""
        whole = np.frombuffer(b"".join(self._parts), np.uint8)
        return _core.deflate(whole, self._stride, 0)


def _add(
    archive: zipfile.ZipFile, name: str, parts: Sequence[bytes | memoryview], stride: int
) -> None:
    """Writes the parts of a file, which are not joined before: that would copy all arrays.

    stride: bytes of a pixel, by which it is compressed; 0: it is stored."""
    entry = zipfile.ZipInfo(name)  # of 1980-01-01
    entry.external_attr = 0o644 << 16
    entry.compress_type = zipfile.ZIP_DEFLATED if stride else zipfile.ZIP_STORED
    entry.file_size = sum(len(part) for part in parts)
    with archive.open(entry, "w") as file:
        if stride:
            file._compressor = _Runs(stride)  # type: ignore[attr-defined]  # zipfile takes no other
        for part in parts:
            file.write(part)


class Npz(Format):
    """Arrays of a frame in one archive."""

    name = "npz"
    doc = "a NumPy archive a frame, every channel as it is"
    layout = "`NNNNNN.npz`: an array a channel; `meta.json` in it is the frame's record"
    reader = "NumPy (`numpy.load`)"

    def holds(self, channel: Channel) -> bool:
        """Everything."""
        return True

    def encode(self, info: Info, frame: Frame) -> Encoded:
        """The archive: no time stamps, so that the same frame has the same bytes."""
        file = io.BytesIO()
        record = json.dumps(frame.record, sort_keys=True).encode("utf-8")
        with zipfile.ZipFile(file, "w") as archive:
            for name, array in frame.arrays.items():
                _add(archive, f"{name}.npy", npy_parts(array), stride_of(array))
            _add(archive, _META, [record], 1)
        return Encoded({f"{frame.key}.npz": file.getvalue()})

    def decode(self, info: Info, record: Record, read: Callable[[str], bytes]) -> dict[str, Array]:
        """Its arrays."""
        (name,) = record["files"]
        with zipfile.ZipFile(io.BytesIO(read(name))) as archive:
            return {
                channel: from_npy(archive.read(f"{channel}.npy")) for channel in info["channels"]
            }
