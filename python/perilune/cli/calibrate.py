"""`perilune calibrate`: measures what work costs on this machine."""

from __future__ import annotations

import json
import time
from argparse import ArgumentParser, Namespace
from typing import Any

import numpy as np

import perilune
from perilune.cli.command import OK, Command
from perilune.cli.progress import Bar
from perilune.cli.text_table import text_table
from perilune.cost import calibration


def _configure(parser: ArgumentParser) -> None:
    which = parser.add_mutually_exclusive_group()
    which.add_argument(
        "--show", action="store_true", help="print what was measured, when and on which machine"
    )
    which.add_argument(
        "--reset", action="store_true", help="remove it: the table that ships is used again"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def _table(ns: dict[str, float]) -> str:
    shipped = calibration.of_table()
    rows = [(name, f"{ns[name]:.3g}", f"{cost:.3g}") for name, cost in shipped.ns.items()]
    return text_table(("unit of work", "ns here", "ns, shipped"), rows, {"ns here", "ns, shipped"})


def _tell(found: dict[str, Any]) -> None:
    ratios = np.array([row["expected_over_measured"] for row in found["pictures"]])
    made = time.strftime("%Y-%m-%d %H:%M", time.localtime(found["made"]))
    print(_table(found["ns"]))
    print(f"{found['machine']}, {made}, in {found['took_s']:.0f} s")
    print(
        f"{len(ratios)} pictures of the configurations that ship: expected over measured time "
        f"{ratios.min():.2f} to {ratios.max():.2f}, within 30 % of "
        f"{np.mean(np.abs(ratios - 1.0) < 0.3):.0%}"
    )
    for name, why in found.get("left_out", {}).items():
        print(f"{name} was left out: {why}")


def _show(found: dict[str, Any] | None, as_json: bool) -> int:
    if as_json:
        print(json.dumps(found or {"ns": dict(calibration.of_table().ns)}, indent=2))
    elif found is None:
        print(_table(dict(calibration.of_table().ns)))
        print(f"not calibrated: {calibration.path()} does not exist")
    else:
        _tell(found)
    return OK


def _run(args: Namespace) -> int:
    file = calibration.path()
    if args.show:
        return _show(calibration.kept(), args.json)
    if args.reset:
        file.unlink(missing_ok=True)
        print(f"{file}: removed")
        return OK
    with Bar("configuration") as bar:
        found = calibration.calibrate(perilune.open, bar)
    calibration.save(found)
    _show(found, args.json)
    if not args.json:
        print(f"written to {file}")
    return OK


CALIBRATE = Command(
    "calibrate", "measures what work costs on this machine, for expected times", _configure, _run
)
