"""What the laws of sizes of craters and of rocks have in common."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

from pydantic import BeforeValidator, Field

from perilune.config.errors import fail
from perilune.config.types import NonNegative, Positive, refuse_drawn

Seed = Annotated[int, Field(strict=True, ge=0, lt=2**64)]
Density = Annotated[float, Field(strict=True, ge=0.0, le=1000.0)]
"""Factor on the numbers of a law."""
Steepness = Annotated[float, Field(strict=True, ge=-10.0, le=0.0)]
"""Exponent of a power law."""
_Row = tuple[Positive, NonNegative]
Rows = Annotated[
    tuple[_Row, ...], Field(min_length=2, max_length=10000), BeforeValidator(refuse_drawn)
]
"""Table of a cumulative law: diameter in m, number of this diameter or more per m^2."""


def check_rows(table: Sequence[tuple[float, float]] | None) -> None:
    """Rows [diameter in m, number of this diameter or more per m^2] of a cumulative law."""
    rows = table or ()
    for k in range(1, len(rows)):
        before, row = rows[k - 1], rows[k]
        if row[0] <= before[0]:
            fail(f"table[{k}]", f"diameters rise: must be above {before[0]:g} m")
        if row[1] > before[1]:
            fail(f"table[{k}]", f"numbers do not rise: must be at most {before[1]:g} per m^2")


def check_diameters(low_m: float | None, high_m: float | None) -> None:
    """The keys min_diameter_m and max_diameter_m."""
    if low_m is not None and high_m is not None and not low_m < high_m:
        fail("min_diameter_m", f"must be below max_diameter_m, {high_m:g}")
