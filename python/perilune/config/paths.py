"""What file a path in a configuration means."""

from __future__ import annotations

import os
from pathlib import Path

DATA_VARIABLE = "PERILUNE_DATA"
DATA_PREFIX = "data:"


def resolve(text: str, base: Path, where: str) -> Path:
    """A path relative to `base`, or below PERILUNE_DATA after `data:`; `where` names it in errors.

    FileNotFoundError for what is no file.
    """
    if not text.startswith(DATA_PREFIX):
        path = base / text
        if not path.is_file():
            raise FileNotFoundError(f"{where}: no such file: {path}")
        return path
    root = os.environ.get(DATA_VARIABLE)
    how = (
        f"set the environment variable {DATA_VARIABLE} to the folder of the sample data, "
        f"for instance: export {DATA_VARIABLE}=/path/to/data"
    )
    if not root:
        raise FileNotFoundError(f"{where}: '{text}' needs the sample data; {how}")
    path = Path(root) / text.removeprefix(DATA_PREFIX).lstrip("/")
    if not path.is_file():
        raise FileNotFoundError(
            f"{where}: '{text}': no such file: {path} ({DATA_VARIABLE} is {root}); {how}"
        )
    return path
