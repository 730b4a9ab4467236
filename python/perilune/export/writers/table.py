"""Types of the table of writers: a format's name, description, and function."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from perilune.simulation import Simulation

Progress = Callable[[int, int], None]
"""Called with (frames on disk, frames requested): once at the start, then after each frame."""


@dataclass(frozen=True)
class WriteReport:
    """Result of a writer."""

    folder: Path
    written: int
    """Number of frames rendered and written by this call."""
    kept: int
    """Number of frames that an earlier call had finished."""


class WriteFunction(Protocol):
    """Writes frames of a simulation to a folder; may be interrupted and called again."""

    def __call__(
        self,
        sim: Simulation,
        frames: range,
        out: str | Path,
        *,
        chunk_size: int = ...,
        threads: int | None = ...,
        split: str = ...,
        shard: tuple[int, int] | None = ...,
        progress: Progress | None = ...,
    ) -> WriteReport: ...


@dataclass(frozen=True)
class Writer:
    """One row of the table."""

    name: str
    doc: str
    write: WriteFunction
    holds: Callable[[Any], bool] | None = None
    """Whether it can hold a channel (formats.channels.Channel); None: it says nothing of it."""
    opener: Any = None
    """A run.Opener; None for formats that cannot be written beside others."""
