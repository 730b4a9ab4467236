"""Rocks of a body: the core's field of a configuration."""

from __future__ import annotations

import math

import numpy as np

from perilune import _core
from perilune.config.rocks import Rocks

_LARGEST_M, _LARGEST_OF_RADIUS = 20.0, 0.196
_SMALLEST_M, _SMALLEST_OF_RADIUS = 0.05, 3e-9


def rock_field(given: Rocks, radius_m: float) -> _core.RockField:
    """The core's field of rocks on a body of a mean radius. ValueError names the key."""
    settings = given.model_dump(exclude_none=True)
    settings["repose_rad"] = math.radians(settings.pop("repose_deg"))
    first, last = 0.0, math.inf
    if given.table is not None:
        settings["table"] = np.array(given.table, dtype=np.float64)
        first, last = given.table[0][0], given.table[-1][0]
    low = max(_SMALLEST_M, _SMALLEST_OF_RADIUS * radius_m, first)
    high = min(_LARGEST_M, _LARGEST_OF_RADIUS * radius_m, last)
    settings.setdefault("min_diameter_m", low)
    settings.setdefault("max_diameter_m", high)
    return _core.RockField({"radius_m": radius_m, **settings})
