"""States from SPICE kernels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from perilune.config import orbit as section
from perilune.orbits.ephemerides.spice import Spice
from perilune.orbits.place import Motion, Place

F64 = NDArray[np.float64]


def spice(orbit: section.Spice, place: Place) -> Motion:
    """States relative to the observer, which is the central body."""
    observer = orbit.observer or place.parent.table
    if observer is None:
        raise ValueError(f"observer: SPICE's name or number of {orbit.around} is needed")
    kernels = tuple(
        place.file(text, f"kernels[{k}]").resolve() for k, text in enumerate(orbit.kernels)
    )
    source, epoch = Spice(kernels, orbit.target.upper(), observer.upper()), place.epoch

    def states(t_s: F64) -> F64:
        return source.states(epoch, t_s)

    return states
