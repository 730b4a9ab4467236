"""`perilune check`: validates a written dataset against itself."""

from __future__ import annotations

import json
from argparse import ArgumentParser, Namespace
from dataclasses import asdict
from typing import Any

from perilune.check import Report, check_bop
from perilune.cli.command import FAILED, OK, Command
from perilune.cli.progress import Bar


def _configure(parser: ArgumentParser) -> None:
    parser.add_argument("folder", metavar="DIR", help="folder of the dataset")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def _counted(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _as_json(report: Report) -> dict[str, Any]:
    return {
        "folder": str(report.folder),
        "scenes": report.scenes,
        "images": report.images,
        "instances": report.instances,
        "findings": [asdict(finding) for finding in report.findings],
    }


def _run(args: Namespace) -> int:
    with Bar() as bar:
        report = check_bop(args.folder, bar)
    if args.json:
        print(json.dumps(_as_json(report), indent=2))
    else:
        for finding in report.findings:
            print(f"{finding.file}: {finding.reason}")
        looked = ", ".join(
            _counted(count, noun)
            for count, noun in (
                (report.scenes, "scene"),
                (report.images, "image"),
                (report.instances, "instance"),
            )
        )
        print(f"{report.folder}: {looked}; {_counted(len(report.findings), 'finding')}")
    return FAILED if report.findings else OK


CHECK = Command(
    "check", "validates a written dataset against itself; exit code 1 on findings", _configure, _run
)
