"""`perilune plan`: the effects of a frame, which of them are on, and why."""

from __future__ import annotations

import json
import math
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from typing import Any

from perilune.cli.command import OK, Command
from perilune.cli.options import add_config, add_frame, open_simulation
from perilune.cli.text_table import text_table
from perilune.orbits.almanac import sources

_COLUMNS = ("effect", "on", "bound", "cost", "reason")
_RIGHT = {"bound", "cost"}


def _configure(parser: ArgumentParser) -> None:
    add_config(parser)
    add_frame(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def _finite(value: float) -> float | None:
    """None for infinity, which JSON lacks; null means that no bound is known."""
    return float(value) if math.isfinite(value) else None


def _json_rows(rows: Sequence[Any]) -> dict[str, Any]:
    effects = [
        {
            "name": row["name"],
            "on": bool(row["on"]),
            "reason": row["reason"],
            "bound_dn": _finite(row["bound_dn"]),
            "cost_ms": _finite(row["cost_ms"]),
        }
        for row in rows
    ]
    return {"effects": effects}


def _cells(row: Any) -> list[str]:
    bound, cost = f"{row['bound_dn']:.3g} DN", f"{row['cost_ms']:.3g} ms"
    return [row["name"], "on" if row["on"] else "off", bound, cost, row["reason"]]


def _table(rows: Sequence[Any]) -> str:
    return text_table(_COLUMNS, [_cells(row) for row in rows], _RIGHT)


def _run(args: Namespace) -> int:
    sim = open_simulation(args)
    rows = sim.plan(args.frame)
    print(json.dumps(_json_rows(rows), indent=2) if args.json else _table(rows))
    for key, text in sources(sim.config).items():
        if key != "sun" and not args.json and text.startswith("series"):
            print(f"{key}: its place is from {text}")
    return OK


PLAN = Command("plan", "prints the effects of a frame and why each is on or off", _configure, _run)
