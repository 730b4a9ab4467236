"""The one door to TIFF files: tifffile, an extra of the package, loaded when a file needs it."""

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
    """The first image of a file, open while the context is.

    Raises ModuleNotFoundError where tifffile is not installed, and what tifffile raises for a
    broken file. Its reports of odd tags, none of which is read here, are left out.
    """
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
