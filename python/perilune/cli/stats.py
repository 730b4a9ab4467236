"""`perilune stats`: distributions of the contents of a written dataset."""

from __future__ import annotations

import json
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any

from perilune.cli.command import OK, Command
from perilune.cli.text_table import text_table
from perilune.export.stats import QUANTILES, measured
from perilune.export.writers.formats.opened import format_folders


def _configure(parser: ArgumentParser) -> None:
    parser.add_argument("folder", metavar="DIR", help="folder of the dataset")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument(
        "--figure",
        metavar="FILE",
        help="also draw histograms into a picture (needs perilune[plot]); of several formats, of "
        "the first",
    )


def _table(found: dict[str, Any]) -> str:
    head = ["", *(f"{q:.0%}" for q in QUANTILES), "mean"]
    lines = [f"{found['scenes']} scenes, {found['images']} images, {found['instances']} instances"]
    if "sensors" in found:
        lines.append(", ".join(f"{name}: {n} images" for name, n in found["sensors"].items()))
    for obj_id, quantities in found["objects"].items():
        rows = [
            [name, *(f"{value:.4g}" for value in numbers.values())]
            for name, numbers in quantities.items()
            if isinstance(numbers, dict)
        ]
        lines += ["", f"object {obj_id}: {quantities['instances']} instances"]
        lines.append(text_table(head, rows, head[1:]))
    return "\n".join(lines)


def _run(args: Namespace) -> int:
    root = Path(args.folder)
    every = {name: measured(root / name) for name in format_folders(root)}
    found = {name: statistics for name, (statistics, _) in every.items()}
    if args.figure is not None:
        from perilune.show.plots.statistics import plot_statistics

        _, objects = next(iter(every.values()))
        plot_statistics(objects, root.name).savefig(args.figure)
    if args.json:
        print(json.dumps(found.get(".", found), indent=2))
        return OK
    for name, rows in found.items():
        print(_table(rows) if name == "." else f"{name}: {_table(rows)}")
    return OK


STATS = Command("stats", "prints distributions of a written dataset", _configure, _run)
