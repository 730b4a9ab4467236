"""Perilune: annotated synthetic images of spacecraft, planets and the Moon's surface."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

from perilune.camera.poses import look_at
from perilune.dataset import Dataset, Stream, collate
from perilune.drivers import Driver
from perilune.sample import Sample
from perilune.simulation import Simulation, open  # noqa: A004 (perilune.open is the interface)

if TYPE_CHECKING:
    from perilune.export.writers import write_bop

__all__ = [
    "Dataset",
    "Driver",
    "Sample",
    "Simulation",
    "Stream",
    "collate",
    "look_at",
    "open",
    "write_bop",
]

try:
    __version__ = version("perilune")
except PackageNotFoundError:  # run from a source tree that is not installed
    __version__ = "0+unknown"


def __getattr__(name: str) -> Any:
    """Writers are loaded when first asked for."""
    if name == "write_bop":
        from perilune.export.writers import write_bop

        return write_bop
    raise AttributeError(f"module 'perilune' has no attribute '{name}'")
