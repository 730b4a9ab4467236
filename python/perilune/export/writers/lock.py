"""Locks on the scenes of a dataset's folder for one writer at a time, released when a process dies.

They are POSIX record locks on a hidden file: byte k stands for scene k, all bytes together for the
whole dataset. Shards in one folder lock the bytes of their own scenes. A lock file left by a killed
process locks nothing; the next holder of the whole dataset removes it."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import logging
import os
import struct
import sys
import threading
from collections.abc import Iterable, Iterator
from pathlib import Path

LOCK_FILE = ".lock"
_SCENES = 1_000_000
_ALL = (0, _SCENES + 1)
"""First byte and number of bytes for all scenes and the rest of the dataset."""

_log = logging.getLogger(__name__)

_guard = threading.Lock()
_mine: set[tuple[int, int, int]] = set()
"""Process, device and inode of held lock files, because record locks do not separate the threads of
a process."""

# struct flock of 64-bit Linux: l_type, l_whence, l_start, l_len, l_pid.
_FLOCK = "@hhqqi4x"
_NO_LOCKS = {errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP, errno.EINVAL}


class FolderInUseError(OSError):
    """Another process writes to the folder."""


def _runs(scenes: Iterable[int]) -> list[tuple[int, int]]:
    """Scene ids as runs: (first, count)."""
    found: list[tuple[int, int]] = []
    for scene in sorted(scenes):
        if found and sum(found[-1]) == scene:
            found[-1] = (found[-1][0], found[-1][1] + 1)
        else:
            found.append((scene, 1))
    return found


def _holder(descriptor: int, run: tuple[int, int]) -> int:
    """Id of a process that holds some of a run of bytes; 0 if unknown."""
    if not sys.platform.startswith("linux"):
        return 0
    asked = struct.pack(_FLOCK, fcntl.F_WRLCK, os.SEEK_SET, *run, 0)
    kind, _, _, _, pid = struct.unpack(_FLOCK, fcntl.fcntl(descriptor, fcntl.F_GETLK, asked))
    return int(pid) if kind != fcntl.F_UNLCK else 0


def in_use(root: Path, pid: int) -> FolderInUseError:
    """Message for a second writer. pid: that of the first, 0 if unknown."""
    who = f"process {pid}" if pid > 0 else "another process"
    if pid == os.getpid():
        who = "another thread of this process"
    return FolderInUseError(
        errno.EWOULDBLOCK,
        f"{who} is writing to it; wait until it is done, or write parts with --shard",
        str(root),
    )


def _take(root: Path, descriptor: int, runs: list[tuple[int, int]]) -> None:
    """Locks all runs; FolderInUseError if one is held by others."""
    for start, count in runs:
        try:
            fcntl.lockf(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB, count, start, os.SEEK_SET)
        except OSError as error:
            if error.errno in (errno.EACCES, errno.EAGAIN):
                raise in_use(root, _holder(descriptor, (start, count))) from None
            if error.errno not in _NO_LOCKS:
                raise
            _log.warning("%s: cannot be locked (%s): let no two runs write to it", root, error)
            return


def _name(root: Path) -> tuple[int, int, int] | None:
    """Identity of a lock file in this process; None if there is none."""
    try:
        about = os.stat(root / LOCK_FILE)
    except FileNotFoundError:
        return None
    return os.getpid(), about.st_dev, about.st_ino


def _open(root: Path) -> tuple[int, tuple[int, int, int]]:
    """Descriptor and identity of the lock file."""
    descriptor = os.open(root / LOCK_FILE, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
    about = os.fstat(descriptor)
    return descriptor, (os.getpid(), about.st_dev, about.st_ino)


def _remove_if_last(root: Path, descriptor: int) -> None:
    with contextlib.suppress(OSError):
        start, count = _ALL
        fcntl.lockf(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB, count, start, os.SEEK_SET)
        os.unlink(root / LOCK_FILE)


@contextlib.contextmanager
def locked(root: Path, scenes: Iterable[int] | None = None) -> Iterator[None]:
    """Holds some scenes of a dataset's folder, or all of it (None), within the context.

    FolderInUseError, which names the process, if another holds any of them."""
    runs = [_ALL] if scenes is None else _runs(scenes)
    with _guard:
        # Closing any descriptor of a file drops all record locks of the process, so the file is
        # opened under the guard, and not at all where this process holds some of it.
        while True:
            if _name(root) in _mine:
                raise in_use(root, os.getpid())
            descriptor, key = _open(root)
            try:
                _take(root, descriptor, runs)
            except BaseException:
                os.close(descriptor)
                raise
            if _name(root) == key:
                break
            os.close(descriptor)  # another has removed the file since: a lock on it is in vain
        _mine.add(key)
    try:
        yield
    finally:
        with _guard:
            _mine.discard(key)
            _remove_if_last(root, descriptor)
            os.close(descriptor)


def writing_process(root: Path) -> int | None:
    """Id of a process that writes to the folder, 0 if unknown; None if there is none."""
    try:
        with _guard:
            if _name(root) in _mine:
                return os.getpid()
            descriptor = os.open(root / LOCK_FILE, os.O_RDWR | os.O_CLOEXEC)
            try:
                fcntl.lockf(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB, _ALL[1], 0, os.SEEK_SET)
            except OSError as error:
                if error.errno in (errno.EACCES, errno.EAGAIN):
                    return _holder(descriptor, _ALL)
            finally:
                os.close(descriptor)
    except OSError:
        pass
    return None
