"""SGP4 of a two-line element set."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from perilune.base.files import Stamp, stamp
from perilune.config.orbit import Tle
from perilune.orbits.ephemerides.tle import ElementSet, Sgp4, parse, read
from perilune.orbits.place import Motion, Place

F64 = NDArray[np.float64]


@lru_cache(maxsize=256)
def _read(path: Path, stamp: Stamp, name: str | None, number: int | None) -> ElementSet:
    return read(path, name, number)


@lru_cache(maxsize=256)
def _sgp4(elements: ElementSet) -> Sgp4:
    return Sgp4(elements)


def tle(orbit: Tle, place: Place) -> Motion:
    """States in ICRF axes; only about the Earth."""
    table = place.parent.table
    if table not in (None, "earth"):
        raise ValueError(f"elements of kind tle are about the Earth, not {table}")
    if orbit.lines is not None:
        elements = parse(*orbit.lines, "lines")
    else:
        assert orbit.file is not None  # the schema asks for one of the two
        path = place.file(orbit.file, "file")
        elements = _read(path, stamp(path), orbit.name, orbit.number)
    record, epoch = _sgp4(elements), place.epoch

    def states(t_s: F64) -> F64:
        return record.states(epoch, t_s)

    return states
