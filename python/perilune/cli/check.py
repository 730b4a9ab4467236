"""`perilune check`: validates a written dataset against itself and against its configuration."""

from __future__ import annotations

import json
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from dataclasses import asdict
from typing import Any

from perilune.cli.command import FAILED, OK, Command
from perilune.cli.progress import Bar
from perilune.export.check import RERENDERED, Report, check

_ALL = "all"


def _rerender(text: str) -> int | None:
    """Images to render in full; None for all."""
    if text == _ALL:
        return None
    if not text.isdecimal():
        raise ArgumentTypeError(f"must be a number of images or '{_ALL}', not '{text}'")
    return int(text)


def _configure(parser: ArgumentParser) -> None:
    parser.add_argument("folder", metavar="DIR", help="folder of the dataset")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument(
        "--rerender",
        metavar=f"N|{_ALL}",
        type=_rerender,
        default=RERENDERED,
        help="number of images, evenly spread, to render again in full and compare to the byte "
        f"(default: {RERENDERED}); others are compared at few samples, and in full if they differ",
    )
    parser.add_argument(
        "--base",
        metavar="DIR",
        help="folder that paths of the configuration refer to (default: the one recorded in the "
        "dataset)",
    )
    parser.add_argument(
        "--alone",
        action="store_true",
        help="check the dataset only against itself, without rendering from its configuration",
    )


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _as_json(report: Report) -> dict[str, Any]:
    return {
        "folder": str(report.folder),
        "scenes": report.scenes,
        "images": report.images,
        "instances": report.instances,
        "findings": [asdict(finding) for finding in report.findings],
        "more": [
            {**asdict(finding), "count": report.more(finding)}
            for finding in report.findings
            if report.more(finding)
        ],
        "total": report.total,
        "notes": report.notes,
    }


def _told(report: Report) -> str:
    lines = []
    for finding in report.findings:
        lines.append(f"{finding.file}: {finding.reason}")
        more = report.more(finding)
        if more:
            lines.append(f"  and {_counted(more, 'finding')} more of this kind")
    lines += [f"note: {text}" for text in report.notes]
    looked = ", ".join(
        _counted(count, noun)
        for count, noun in (
            (report.scenes, "scene"),
            (report.images, "image"),
            (report.instances, "instance"),
        )
    )
    return "\n".join([*lines, f"{report.folder}: {looked}; {_counted(report.total, 'finding')}"])


def _run(args: Namespace) -> int:
    with Bar() as bar:
        reports = check(args.folder, bar, rerender=args.rerender, base=args.base, alone=args.alone)
    if args.json:
        told = [_as_json(report) for report in reports]
        print(json.dumps(told[0] if len(told) == 1 else told, indent=2))
    else:
        print("\n".join(_told(report) for report in reports))
    return FAILED if any(report.findings for report in reports) else OK


CHECK = Command(
    "check",
    "validates a written dataset against itself and its configuration; exit code 1 on findings",
    _configure,
    _run,
)
