"""`perilune render`: writes frames as a dataset."""

from __future__ import annotations

import sys
import time
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Iterator

from perilune.cli.command import INTERRUPTED, OK, Command
from perilune.cli.options import (
    add_config,
    add_frames,
    add_threads,
    open_simulation,
    shard,
    whole_number,
)
from perilune.cli.progress import Bar
from perilune.export.writers import WRITERS, WriteReport, find, write
from perilune.export.writers.shards import chunks


def _formats(text: str) -> list[str]:
    names = text.split(",")
    try:
        for name in names:
            find(name)
    except ValueError as error:
        raise ArgumentTypeError(str(error)) from None
    return names


def _configure(parser: ArgumentParser) -> None:
    add_config(parser)
    add_frames(parser)
    parser.add_argument("--out", required=True, metavar="DIR", help="folder of the dataset")
    formats = "; ".join(f"{row.name}: {row.doc}" for row in WRITERS.values())
    parser.add_argument(
        "--format",
        type=_formats,
        default=next(iter(WRITERS)),
        metavar="NAME[,NAME]",
        help=f"{formats}; or an installed format, or module:function; several are written in one "
        "pass, each to a folder of its name below DIR (default: %(default)s)",
    )
    parser.add_argument(
        "--chunk-size",
        type=whole_number(1),
        default=1000,
        metavar="N",
        help="images per scene folder (default: %(default)s)",
    )
    parser.add_argument(
        "--split",
        default="train",
        metavar="NAME",
        help="folder of the scenes; `test` also gets target files (default: %(default)s)",
    )
    parser.add_argument(
        "--shard",
        type=shard,
        metavar="K/N",
        help="write only part K of N, K from 0 (whole scene folders); `perilune merge` joins parts",
    )
    add_threads(parser)


def _run(args: Namespace) -> int:
    sim = open_simulation(args)
    start = time.perf_counter()
    with Bar() as bar:
        try:
            report = write(
                args.format,
                sim,
                args.frames,
                args.out,
                chunk_size=args.chunk_size,
                threads=args.threads,
                split=args.split,
                shard=args.shard,
                progress=bar,
            )
        except KeyboardInterrupt:
            print(
                f"perilune render: interrupted; about {bar.done} of {bar.total} frames are "
                f"finished in {args.out}; the same command continues",
                file=sys.stderr,
            )
            return INTERRUPTED
    seconds = time.perf_counter() - start
    rate = f", {report.written / seconds:.2f} images/s" if report.written else ""
    print(f"{report.folder}: {report.written} frames written, {report.kept} kept{rate}")
    for note in _notes(args, report):
        print(f"note: {note}", file=sys.stderr)
    return OK


def _notes(args: Namespace, report: WriteReport) -> Iterator[str]:
    """What was asked for and is probably not meant."""
    if len(args.frames) == 1 and args.frames.start > 0:
        only = args.frames.start
        yield f"--frames says frame {only} alone; the first {only} are 0:{only}"
    if args.shard is not None and report.written + report.kept == 0:
        scenes = len(chunks(args.frames, args.chunk_size))
        yield (
            f"--shard {args.shard[0]}/{args.shard[1]} has no frames: shards take whole scene "
            f"folders, and there are {scenes} of them; a --chunk-size below {args.chunk_size} "
            "makes more"
        )


RENDER = Command(
    "render", "writes frames as a dataset; continues an interrupted one", _configure, _run
)
