"""Configurations, models, maps and materials that come with Perilune."""

from __future__ import annotations

import logging
from pathlib import Path

FOLDERS = ("configs", "assets")
"""Folders below `perilune/shipped` in a wheel, and at the root of a source tree."""

_log = logging.getLogger(__name__)


def root() -> Path | None:
    """Folder that holds `configs` and `assets`; None if neither a wheel nor a source tree has
    them."""
    package = Path(__file__).resolve().parents[1]
    for folder in (package / "shipped", package.parents[1]):
        if all((folder / name).is_dir() for name in FOLDERS):
            return folder
    return None


def configurations() -> list[str]:
    """Names of the configurations that come with Perilune, such as `configs/demo.yaml`."""
    folder = root()
    if folder is None:
        return []
    found = [p for p in (folder / "configs").rglob("*") if p.suffix in (".yaml", ".json")]
    return sorted(path.relative_to(folder).as_posix() for path in found)


def configuration(path: Path) -> Path:
    """The file at `path`, or else the shipped configuration of that name.

    So `configs/demo.yaml` opens from any folder, and a user's file of that name takes
    precedence."""
    if path.is_absolute() or path.exists() or path.as_posix() not in configurations():
        return path
    found = (root() or Path()) / path
    _log.info("%s: no such file here; reading the one that comes with Perilune: %s", path, found)
    return found
