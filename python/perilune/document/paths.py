"""Resolves paths in a configuration."""

from __future__ import annotations

import os
from difflib import get_close_matches
from pathlib import Path, PurePath

DATA_VARIABLE = "PERILUNE_DATA"
DATA_PREFIX = "data:"


_SHOWN = 8


def _near(path: Path) -> str:
    """`; did you mean ...` with entries of the last existing folder of the path."""
    if path.is_dir():
        return ", but a folder"
    parent, name = path.parent, path.name
    while not parent.is_dir() and parent != parent.parent:
        parent, name = parent.parent, parent.name
    there = sorted(entry.name for entry in parent.iterdir() if not entry.name.startswith("."))
    stems = {PurePath(entry).stem: entry for entry in there}
    close = get_close_matches(name, there, n=1, cutoff=0.6)
    close = close or get_close_matches(PurePath(name).stem, stems, n=1, cutoff=0.6)
    if close:
        return f"; did you mean '{stems.get(close[0], close[0])}'? (in {parent})"
    shown = ", ".join(there[:_SHOWN]) + (", ..." if len(there) > _SHOWN else "")
    return f"; {parent} holds {shown or 'nothing'}"


def resolve(text: str, base: Path, where: str) -> Path:
    """A path relative to `base`, or below PERILUNE_DATA after `data:`; `where` names it in errors.

    FileNotFoundError if there is no such file."""
    if not text.startswith(DATA_PREFIX):
        path = base / text
        if not path.is_file():
            raise FileNotFoundError(f"{where}: no such file: {path}{_near(path)}")
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
        if not Path(root).is_dir():
            wrong = f"{DATA_VARIABLE} is no folder: {root}"
            raise FileNotFoundError(f"{where}: '{text}': {wrong}; {how}")
        raise FileNotFoundError(f"{where}: '{text}': no such file: {path}{_near(path)}")
    return path
