"""Rocks of a body: the core's field of a configuration."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from perilune import _core
from perilune.bodies.size_laws import core_settings
from perilune.config.rocks import Rocks

_SMALLEST_M, _LARGEST_M = 0.05, 20.0
_FOLDED = 0.05
"""Part of the directions in which overhangs are filled without a word."""


@dataclass(frozen=True)
class RockModel:
    """The shape of a measured rock, and what to tell of it."""

    scan: _core.RockScan
    remarks: tuple[str, ...] = ()


def read_rock_model(path: Path) -> RockModel:
    """The shape of a glTF file's mesh. ValueError names the file, OSError too."""
    mesh = _core.Model(str(path)).mesh()
    try:
        scan = _core.RockScan(np.asarray(mesh["positions"], np.float64), mesh["indices"])
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error
    if scan.folded < _FOLDED:
        return RockModel(scan)
    filled = f"overhangs are filled in {scan.folded:.0%} of the directions from its centre"
    return RockModel(scan, (filled,))


def rock_field(given: Rocks, radius_m: float, models: Sequence[RockModel] = ()) -> _core.RockField:
    """The core's field of rocks on a body of a mean radius. models: what its key was read to.
    ValueError names the key."""
    settings = core_settings(given, radius_m, _SMALLEST_M, _LARGEST_M)
    settings["repose_rad"] = math.radians(settings.pop("repose_deg"))
    for key, value in settings.pop("ejecta", {}).items():
        settings[f"ejecta_{key}"] = value
    settings["models"] = [row.scan for row in models]
    if models and given.families is None:
        settings["families"] = {"model": 1.0}
    return _core.RockField(settings)
