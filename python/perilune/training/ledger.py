"""A small file that a stream shares with its copies in the workers of a DataLoader.

Its first eight bytes count the positions begun by any process. Lines of JSON follow: changes of the
configuration, and the starts of workers' passes over the stream. Readers and writers hold a lock,
which the system releases when a process dies."""

from __future__ import annotations

import fcntl
import json
import os
import struct
import tempfile
import weakref
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import RLock
from typing import Any

_HEAD = struct.Struct("<q")


def _remove(path: str, owner: int) -> None:
    """Removes the file in the process that made it, not in its forks."""
    if os.getpid() == owner:
        with suppress(FileNotFoundError):
            os.unlink(path)


class Ledger:
    """Use within `with ledger.held():`. Each process opens the file itself."""

    def __init__(self, path: str | None = None) -> None:
        """path: file made by another process; default: a new file, removed with this object."""
        if path is None:
            made, path = tempfile.mkstemp(prefix="perilune-", suffix=".ledger")
            os.write(made, _HEAD.pack(0))
            os.close(made)
            weakref.finalize(self, _remove, path, os.getpid())
        self.path = path
        self.rows: list[dict[str, Any]] = []
        """All lines, as of the last time it was held."""
        self._lock = RLock()
        self._file: int | None = None
        self._pid = 0
        self._read = _HEAD.size

    @contextmanager
    def held(self) -> Iterator[None]:
        """Locks the file; `rows` are up to date."""
        with self._lock:
            if self._file is None or self._pid != os.getpid():
                # A fork shares the parent's open file, and with it its lock.
                self._file, self._pid = os.open(self.path, os.O_RDWR), os.getpid()
                weakref.finalize(self, _close, self._file, self._pid)
            fcntl.flock(self._file, fcntl.LOCK_EX)
            try:
                self._refresh()
                yield
            finally:
                fcntl.flock(self._file, fcntl.LOCK_UN)

    def _open(self) -> int:
        assert self._file is not None  # it is held
        return self._file

    def _refresh(self) -> None:
        size = os.fstat(self._open()).st_size
        if size <= self._read:
            return
        text = os.pread(self._open(), size - self._read, self._read)
        whole = text[: text.rfind(b"\n") + 1]
        self._read += len(whole)
        for line in whole.splitlines():
            with suppress(ValueError):  # half a line of a process that was killed
                self.rows.append(json.loads(line))

    def append(self, row: dict[str, Any]) -> None:
        """Adds a line."""
        end = os.fstat(self._open()).st_size
        # What a killed process left without its end becomes a line of its own, which is no JSON.
        start = b"\n" if end > self._read else b""
        os.pwrite(self._open(), start + json.dumps(row).encode() + b"\n", end)
        self._refresh()

    @property
    def begun(self) -> int:
        """Number of positions begun: all before it were."""
        return int(_HEAD.unpack(os.pread(self._open(), _HEAD.size, 0))[0])

    @begun.setter
    def begun(self, count: int) -> None:
        os.pwrite(self._open(), _HEAD.pack(count), 0)

    def is_there(self) -> bool:
        """Whether the process that made it still has it."""
        return Path(self.path).exists()


def _close(file: int, owner: int) -> None:
    if os.getpid() == owner:
        with suppress(OSError):
            os.close(file)
