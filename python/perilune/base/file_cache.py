"""What was read of files last, for all simulations of a process: who opens a changed configuration
again does not read them again."""

from __future__ import annotations

import os
from collections import OrderedDict
from collections.abc import Callable
from pathlib import Path
from threading import Lock
from typing import Generic, TypeVar

T = TypeVar("T")

MOST_BYTES = 256 << 20
"""Memory of what a cache keeps at most."""

Key = tuple[object, ...]


class FileCache(Generic[T]):
    """Keeps what was asked for last. A file that has changed since is read again."""

    def __init__(self, bytes_of: Callable[[T], int], most_bytes: int = MOST_BYTES) -> None:
        """bytes_of: the memory of what was read."""
        self.most_bytes = most_bytes
        self._bytes_of = bytes_of
        self._kept: OrderedDict[Key, T] = OrderedDict()
        self._lock = Lock()
        os.register_at_fork(after_in_child=self._unlock)

    def _unlock(self) -> None:
        """For the child of a fork: the thread that held the lock is not there."""
        self._lock = Lock()

    def of(self, path: Path, options: Key, read: Callable[[], T]) -> T:
        """What a file holds, read if it is not there. options: all else that decides on it."""
        try:
            state = path.stat()
        except OSError:
            return read()  # which says what is wrong
        key = (path.resolve(), state.st_mtime_ns, state.st_size, state.st_ino, options)
        with self._lock:
            found = self._kept.get(key)
            if found is not None:
                self._kept.move_to_end(key)
                return found
        made = read()
        with self._lock:
            self._kept[key] = made
            self._evict()
        return made

    def _evict(self) -> None:
        kept = sum(map(self._bytes_of, self._kept.values()))
        while kept > self.most_bytes:
            kept -= self._bytes_of(self._kept.popitem(last=False)[1])
