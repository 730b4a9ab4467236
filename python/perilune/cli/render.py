"""`perilune render`: writes frames as a dataset."""

from __future__ import annotations

import sys
import time
from argparse import ArgumentParser, Namespace
from typing import Any

from tqdm import tqdm

from perilune.cli.command import INTERRUPTED, OK, Command
from perilune.cli.options import (
    add_config,
    add_threads,
    frame_range,
    open_simulation,
    whole_number,
)
from perilune.writers import WRITERS


class _Bar:
    """A progress bar that counts only this run's frames in its rate; silent without a terminal."""

    def __init__(self) -> None:
        self.done = 0
        self.total = 0
        self._bar: tqdm[Any] | None = None

    def __call__(self, done: int, total: int) -> None:
        self.done, self.total = done, total
        bar = self._bar
        if bar is None:
            # Frames of an earlier run are the bar's start, so that they do not count in its rate.
            self._bar = bar = tqdm(
                total=total, initial=done, unit="img", disable=None, dynamic_ncols=True
            )
        bar.update(done - bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()


def _configure(parser: ArgumentParser) -> None:
    add_config(parser)
    parser.add_argument(
        "--frames",
        type=frame_range,
        required=True,
        metavar="FIRST:END",
        help="frames to write: N, FIRST:END or FIRST:END:STEP; END is left out",
    )
    parser.add_argument("--out", required=True, metavar="DIR", help="folder of the dataset")
    formats = "; ".join(f"{row.name}: {row.doc}" for row in WRITERS.values())
    parser.add_argument(
        "--format", choices=list(WRITERS), default=next(iter(WRITERS)), help=formats
    )
    parser.add_argument(
        "--chunk-size",
        type=whole_number(1),
        default=1000,
        metavar="N",
        help="images a scene folder (default: %(default)s)",
    )
    add_threads(parser)


def _run(args: Namespace) -> int:
    sim = open_simulation(args)
    bar = _Bar()
    start = time.perf_counter()
    try:
        report = WRITERS[args.format].write(
            sim,
            args.frames,
            args.out,
            chunk_size=args.chunk_size,
            threads=args.threads,
            progress=bar,
        )
    except KeyboardInterrupt:
        bar.close()
        print(
            f"perilune render: interrupted; about {bar.done} of {len(args.frames)} frames are "
            f"finished in {args.out}; the same command continues",
            file=sys.stderr,
        )
        return INTERRUPTED
    finally:
        bar.close()
    seconds = time.perf_counter() - start
    rate = f", {report.written / seconds:.2f} images/s" if report.written else ""
    print(f"{report.folder}: {report.written} frames written, {report.kept} kept{rate}")
    return OK


RENDER = Command(
    "render", "writes frames as a dataset; continues an interrupted one", _configure, _run
)
