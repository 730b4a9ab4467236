"""Perilune: annotated synthetic images of spacecraft, planets and the Moon's surface.

Names and modules are loaded when they are first asked for."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from perilune.base.version import VERSION as __version__  # noqa: N811
    from perilune.camera.poses import look_at
    from perilune.dataset import Dataset, Stream, collate
    from perilune.drivers import Driver
    from perilune.opening import open  # noqa: A004 (perilune.open is the interface)
    from perilune.sample import Sample
    from perilune.simulation import Simulation
    from perilune.writers import write_bop

__all__ = [
    "Dataset",
    "Driver",
    "Sample",
    "Simulation",
    "Stream",
    "__version__",
    "collate",
    "look_at",
    "open",
    "write_bop",
]

_HOMES = {
    "Dataset": "perilune.dataset",
    "Driver": "perilune.drivers",
    "Sample": "perilune.sample",
    "Simulation": "perilune.simulation",
    "Stream": "perilune.dataset",
    "collate": "perilune.dataset",
    "look_at": "perilune.camera.poses",
    "open": "perilune.opening",
    "write_bop": "perilune.writers",
}
"""Name -> the module that defines it."""


def __getattr__(name: str) -> Any:
    """A name of the table, or a module of the package."""
    if name == "__version__":
        found: Any = import_module("perilune.base.version").VERSION
    elif name in _HOMES:
        found = getattr(import_module(_HOMES[name]), name)
    else:
        path = f"perilune.{name}"
        try:
            found = import_module(path) if name == "_core" or name[0] != "_" else None
        except ModuleNotFoundError as error:
            if error.name != path:  # it is there; what it needs is not
                raise
            found = None
        if found is None:
            raise AttributeError(f"module 'perilune' has no attribute '{name}'")
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
