"""The configurations, models, maps and materials that come with Perilune."""

from __future__ import annotations

import logging
from pathlib import Path

FOLDERS = ("configs", "assets")
"""What a wheel holds below `perilune/shipped`, as it lies at the root of a source tree."""

_log = logging.getLogger(__name__)


def root() -> Path | None:
    """The folder that holds `configs` and `assets`; None where neither a wheel nor a source
    tree has brought them."""
    package = Path(__file__).resolve().parents[1]
    for folder in (package / "shipped", package.parents[1]):
        if all((folder / name).is_dir() for name in FOLDERS):
            return folder
    return None


def configurations() -> list[str]:
    """The names of the configurations that come with Perilune, such as `configs/demo.yaml`."""
    folder = root()
    if folder is None:
        return []
    found = [p for p in (folder / "configs").rglob("*") if p.suffix in (".yaml", ".json")]
    return sorted(path.relative_to(folder).as_posix() for path in found)


def configuration(path: Path) -> Path:
    """The file that `path` means: itself, or else the shipped configuration of that name.

    So `configs/demo.yaml` opens in any folder, and a file of the user's with that name wins.
    """
    if path.is_absolute() or path.exists() or path.as_posix() not in configurations():
        return path
    found = (root() or Path()) / path
    _log.info("%s: no such file here; reading the one that comes with Perilune: %s", path, found)
    return found
