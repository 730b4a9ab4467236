"""Text files, cached until they change."""

from __future__ import annotations

from pathlib import Path

Stamp = tuple[int, int]


def stamp(path: Path) -> Stamp:
    """Size and time of the last change of a file, for keys of caches."""
    stat = path.stat()
    return stat.st_size, stat.st_mtime_ns


def text(path: Path) -> str:
    """Content of a UTF-8 file without a byte order mark; ValueError that names the file."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: not UTF-8 text: {error}") from None
