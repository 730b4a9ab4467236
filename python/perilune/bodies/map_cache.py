"""Maps of files that were read last, for all simulations of a process: who opens a changed
configuration again does not read and filter its pictures again."""

from __future__ import annotations

import os
from collections import OrderedDict
from collections.abc import Callable
from pathlib import Path
from threading import Lock

from perilune import _core

_MOST_BYTES = 256 << 20
"""Memory of the maps to keep at most."""

Key = tuple[object, ...]
Read = tuple[_core.Map, tuple[str, ...]]
"""A map, and the remarks of its reader."""


class MapCache:
    """Keeps the maps that were asked for last. A file that has changed since is read again."""

    def __init__(self, most_bytes: int = _MOST_BYTES) -> None:
        self._most = most_bytes
        self._kept: OrderedDict[Key, Read] = OrderedDict()
        self._lock = Lock()

    def unlock(self) -> None:
        """For the child of a fork: the thread that held the lock is not there."""
        self._lock = Lock()

    def of(self, path: Path, options: Key, read: Callable[[], Read]) -> Read:
        """The map of a file, read if it is not there. options: all else that decides on it."""
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
        kept = sum(made.nbytes for made, _ in self._kept.values())
        while kept > self._most:
            _, (made, _) = self._kept.popitem(last=False)
            kept -= made.nbytes


MAPS = MapCache()
"""That of this process."""
os.register_at_fork(after_in_child=MAPS.unlock)
