"""`perilune plan`: the effects of a frame, which of them are on, and why."""

from __future__ import annotations

import json
import math
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from typing import Any

from perilune.cli.command import OK, Command
from perilune.cli.options import add_config, add_frame, open_simulation
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


def _cells(row: Any) -> dict[str, str]:
    return {
        "effect": row["name"],
        "on": "on" if row["on"] else "off",
        "bound": f"{row['bound_dn']:.3g} DN",
        "cost": f"{row['cost_ms']:.3g} ms",
        "reason": row["reason"],
    }


def _table(rows: Sequence[Any]) -> str:
    table = [{name: name for name in _COLUMNS}, *(_cells(row) for row in rows)]
    widths = {name: max(len(row[name]) for row in table) for name in _COLUMNS}
    lines = []
    for row in table:
        cells = [
            row[name].rjust(widths[name]) if name in _RIGHT else row[name].ljust(widths[name])
            for name in _COLUMNS
        ]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)


def _run(args: Namespace) -> int:
    sim = open_simulation(args)
    rows = sim.plan(args.frame)
    print(json.dumps(_json_rows(rows), indent=2) if args.json else _table(rows))
    for key, text in sources(sim.config).items():
        if key != "sun" and not args.json and text.startswith("series"):
            print(f"{key}: its place is from {text}")
    return OK


PLAN = Command("plan", "prints the effects of a frame and why each is on or off", _configure, _run)
