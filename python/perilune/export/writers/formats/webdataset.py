"""WebDataset: tar shards with the channels of each frame as neighbouring members."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from pathlib import Path

from perilune.export.writers.formats.base import (
    Array,
    Encoded,
    Format,
    Frame,
    Info,
    PackReader,
    Record,
)
from perilune.export.writers.formats.channels import COLOR, Channel
from perilune.export.writers.formats.pixels import from_npy, from_png, npy, png
from perilune.export.writers.formats.tars import open_tar, write_tar


class WebDataset(Format):
    """Samples for sequential reading."""

    name = "webdataset"
    doc = "WebDataset: tar shards of --chunk-size frames, every channel as it is"
    layout = (
        "`shard-CCCCCC.tar` with `NNNNNN.CHANNEL.png` for pictures of 8 bits, "
        "`NNNNNN.CHANNEL.npy` for all others, and `NNNNNN.json`, the frame's record"
    )
    reader = "webdataset, and all that reads tar"
    pack_name = "shard-{chunk:06d}.tar"

    def holds(self, channel: Channel) -> bool:
        """Everything."""
        return True

    def encode(self, info: Info, frame: Frame) -> Encoded:
        """A member a channel."""
        files = {}
        for name, array in frame.arrays.items():
            picture = name in COLOR
            suffix = "png" if picture else "npy"
            files[f"{frame.key}.{name}.{suffix}"] = png(array) if picture else npy(array)
        files[f"{frame.key}.json"] = json.dumps(frame.record, sort_keys=True).encode("utf-8")
        return Encoded(files)

    def decode(self, info: Info, record: Record, read: Callable[[str], bytes]) -> dict[str, Array]:
        """All channels."""
        found = {}
        for file in record["files"]:
            _, name, *suffix = file.split(".")
            if suffix:
                found[name] = from_png(read(file)) if suffix == ["png"] else from_npy(read(file))
        return found

    def pack(self, info: Info, path: Path, members: Iterable[tuple[str, bytes]]) -> None:
        """A tar file."""
        write_tar(path, members)

    def unpack(self, path: Path) -> AbstractContextManager[PackReader]:
        """Opens a tar file."""
        return open_tar(path)
