"""Tells whether a folder belongs to a simulation."""

from __future__ import annotations

import json
import logging
from pathlib import Path
from typing import Any

from perilune.export.writers.begin import changed_keys
from perilune.simulation import Simulation

_log = logging.getLogger(__name__)


def check_same_source(path: Path, info: dict[str, Any], sim: Simulation) -> bool:
    """True if the folder belongs to this very source, False if it is new; otherwise an error. Warns
    of other versions."""
    found = refuse_other_source(path, info, sim)
    if found is None:
        return False
    if found.get("versions") != info.get("versions"):
        _log.warning("%s: was begun with other versions: %s", path.parent, found.get("versions"))
    return True


def refuse_other_source(path: Path, info: dict[str, Any], sim: Simulation) -> dict[str, Any] | None:
    """ValueError for the folder of another source. Returns what it says, None if it is new."""
    try:
        found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    except (FileNotFoundError, NotADirectoryError):  # of a file that stands there make_folder tells
        return None
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise ValueError(
            f"{path}: is not JSON ({error}); remove it or use another folder"
        ) from error
    for key in sorted({*info, *found} - {"versions"}):
        if found.get(key) != info.get(key):
            changed = changed_keys(path.parent, sim.document.tree)
            if changed and key not in ("chunk_size", "seed", "split", "format"):
                raise ValueError(
                    f"{path.parent}: holds a dataset of another configuration: {changed}; use "
                    "another folder, or remove this one"
                )
            raise ValueError(
                f"{path.parent}: holds a dataset with another {key} ({found.get(key)!r}, here "
                f"{info.get(key)!r}); use another folder, or remove this one"
            )
    return found
