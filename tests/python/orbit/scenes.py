"""What tests of orbits from the configuration share."""

from __future__ import annotations

import numpy as np
import pytest

import perilune
from perilune.config import ConfigError


def opened(scene, repo_dir, orbit=None, attitude=None, **options):
    """A simulation of the scene with another orbit or attitude of its satellite."""
    if orbit is not None:
        scene["spacecraft"]["sat"]["orbit"] = {"around": "earth", **orbit}
    if attitude is not None:
        scene["spacecraft"]["sat"]["attitude"] = attitude
    return perilune.open(scene, base=repo_dir / "tests/python", **options)


def state(sim, name="sat", t_s=0.0, index=0):
    """Pose (7,) and velocity (3,) in the root frame."""
    found = sim.system(index).states(np.array([t_s]))
    return found.poses[name][0], found.velocities_m_s[name][0]


def refused(scene, repo_dir, **options) -> str:
    """The text of the error that opening gives."""
    with pytest.raises(ConfigError) as error:
        opened(scene, repo_dir, **options)
    return str(error.value)


def equator_m(sim):
    """Semi-axes of the Earth as configured (3,)."""
    return perilune.orbits.radii_m(sim.config.bodies["earth"])
