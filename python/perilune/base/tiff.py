"""Reads TIFF files through tifffile, an extra of the package, loaded when a file needs it."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tifffile import TiffPage

_LOG = logging.getLogger("tifffile")


@contextmanager
def first_page(path: Path) -> Iterator[TiffPage]:
    """The first image of a file, open within the context.

    Raises ModuleNotFoundError if tifffile is not installed, and the errors of tifffile for a broken
    file. Its messages about odd tags are suppressed, because none of these is read here."""
    try:
        from tifffile import TiffFile, TiffPage
    except ModuleNotFoundError:
        text = "TIFF files need the package tifffile: pip install 'perilune[tiff]'"
        raise ModuleNotFoundError(text, name="tifffile") from None
    level = _LOG.level
    _LOG.setLevel(logging.CRITICAL)
    try:
        with TiffFile(path) as file:
            page = file.pages[0]
            assert isinstance(page, TiffPage)
            yield page
    finally:
        _LOG.setLevel(level)
