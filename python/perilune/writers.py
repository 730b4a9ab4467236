"""Writers of datasets: those that come with Perilune, and the registry of others."""

from perilune.export.writers import (
    WRITERS,
    FolderInUseError,
    Progress,
    WriteFunction,
    Writer,
    WriteReport,
    find,
    merge,
    merge_bop,
    register,
    write,
    write_bop,
)

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
