"""HDF5: a file for the frames of a chunk, a group a frame, a compressed data set a channel."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from perilune import _core
from perilune.config.errors import ConfigError
from perilune.export.writers.formats.base import (
    Array,
    Encoded,
    Format,
    Frame,
    Info,
    PackReader,
    Record,
)
from perilune.export.writers.formats.channels import Channel
from perilune.export.writers.formats.pixels import deflates, from_npy, npy
from perilune.simulation import Simulation

_RECORD = "record"


def _bytes_of_texts(array: Array) -> Array:
    """A table whose texts are UTF-8 bytes: HDF5 has no others of a fixed length."""
    if array.dtype.names is None:
        return array
    rows = np.asarray(array)
    columns = {
        name: np.char.encode(rows[name], "utf-8") if rows.dtype[name].kind == "U" else rows[name]
        for name in array.dtype.names
    }
    dtype = np.dtype(
        [
            (name, column.dtype, rows.dtype[name].shape)
            if rows.dtype[name].kind != "U"
            else (name, column.dtype.str if rows.size else "S1")
            for name, column in columns.items()
        ]
    )
    table = np.empty(rows.shape, dtype=dtype)
    for name, column in columns.items():
        table[name] = column
    return table


_CHUNK_BYTES = 1 << 20
"""Of a chunk, at most, unless a row has more: what HDF5 keeps in memory by default."""


def _write(group: Any, name: str, array: Array) -> None:
    """A data set; compressed by libdeflate, which takes a part of the time of HDF5's own filter,
    and which that reads."""
    if not array.size or array.dtype.names is not None or not deflates(array):
        group.create_dataset(name, data=array, track_times=False)
        return
    rows = max(1, min(len(array), _CHUNK_BYTES * len(array) // array.nbytes))
    data = group.create_dataset(
        name,
        shape=array.shape,
        dtype=array.dtype,
        chunks=(rows, *array.shape[1:]),
        compression="gzip",
        compression_opts=1,
        shuffle=True,
        track_times=False,
    )
    for start in range(0, len(array), rows):
        chunk = np.zeros((rows, *array.shape[1:]), dtype=array.dtype)  # whole, also the last one
        part = array[start : start + rows]
        chunk[: len(part)] = part
        shuffled = chunk.reshape(-1, 1).view(np.uint8).T.ravel()  # as the filter does
        stream = _core.deflate(shuffled, True)
        data.id.write_direct_chunk((start, *(0,) * (array.ndim - 1)), stream)


class Hdf5(Format):
    """Arrays for random access."""

    name = "hdf5"
    doc = "HDF5: a file for --chunk-size frames, every channel as it is (needs perilune[hdf5])"
    layout = (
        "`frames-CCCCCC.h5`: a group `NNNNNN` a frame with a data set a channel, and `record`, "
        "the frame's record as JSON in UTF-8; texts in tables are UTF-8"
    )
    reader = "h5py, and all that reads HDF5"
    pack_name = "frames-{chunk:06d}.h5"

    def holds(self, channel: Channel) -> bool:
        """Everything."""
        return True

    def describe(self, sim: Simulation) -> dict[str, Any]:
        """Nothing, if there is h5py."""
        try:
            import h5py  # noqa: F401
        except ImportError:
            text = "format 'hdf5': needs h5py: pip install 'perilune[hdf5]'"
            raise ConfigError(text) from None
        return {}

    def encode(self, info: Info, frame: Frame) -> Encoded:
        """NPY files, of which `pack` makes data sets."""
        files = {
            f"{frame.key}/{name}.npy": npy(_bytes_of_texts(array))
            for name, array in frame.arrays.items()
        }
        text = json.dumps(frame.record, sort_keys=True)
        return Encoded({**files, f"{frame.key}/{_RECORD}.json": text.encode("utf-8")})

    def decode(self, info: Info, record: Record, read: Callable[[str], bytes]) -> dict[str, Array]:
        """All channels."""
        names = [name for name in record["files"] if name.endswith(".npy")]
        return {Path(name).stem: from_npy(read(name)) for name in names}

    def pack(self, info: Info, path: Path, members: Iterable[tuple[str, bytes]]) -> None:
        """Writes the file: without dates, so that the same members give the same bytes."""
        import h5py

        with h5py.File(path, "w", libver=("v110", "v110")) as file:
            for name, data in members:
                key, _, leaf = name.partition("/")
                group = file.require_group(key)
                if name.endswith(".json"):
                    group.create_dataset(
                        _RECORD, data=np.frombuffer(data, np.uint8), track_times=False
                    )
                    continue
                array = from_npy(data)
                _write(group, Path(leaf).stem, array)

    @contextmanager
    def unpack(self, path: Path) -> Iterator[PackReader]:
        """Opens the file."""
        import h5py

        with h5py.File(path, "r") as file:
            yield _Reader(file)


def _without_metadata(array: Array) -> Array:
    """An array without what h5py notes in the types of texts, which NPY cannot keep."""
    fields = array.dtype.fields
    if fields is None:
        return array.view(array.dtype.str)
    columns = [(name, field[0].base.str, field[0].shape) for name, field in fields.items()]
    return array.astype(np.dtype(columns))  # a copy: equal types are not replaced


class _Reader:
    """Members of a file as they were before packing."""

    def __init__(self, file: Any) -> None:
        self._file = file

    def names(self) -> Sequence[str]:
        """Names of all members."""
        return [
            f"{key}/{name}.{'json' if name == _RECORD else 'npy'}"
            for key, group in self._file.items()
            for name in group
        ]

    def read(self, name: str) -> bytes:
        """Content of a member."""
        array = self._file[str(Path(name).with_suffix(""))][()]
        return bytes(array.tobytes()) if name.endswith(".json") else npy(_without_metadata(array))
