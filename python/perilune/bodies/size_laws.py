"""What the core's fields of craters and of rocks take alike from a configuration."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from perilune.config.craters import Craters
from perilune.config.rocks import Rocks

_LARGEST_OF_RADIUS, _SMALLEST_OF_RADIUS = 0.196, 3e-9


def core_settings(
    given: Craters | Rocks, radius_m: float, smallest_m: float, largest_m: float
) -> dict[str, Any]:
    """Settings for a body of a mean radius. Diameters that are not given are those of the law
    between two default ones, as far as its table and the body allow."""
    settings = given.model_dump(exclude_none=True)
    first, last = 0.0, math.inf
    if given.table is not None:
        settings["table"] = np.array(given.table, dtype=np.float64)
        first, last = given.table[0][0], given.table[-1][0]
    low = max(smallest_m, _SMALLEST_OF_RADIUS * radius_m, first)
    high = min(largest_m, _LARGEST_OF_RADIUS * radius_m, last)
    settings.setdefault("min_diameter_m", low)
    settings.setdefault("max_diameter_m", high)
    return {"radius_m": radius_m, **settings}
