"""Writers of datasets to disk. A new format is its own file and one line of the table below.

Other formats are registered in code (`register`), installed as entry points of the group
`perilune.writers`, or named as `module:function`."""

from typing import Any

from perilune.export.writers import plugins
from perilune.export.writers.bop import write_bop
from perilune.export.writers.lock import FolderInUseError
from perilune.export.writers.merge import merge_bop
from perilune.export.writers.table import Progress, WriteFunction, Writer, WriteReport

__all__ = [
    "WRITERS",
    "FolderInUseError",
    "Progress",
    "WriteFunction",
    "WriteReport",
    "Writer",
    "find",
    "merge_bop",
    "register",
    "write_bop",
]

WRITERS: dict[str, Writer] = {
    row.name: row
    for row in (
        Writer(
            "bop",
            "BOP scene folders: images, depth, masks, boxes, poses, COCO annotations and models",
            write_bop,
        ),
    )
}
"""Every format that `perilune render --format` writes."""


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
