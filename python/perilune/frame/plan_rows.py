"""What rows of a plan say: their state, what they take of the tolerance, and sums of all rows."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

Row = Mapping[str, Any]


def applies(row: Row) -> bool:
    """Whether the effect can matter in the frame at any tolerance."""
    return bool(row["ceiling"] > 0)


def state(row: Row) -> str:
    """`on`, `off`, or `6 of 16`: on at a value below the largest useful one."""
    if not row["on"]:
        return "off"
    return "on" if row["value"] >= row["ceiling"] else f"{row['value']} of {row['ceiling']}"


def number(value: float | None, unit: str) -> str:
    """Three digits and the unit; a dash for what is not known."""
    known = value is not None and math.isfinite(value)
    return f"{value:.3g} {unit}" if known else "–"


COLUMNS = ("effect", "state", "bound", "leaves", "cost")
MEASURED = ("takes", "changes", "99.9 %")
REASON = "reason"


def columns(rows: Sequence[Row]) -> tuple[str, ...]:
    """Names of the columns of a table; those of measurements if there are any."""
    measured = any("measured_ms" in row for row in rows)
    return (*COLUMNS, *(MEASURED if measured else ()), REASON)


def cells(row: Row, names: Sequence[str]) -> list[str]:
    """Texts of a row in some of the columns."""
    found = {
        "effect": row["name"],
        "state": state(row),
        "bound": number(row["bound_dn"], "DN"),
        "leaves": number(row["residual_dn"], "DN"),
        "cost": number(row["cost_ms"], "ms"),
        "takes": number(row.get("measured_ms"), "ms"),
        "changes": number(row.get("measured_dn"), "DN"),
        "99.9 %": number(row.get("measured_p999_dn"), "DN"),
        REASON: row["reason"],
    }
    return [found[name] for name in names]


@dataclass(frozen=True)
class Totals:
    """Numbers of rows by state, and their sums."""

    kept: int
    reduced: int
    left_out: int
    absent: int
    spent_dn: float
    cost_ms: float

    @property
    def text(self) -> str:
        """One sentence."""
        return (
            f"{self.kept} effects on, {self.reduced} reduced, {self.left_out} left out, "
            f"{self.absent} not in the scene; what is reduced and left out changes a pixel by at "
            f"most {self.spent_dn:.2g} DN"
        )


def totals(rows: Sequence[Row]) -> Totals:
    """Counts and sums of a plan. Bounds add linearly; what was left out by force_off does not
    count."""
    states = ["absent" if not applies(row) and not row["on"] else state(row) for row in rows]
    plain = {name: states.count(name) for name in ("on", "off", "absent")}
    return Totals(
        kept=plain["on"],
        reduced=len(rows) - sum(plain.values()),
        left_out=plain["off"],
        absent=plain["absent"],
        spent_dn=math.fsum(row["spent_dn"] for row in rows),
        cost_ms=math.fsum(row["cost_ms"] for row in rows),
    )
