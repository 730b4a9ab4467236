"""`perilune merge`: joins the shards of a dataset."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from perilune.cli.command import OK, Command
from perilune.export.writers import merge


def _configure(parser: ArgumentParser) -> None:
    parser.add_argument(
        "folders",
        nargs="+",
        metavar="DIR",
        help="folders that `perilune render --shard` has written to",
    )
    parser.add_argument(
        "--out", metavar="DIR", help="folder of the whole dataset (default: the only DIR)"
    )


def _run(args: Namespace) -> int:
    for report in merge(args.folders, args.out):
        print(f"{report.folder}: {report.scenes} scenes, {report.images} images, complete")
    return OK


MERGE = Command(
    "merge", "joins shards after checking them, writes targets and card", _configure, _run
)
