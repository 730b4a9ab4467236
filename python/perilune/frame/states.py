"""What a frame's metadata says of its time, the Sun, and the states of bodies and spacecraft."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import rotations
from perilune.camera.label import CameraLabel
from perilune.world import World

F64 = NDArray[np.float64]


def _middle(ends: F64, keys: F64 | None) -> F64:
    """A pose (7,) in the middle of the exposure, as labels have it. ends (2, 7): at opening and
    closing; keys (n, 7): at times between."""
    if keys is not None:
        return np.asarray(keys[len(keys) // 2])
    centre = 0.5 * (ends[0, :3] + ends[1, :3])
    return np.concatenate([centre, rotations.middle(ends[0, 3:], ends[1, 3:])])


def _poses(names: Sequence[str], ends: F64, keys: F64 | None) -> Mapping[str, F64]:
    """ends: (names, 2, 7); keys: (names, keys, 7)."""
    return {
        name: _middle(ends[k], None if keys is None else keys[k]) for k, name in enumerate(names)
    }


def states(
    scene: World,
    request: _core.FrameRequest,
    camera: CameraLabel,
    plan: Sequence[_core.PlanRow],
) -> dict[str, Any]:
    """Keys of Sample.meta: t_s, jd_tdb, sun, states, effects. All are plain numbers and texts."""
    motion, config = request["motion"], scene.config
    keys = motion or {"bodies": None, "objects": None}
    crafts, bodies = list(config.spacecraft), list(config.bodies)
    poses = {
        **_poses(bodies, request["body_poses"], keys["bodies"]),
        **_poses(crafts, request["object_poses"], keys["objects"]),
    }
    to_sun = camera.R_w2c @ scene.sun_position_m + camera.t_w2c
    return {
        "t_s": scene.t_s,
        "jd_tdb": [scene.date.day, scene.date.fraction],
        "sun": {
            "position_m": np.asarray(scene.sun_position_m, dtype=np.float64).tolist(),
            "direction": (to_sun / np.linalg.norm(to_sun)).tolist(),
        },
        "states": {
            name: {
                "position_m": pose[:3].tolist(),
                "velocity_m_s": np.mean(scene.velocities_m_s[name], axis=0).tolist(),
                "q_wxyz": pose[3:].tolist(),
            }
            for name, pose in poses.items()
        },
        "effects": [row["name"] for row in plan if row["on"]],
    }
