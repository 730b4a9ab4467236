"""fixed: a position relative to a target."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from perilune.camera.trajectories.view import aimed
from perilune.config.trajectory import Fixed
from perilune.world import World


def fixed(world: World) -> NDArray[np.float64]:
    """A fixed position in the axes of a target, with which it rotates, looking at the target."""
    spec = world.camera.trajectory
    assert isinstance(spec, Fixed)
    place = np.array(spec.position_m)
    return aimed(world, spec, lambda when: place)
