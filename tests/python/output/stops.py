"""Stops of a writer at its n-th operation on files: a signal, or a kill that nothing survives."""

from __future__ import annotations

import hashlib
import os
import sys
from pathlib import Path

from perilune import _core
from perilune.export.writers import queue

EVENTS = {
    "open": (0,),
    "os.rename": (0,),
    "os.remove": (0,),
    "os.rmdir": (0,),
    "os.mkdir": (0,),
    "os.link": (0, 1),
    "os.listdir": (0,),
    "os.scandir": (0,),
}
"""Audited operations, and which of their arguments are paths."""

DONE, STOPPED = 0, 77


class Canned:
    """A simulation whose frames are rendered already."""

    def __init__(self, sim, frames, channels):
        self._sim = sim
        self._samples = {index: sim.frame(index, channels=channels) for index in frames}
        self.rendered = []

    def __getattr__(self, name):
        return getattr(self._sim, name)

    def frame(self, index, **options):
        self.rendered.append(index)
        return self._samples[index]


def tree_bytes(folder):
    """Relative path -> hash of every file, hidden ones too; folders without a file as well."""
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        if path.is_file()
        else "folder"
        for path in sorted(folder.rglob("*"))
    }


def _stopper(root, at, kill):
    """A function to call before every operation: it stops the process, or raises, at one."""
    count = 0

    def operation():
        nonlocal count
        count += 1
        if count == at:
            if kill:
                os.kill(os.getpid(), 9)
            raise KeyboardInterrupt
        return count

    def audit(event, arguments):
        if event in EVENTS:
            for k in EVENTS[event]:
                value = arguments[k]
                if isinstance(value, (str, bytes, os.PathLike)):
                    path = os.fsdecode(value)
                    if path.startswith(str(root)) and not path.endswith("/.lock"):
                        operation()

    png_write = _core.png_write

    def cut_png(path, array, level=6):
        operation()
        Path(f"{path}.{os.getpid()}.0.tmp").write_bytes(b"\x89PNG half")
        operation()
        Path(f"{path}.{os.getpid()}.0.tmp").unlink()
        png_write(path, array, level)
        operation()

    _core.png_write = cut_png
    fsync = os.fsync

    def counted_fsync(descriptor):
        operation()  # and does no more: a kill leaves what the kernel has

    os.fsync = counted_fsync
    del fsync
    queue.WORKERS = 1  # one order of operations
    sys.addaudithook(audit)
    return lambda: count


def run_until(root, at, kill, task):
    """Runs `task` in a child that stops at its operation number `at` on files below `root`.

    Returns how many there were if it came to its end, else None."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        code = STOPPED
        try:
            count = _stopper(root, at, kill)
            task()
            os.write(write, str(count()).encode())
            code = DONE
        except KeyboardInterrupt:
            pass
        except BaseException as error:  # told by the parent
            os.write(write, f"!{type(error).__name__}: {error}".encode())
        finally:
            os._exit(code)
    os.close(write)
    with os.fdopen(read, "rb") as pipe:
        told = pipe.read().decode()
    os.waitpid(child, 0)
    assert not told.startswith("!"), told
    return int(told) if told else None
