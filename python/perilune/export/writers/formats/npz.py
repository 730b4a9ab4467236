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
from perilune.export.writers.formats.pixels import deflates, from_npy

_META = "meta.json"


class _Whole:
    """Compresses a file as a ZipFile asks for it."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []

    def compress(self, data: bytes) -> bytes:
        """Nothing yet: a stream is made of the whole."""
        self._parts.append(data)
        return b""

    def flush(self) -> bytes:
        """The stream."""
        return _core.deflate(np.frombuffer(b"".join(self._parts), np.uint8), False)


def _add(
    archive: zipfile.ZipFile, name: str, parts: Sequence[bytes | memoryview], deflated: bool
) -> None:
    """Writes the parts of a file; those that are stored are not joined before, which would copy
    all arrays."""
    entry = zipfile.ZipInfo(name)  # of 1980-01-01
    entry.external_attr = 0o644 << 16
    entry.compress_type = zipfile.ZIP_DEFLATED if deflated else zipfile.ZIP_STORED
    entry.file_size = sum(len(part) for part in parts)
    with archive.open(entry, "w") as file:
        if deflated:
            file._compressor = _Whole()  # type: ignore[attr-defined]  # zipfile takes no other
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
                _add(archive, f"{name}.npy", npy_parts(array), deflates(array))
            _add(archive, _META, [record], True)
        return Encoded({f"{frame.key}.npz": file.getvalue()})

    def decode(self, info: Info, record: Record, read: Callable[[str], bytes]) -> dict[str, Array]:
        """Its arrays."""
        (name,) = record["files"]
        with zipfile.ZipFile(io.BytesIO(read(name))) as archive:
            return {
                channel: from_npy(archive.read(f"{channel}.npy")) for channel in info["channels"]
            }
