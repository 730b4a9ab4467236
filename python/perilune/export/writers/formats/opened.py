"""Finds the datasets in a folder, and their formats."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from perilune.config.errors import nearest
from perilune.export.writers.files import SOURCE_FILE
from perilune.export.writers.formats.tables import FORMATS

FORMAT_KEY = "format"
"""Key of dataset_info.json; BOP's scene folders have none."""


def format_folders(root: Path) -> list[str]:
    """Where datasets are in a folder: ["."], or the folders of several formats.

    FileNotFoundError if there is none."""
    if (root / SOURCE_FILE).is_file() or not root.is_dir():
        return ["."]
    names = sorted(path.parent.name for path in root.glob(f"*/{SOURCE_FILE}"))
    return names or ["."]


def known_format(root: Path, info: Mapping[str, Any]) -> str:
    """Name of a dataset's format; ValueError for one that is not known."""
    name = str(info[FORMAT_KEY])
    if name not in FORMATS:
        near = nearest(name, list(FORMATS))
        raise ValueError(f"{root / SOURCE_FILE}: format: there is no '{name}'{near}")
    return name
