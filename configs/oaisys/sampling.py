"""The functions that custom.json names: a module beside a configuration is found without a path."""

from __future__ import annotations

from typing import Any

import numpy as np

from perilune.base import rotations
from perilune.world import World


def sample_equator_orbit_parameters(
    body_radius_xyz: Any = (6378.0, 6378.0, 6378.0),
) -> dict[str, Any]:
    """Listing 2 of the Space OAISYS paper, with its parentheses where they are meant."""
    altitude = np.random.uniform(800.0, 1200.0)  # noqa: NPY002 (as printed)
    scale_xyz = (altitude + np.array(body_radius_xyz)) / np.array(body_radius_xyz)
    rotation_rpy = np.array(
        [
            np.random.uniform(np.deg2rad(-5), np.deg2rad(5)),  # noqa: NPY002
            0.0,
            np.random.uniform(-np.pi, np.pi),  # noqa: NPY002
        ]
    )
    return {"scale_xyz": scale_xyz, "rotation_rpy": rotation_rpy}


def pose_above(world: World, target: str, height_m: float) -> Any:
    """A camera above a target, away from the root body, that looks down at it."""
    place = world.position_m(target)
    up = place / np.linalg.norm(place)
    q = rotations.look_at(-up, np.array([0.0, 0.0, 1.0]))
    return np.concatenate([place + height_m * up, q])
