"""Writers of datasets to disk. A new format is its own file and one line of formats/tables.py.

Other formats are registered in code (`register`), installed as entry points of the group
`perilune.writers`, or named as `module:function`."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from perilune.export.writers import plugins
from perilune.export.writers.begin import as_range
from perilune.export.writers.bop import open_bop, write_bop
from perilune.export.writers.formats.merge import merge_folders
from perilune.export.writers.formats.opened import FORMAT_KEY, format_folders, known_format
from perilune.export.writers.formats.tables import FORMATS
from perilune.export.writers.lock import FolderInUseError
from perilune.export.writers.merge import MergeReport, check_one_source, merge_bop
from perilune.export.writers.several import write_formats, writer_of
from perilune.export.writers.table import Progress, WriteFunction, Writer, WriteReport
from perilune.simulation import Simulation

__all__ = [
    "WRITERS",
    "FolderInUseError",
    "Progress",
    "WriteFunction",
    "WriteReport",
    "Writer",
    "find",
    "merge",
    "merge_bop",
    "register",
    "write",
    "write_bop",
]

WRITERS: dict[str, Writer] = {
    row.name: row
    for row in (
        Writer(
            "bop",
            "BOP scene folders: images, depth, masks, boxes, poses, COCO annotations and models",
            write_bop,
            lambda channel: True,  # a folder each for what BOP does not define
            open_bop,
        ),
        *(writer_of(fmt, lambda: WRITERS) for fmt in FORMATS.values()),
    )
}
"""Every format that `perilune render --format` writes."""


def write(
    formats: str | Sequence[str],
    sim: Simulation,
    frames: range | Sequence[int],
    out: str | Path,
    **options: Any,
) -> WriteReport:
    """Writes frames in one format, or in several ("bop,coco", or a list) in one pass of rendering.

    One format is written to the folder `out`, each of several to a folder of its name below it.
    options: chunk_size, threads, split, shard, progress, as for write_bop; so are the errors.
    ConfigError for a channel in render.channels that none of the formats can hold; ValueError for
    an unknown format, or several of which one is a function that knows nothing of others."""
    names = formats.split(",") if isinstance(formats, str) else list(formats)
    rows = [find(name) for name in dict.fromkeys(names)]
    if not rows:
        raise ValueError(f"format: must name one of {', '.join(WRITERS)}")
    foreign = [row.name for row in rows if row.opener is None]
    if len(rows) > 1 and foreign:
        raise ValueError(f"format '{foreign[0]}': cannot be written beside others; write it alone")
    if foreign:
        return plugins.write(rows[0], sim, as_range(frames), out, **options)
    return write_formats(rows, WRITERS, sim, frames, out, **options)


def merge(folders: Sequence[str | Path], out: str | Path | None = None) -> list[MergeReport]:
    """Joins shards of any format to a dataset that is identical to that of a single run.

    folders: those that `write(..., shard=...)` has written to; of several formats, those above
    their folders. out: folder of the dataset; None completes the only folder in place. One report
    a format. Errors are those of merge_bop."""
    roots = [Path(folder) for folder in dict.fromkeys(map(str, folders))]
    if out is None and len(roots) != 1:
        raise ValueError(f"{len(roots)} folders to merge: --out must say where to")
    reports = []
    for name in format_folders(roots[0]):
        own = [root / name for root in roots]
        target = None if out is None else Path(out) / name
        source = check_one_source(own)
        if FORMAT_KEY in source:
            fmt = FORMATS[known_format(own[0], source)]
            reports.append(merge_folders(fmt, own, target, source))
        else:
            reports.append(merge_bop(own, target))
    return reports


def register(name: str, write: Any, doc: str = "") -> None:
    """Adds a format to those that `find` and `perilune render --format` know in this process.

    write: a function like `write_bop` (see WriteFunction), or a class whose instances are such
    functions. It receives those of the options chunk_size, threads, split, shard and progress that
    it has arguments for, and returns a WriteReport. doc: description in one line (default: the
    first line of its docstring). Raises ValueError for a name that is taken."""
    plugins.register(WRITERS, name, write, doc)


def find(name: str) -> Writer:
    """The writer of a format: of the table, registered, installed, or `module:function`.

    Raises ValueError for an unknown format."""
    return plugins.find(WRITERS, name)
