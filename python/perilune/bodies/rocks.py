"""Rocks of a body: the core's field of a configuration."""

from __future__ import annotations

import math

from perilune import _core
from perilune.bodies.size_laws import core_settings
from perilune.config.rocks import Rocks

_SMALLEST_M, _LARGEST_M = 0.05, 20.0


def rock_field(given: Rocks, radius_m: float) -> _core.RockField:
    """The core's field of rocks on a body of a mean radius. ValueError names the key."""
    settings = core_settings(given, radius_m, _SMALLEST_M, _LARGEST_M)
    settings["repose_rad"] = math.radians(settings.pop("repose_deg"))
    for key, value in settings.pop("ejecta", {}).items():
        settings[f"ejecta_{key}"] = value
    return _core.RockField(settings)
