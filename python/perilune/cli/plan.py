"""`perilune plan`: the effects of a frame, which of them are on, and why."""

from __future__ import annotations

import json
import math
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Sequence
from typing import Any

from perilune.cli.command import OK, Command
from perilune.cli.options import add_config, add_frame, add_threads, open_simulation
from perilune.cli.progress import Bar
from perilune.cli.text_table import text_table
from perilune.frame.plan_rows import REASON, cells, columns, totals
from perilune.frame.shown import Plan
from perilune.orbits.almanac import sources


def milliseconds(text: str) -> float:
    """A positive number of milliseconds, as an argument."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise ArgumentTypeError(f"{text!r} is not a positive number of milliseconds")
    return value


def _configure(parser: ArgumentParser) -> None:
    add_config(parser)
    add_frame(parser)
    parser.add_argument(
        "--measure",
        action="store_true",
        help="render the frame without each effect that is on and with each that was left out, and "
        "say what it takes (CPU ms) and changes (RMS and 99.9th percentile over pixels)",
    )
    parser.add_argument(
        "--budget-ms",
        type=milliseconds,
        metavar="MS",
        help="the plan that keeps most within so many ms of CPU, and the error that it leaves",
    )
    add_threads(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def _finite(value: float | None) -> float | None:
    """None for infinity, which JSON lacks; null means that it is not known."""
    return float(value) if value is not None and math.isfinite(value) else None


def _json_row(row: Any) -> dict[str, Any]:
    found = {
        "name": row["name"],
        "on": bool(row["on"]),
        "value": row["value"],
        "ceiling": row["ceiling"],
        "reason": row["reason"],
    }
    known = ("bound_dn", "residual_dn", "spent_dn", "cost_ms")
    measured = [key for key in row if key.startswith("measured_")]
    return found | {key: _finite(row[key]) for key in (*known, *measured)}


def _json_plan(rows: Plan) -> dict[str, Any]:
    sums = totals(rows)
    return {
        "effects": [_json_row(row) for row in rows],
        "spent_dn": sums.spent_dn,
        "cost_ms": _finite(sums.cost_ms),
        "expected_ms": rows.expected_ms,
        "expected_parts_ms": None if rows.expected is None else rows.expected.parts,
        "costs": None if rows.expected is None else rows.expected.costs.source,
        "tolerance_dn": rows.tolerance_dn,
    }


def _table(rows: Sequence[Any]) -> str:
    names = columns(rows)
    right = set(names) - {"effect", "state", REASON}
    return text_table(names, [cells(row, names) for row in rows], right)


def _run(args: Namespace) -> int:
    sim = open_simulation(args)
    with Bar("effect") as bar:
        rows = sim.plan(
            args.frame,
            measure=args.measure,
            predict=True,
            budget_ms=args.budget_ms,
            threads=args.threads,
            progress=bar,
        )
    render = sim.config.render
    if args.json:
        print(json.dumps({**_json_plan(rows), "quality": render.named_quality}, indent=2))
        return OK
    print(_table(rows))
    print(rows.text)
    print(
        f"quality: {render.named_quality} ({render.samples} samples, tolerance "
        f"{render.tolerance_dn:g} DN, {render.texture_filter})"
    )
    for key, text in sources(sim.config).items():
        if key != "sun" and text.startswith("series"):
            print(f"{key}: its place is from {text}")
    return OK


PLAN = Command("plan", "prints the effects of a frame and why each is on or off", _configure, _run)
