"""One file for the frames of a chunk: staged, packed, and found again after a stop."""

from __future__ import annotations

import json
import shutil
import zlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from perilune.export.writers.files import (
    PARTIAL,
    TEMPORARY,
    json_text,
    load_object,
    sync_files,
    write_text,
)
from perilune.export.writers.formats import record as records
from perilune.export.writers.formats.base import Format, PackReader

CHUNKS = "chunks"
"""Folder with the sums of packed files."""


class Pack:
    """The packed file of a chunk, and the files of frames that are not in it yet."""

    def __init__(self, fmt: Format, root: Path, chunk: int, info: Mapping[str, Any]) -> None:
        if fmt.pack_name is None:
            raise ValueError(f"format '{fmt.name}' packs nothing")
        self._fmt, self._root, self._info = fmt, root, info
        self.path = root / fmt.pack_name.format(chunk=chunk)
        self.note = root / CHUNKS / f"{chunk:06d}.json"
        self._stage = root / PARTIAL / f"{chunk:06d}"
        self._packed: set[int] = set()
        self._staged: set[int] = set()

    def stage(self, index: int) -> Path:
        """Folder for the files of a frame until the chunk is packed."""
        self._staged.add(index)
        return self._stage

    def find(self, indices: Iterable[int]) -> set[int]:
        """Those of the frames whose files are intact, staged or packed."""
        with ExitStack() as held:
            reader = self._open(held)
            for index in indices:
                record = records.read(records.path_of(self._root, index))
                if record is None:
                    continue
                if self._holds(record, lambda name: (self._stage / name).read_bytes()):
                    self._staged.add(index)
                elif reader is not None and self._holds(record, reader.read):
                    self._packed.add(index)
        return self._staged | self._packed

    def _open(self, held: ExitStack) -> PackReader | None:
        try:
            return held.enter_context(self._fmt.unpack(self.path))
        except Exception:  # of damaged files, anything
            return None

    @staticmethod
    def _holds(record: Mapping[str, Any], read: Any) -> bool:
        try:
            return all(records.matches(read(n), stated) for n, stated in record["files"].items())
        except Exception:  # missing, or damaged in any way
            return False

    def is_complete(self, indices: list[int]) -> bool:
        """Whether the file is as its note says, with these frames, and nothing is staged."""
        note = load_object(self.note)
        if self._stage.exists() or note.get("frames") != indices:
            return False
        try:
            return file_sums(self.path) == note.get("file")
        except OSError:
            return False

    def complete(self, indices: list[int]) -> None:
        """Packs all frames, then removes what was staged."""
        if self.is_complete(indices):
            return
        temporary = self.path.with_name(f"{self.path.name}{TEMPORARY}")
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with ExitStack() as held:
            try:
                self._fmt.pack(self._info, temporary, self._members(indices, self._open(held)))
                sync_files([temporary])
            except OSError as error:
                temporary.unlink(missing_ok=True)
                reason = error.strerror or str(error)
                raise OSError(
                    error.errno, f"cannot be written: {reason}", str(self.path)
                ) from error
            except BaseException:
                temporary.unlink(missing_ok=True)
                raise
        temporary.replace(self.path)
        self.note.parent.mkdir(exist_ok=True)
        write_text(self.note, json_text({"frames": indices, "file": file_sums(self.path)}))
        if self._stage.exists():
            shutil.rmtree(self._stage)

    def _members(
        self, indices: list[int], reader: PackReader | None
    ) -> Iterator[tuple[str, bytes]]:
        for index in indices:
            record = json.loads(records.path_of(self._root, index).read_text(encoding="utf-8"))
            for name in record["files"]:
                if index in self._staged or reader is None:
                    yield name, (self._stage / name).read_bytes()
                else:
                    yield name, reader.read(name)


def file_sums(path: Path) -> dict[str, int]:
    """Length and CRC-32 of a file of any size."""
    total = crc = 0
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            crc = zlib.crc32(block, crc)
            total += len(block)
    return {"bytes": total, "crc32": crc}
