"""`perilune cost`: what accuracy costs in a scene, and the setting for a wanted error."""

from __future__ import annotations

from argparse import ArgumentParser, ArgumentTypeError, Namespace
from pathlib import Path

from perilune.cli.command import FAILED, OK, Command
from perilune.cli.options import (
    add_config,
    add_frame,
    add_threads,
    open_simulation,
    whole_number,
)
from perilune.cli.progress import Bar


def _error(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise ArgumentTypeError(
            f"{text!r} is not a number of digital numbers, such as 1.0"
        ) from None
    if not 0.0 < value <= 255.0:
        raise ArgumentTypeError(f"{text!r}: must be above 0 and at most 255")
    return value


def _configure(parser: ArgumentParser) -> None:
    add_config(parser)
    add_frame(parser)
    parser.add_argument(
        "--target",
        type=_error,
        action="append",
        metavar="DN",
        help="RMS error to recommend a setting for; may be repeated (default: 4, 2 and 1)",
    )
    parser.add_argument("--quick", action="store_true", help="fewer settings and samples")
    parser.add_argument(
        "--reference-samples",
        type=whole_number(2, 65536),
        metavar="N",
        help="samples of each of the reference's two pictures (default: 16 times the "
        "configuration's, at least 512, or 128 with --quick)",
    )
    parser.add_argument(
        "--out",
        metavar="DIR",
        help="folder for cost.txt, cost.csv, cost.json, cost.png and what is measured: a run that "
        "was stopped goes on there",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    add_threads(parser)


def _run(args: Namespace) -> int:
    sim = open_simulation(args)
    with Bar("setting") as bar:
        report = sim.cost(
            args.frame,
            targets=args.target or (4.0, 2.0, 1.0),
            quick=args.quick,
            reference_samples=args.reference_samples,
            threads=args.threads,
            folder=args.out,
            progress=bar,
        )
    if args.out is not None:
        report.save(Path(args.out))
    print(report.json if args.json else report.text)
    return OK if all(advice.met for advice in report.advice) else FAILED


COST = Command("cost", "measures what accuracy costs, and recommends settings", _configure, _run)
