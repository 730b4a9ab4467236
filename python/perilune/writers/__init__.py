"""Writers of datasets to disk. A new format is its own file and one line of the table below."""

from perilune.writers.bop import write_bop
from perilune.writers.merge import merge_bop
from perilune.writers.table import Progress, Writer, WriteReport

__all__ = ["WRITERS", "Progress", "WriteReport", "Writer", "merge_bop", "write_bop"]

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
