"""Files of text, read once and kept as long as they stay as they are."""

from __future__ import annotations

from pathlib import Path

Stamp = tuple[int, int]


def stamp(path: Path) -> Stamp:
    """Size and time of the last change: part of the key of a cache of what a file holds."""
    stat = path.stat()
    return stat.st_size, stat.st_mtime_ns


def text(path: Path) -> str:
    """What a file of UTF-8 text holds, without a byte order mark; ValueError that names it."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: not UTF-8 text: {error}") from None
