"""Files that are read once and kept as long as they stay as they are."""

from __future__ import annotations

from pathlib import Path

Stamp = tuple[int, int]


def stamp(path: Path) -> Stamp:
    """Size and time of the last change: part of the key of a cache of what a file holds."""
    stat = path.stat()
    return stat.st_size, stat.st_mtime_ns
