"""Foreign writers: registered in code, installed as entry points, or named as module:function."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from perilune.base import hooks
from perilune.config.errors import nearest
from perilune.export.writers.table import WriteFunction, Writer, WriteReport
from perilune.simulation import Simulation

GROUP = "perilune.writers"
"""Group of entry points; each is the name of a format and its writer."""

_DEFAULTS: dict[str, Any] = {
    "chunk_size": 1000,
    "threads": None,
    "split": "train",
    "shard": None,
    "progress": None,
}


_HARMLESS = ("threads", "progress")
"""Options that do not change what is written."""


def _called(name: str, given: Any) -> WriteFunction:
    """The function that writes a format; a class is instantiated."""
    write = given() if isinstance(given, type) else given
    if not callable(write):
        raise TypeError(f"format '{name}': {given!r} is no function, and no class to be called")
    return write  # type: ignore[no-any-return]


def register(table: dict[str, Writer], name: str, write: Any, doc: str = "") -> None:
    """Puts a format into a table. ValueError for a name that is taken or invalid."""
    if not name or ":" in name or name.split() != [name]:
        raise ValueError(f"register: {name!r} is no name of a format")
    if name in table:
        raise ValueError(f"register: there is a format '{name}' already")
    function = _called(name, write)
    text = doc or next(iter((inspect.getdoc(write) or name).splitlines()), name)
    table[name] = Writer(name, text, function)


def formats(table: Mapping[str, Writer]) -> list[str]:
    """Names of all formats, including installed ones."""
    return list(dict.fromkeys([*table, *(point.name for point in entry_points(group=GROUP))]))


def find(table: Mapping[str, Writer], name: str) -> Writer:
    """The writer of a format, or of `module:function` (or `module:Class`).

    ValueError for one that does not exist, cannot be imported, or cannot be called."""
    if name in table:
        return table[name]
    for point in entry_points(group=GROUP):
        if point.name == name:
            try:
                return Writer(name, f"installed: {point.value}", _called(name, point.load()))
            except (ImportError, AttributeError, TypeError) as error:
                text = f"format '{name}', installed as {point.value}: {error}"
                raise ValueError(text) from error
    if ":" not in name:
        known = formats(table)
        raise ValueError(f"no format '{name}'{nearest(name, known)}, or module:function")
    try:
        return Writer(name, name, _called(name, hooks.load(name, "--format", _beside)))
    except TypeError as error:
        raise ValueError(str(error)) from error


def _beside(text: str, _: str) -> Path:
    """Makes modules in the current folder importable without PYTHONPATH."""
    path = Path.cwd() / text
    if not path.is_file():
        raise FileNotFoundError(text)
    return path


def write(
    writer: Writer, sim: Simulation, frames: range, out: str | Path, **options: Any
) -> WriteReport:
    """Calls a writer with those of the options that it takes (see WriteFunction).

    ValueError for a given option that it does not take; TypeError if it returns no WriteReport."""
    parameters = inspect.signature(writer.write).parameters
    takes_all = any(row.kind is row.VAR_KEYWORD for row in parameters.values())
    for name, value in options.items():
        ignored = not takes_all and name not in parameters and name not in _HARMLESS
        if ignored and value != _DEFAULTS[name]:
            key = name.replace("_", "-")
            raise ValueError(f"--{key}: the format '{writer.name}' does not take it")
    taken = {k: v for k, v in options.items() if takes_all or k in parameters}
    report = writer.write(sim, frames, out, **taken)
    if not isinstance(report, WriteReport):
        text = f"format '{writer.name}': must return a perilune.writers.WriteReport"
        raise TypeError(f"{text}, not {report!r}")
    return report
