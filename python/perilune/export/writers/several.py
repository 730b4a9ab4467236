"""Writes one or several formats in one pass of rendering, none of whose channels gets lost."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from perilune.config.errors import ConfigError
from perilune.document.references import OBJECTS
from perilune.export.writers.begin import check_simulation
from perilune.export.writers.formats.base import Format
from perilune.export.writers.formats.channels import asked_channels, asked_scans, described
from perilune.export.writers.formats.folder import open_folder
from perilune.export.writers.run import write_datasets
from perilune.export.writers.table import Writer, WriteReport
from perilune.simulation import Simulation


def check_held(sim: Simulation, writers: Sequence[Writer], table: Mapping[str, Writer]) -> None:
    """ConfigError for a channel that is asked for and that none of the formats can hold."""
    channels, stated = asked_channels(sim)
    scanned = asked_scans(sim)
    asked = [*(channels if stated else []), *scanned]
    for name, channel in described(sim, asked).items():
        if name == OBJECTS or any(row.holds is None or row.holds(channel) for row in writers):
            continue
        can = [row.name for row in table.values() if row.holds is not None and row.holds(channel)]
        told = " and ".join(f"'{row.name}'" for row in writers)
        noun = "the format" if len(writers) == 1 else "the formats"
        key = "scans" if name in scanned else "channels"
        raise ConfigError(
            f"{sim.document.source}: render.{key}: {noun} {told} cannot hold '{name}'; these "
            f"can: {', '.join(can)} (several in one pass: --format {writers[0].name},{can[0]}); "
            "or leave it out"
        )


def write_formats(
    writers: Sequence[Writer],
    table: Mapping[str, Writer],
    sim: Simulation,
    frames: range | Sequence[int],
    out: str | Path,
    **options: Any,
) -> WriteReport:
    """Writes frames in some formats: in `out` one, in a folder of its name below it each of
    several.

    table: all formats, for errors. options: of write_datasets. For all else see write_bop."""
    check_simulation(sim)
    check_held(sim, writers, table)
    several = len(writers) > 1
    folders = [(Path(out) / row.name if several else out, row.opener) for row in writers]
    report = write_datasets(sim, frames, folders, **options)
    return WriteReport(Path(out), report.written, report.kept)


def writer_of(fmt: Format, table: Callable[[], Mapping[str, Writer]]) -> Writer:
    """The row of a format in a folder. table: all rows, once they are known."""

    def write(
        sim: Simulation, frames: range | Sequence[int], out: str | Path, **options: Any
    ) -> WriteReport:
        return write_formats([row], table(), sim, frames, out, **options)

    row = Writer(fmt.name, fmt.doc, write, fmt.holds, partial(open_folder, fmt))
    return row
