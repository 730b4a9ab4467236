"""The metadata of a frame: its time, drivers, the Sun, and the states of bodies and spacecraft."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import rotations
from perilune.camera.label import CameraLabel
from perilune.camera.optics import picture_lens, shutter_times
from perilune.document import Document
from perilune.frame.request import camera_label
from perilune.orbits.solar_system import Date
from perilune.spacecraft.articulation import Posed
from perilune.world import World

F64 = NDArray[np.float64]

_CALENDAR = (-68569.0, 1e9)
"""Julian dates between which ERFA knows the calendar (eraJd2cal)."""
_PLACES = ("K", "width", "height", "lens", "camera_pose", "motion", "body_poses", "object_poses")
"""What is read of the core's input."""


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


class Metadata:
    """`camera` and `meta` of a sample, computed when they are first read: training on labels alone
    needs neither.

    It holds numbers of its own frame, and neither the world nor the simulation, so that a sample
    that is kept keeps no models."""

    def __init__(
        self,
        scene: World,
        document: Document,
        request: _core.FrameRequest,
        posed: Mapping[str, Posed],
        result: _core.FrameResult,
        more: Mapping[str, Any],
        *,
        undistorted: bool,
    ) -> None:
        """request, result: input and output of the core. posed: poses of moving parts in the middle
        of the exposure. more: further keys. undistorted: labels are without the lens's
        distortion."""
        self._config = scene.config
        self._moment = scene.moment
        self._t_s = scene.t_s
        self._epoch = scene.epoch
        self._sun_m = scene.sun_position_m
        self._velocities_m_s = scene.velocities_m_s
        self._drivers = scene.drivers
        self._document = document
        given: Mapping[str, Any] = request
        self._request = {key: given[key] for key in _PLACES}
        self._posed = posed
        self._result = result
        self._more = more
        self._undistorted = undistorted
        if not _CALENDAR[0] <= self._epoch.day + self._t_s / 86400.0 <= _CALENDAR[1]:
            self._epoch.after(self._t_s).utc()  # raises ValueError

    @cached_property
    def camera(self) -> CameraLabel:
        """The camera in the middle of the exposure."""
        return camera_label(self._request, self._moment.sensor, not self._undistorted)

    @cached_property
    def _date(self) -> Date:
        """Date at which the shutter opens."""
        return self._epoch.after(self._t_s)

    def meta(self) -> dict[str, Any]:
        """See Sample.meta."""
        result, moment = self._result, self._moment
        white = result["white_radiance"]
        meta: dict[str, Any] = {
            "seed": self._config.seed,
            "index": moment.index,
            "step": moment.step,
            "scene": moment.scene,
            "sensor": moment.sensor,
            "time_utc": self._date.utc(),
            "drivers": dict(self._drivers),
            "scene_drivers": self._document.scene_values(moment.index),
            "overrides": dict(self._document.changes),
            "quality": self._config.render.named_quality,
            "articulation": {name: row.meta for name, row in self._posed.items()},
            "lens": picture_lens(self._config.camera),
            "shutter": shutter_times(self._config.camera),
            "white_radiance": None if np.isnan(white) else white,
            "timings_s": result["timings_s"],
        }
        if not np.isnan(result["exposure_s"]):
            meta["exposure_s"] = result["exposure_s"]
            meta["gain_e_dn"] = result["gain_e_dn"]
        return {**meta, **self._more, **self._states()}

    def _states(self) -> dict[str, Any]:
        """Keys t_s, jd_tdb, sun, states, effects. All are plain numbers and texts."""
        request, config, camera = self._request, self._config, self.camera
        keys = request["motion"] or {"bodies": None, "objects": None}
        poses = {
            **_poses(list(config.bodies), request["body_poses"], keys["bodies"]),
            **_poses(list(config.spacecraft), request["object_poses"], keys["objects"]),
        }
        to_sun = camera.R_w2c @ self._sun_m + camera.t_w2c
        return {
            "t_s": self._t_s,
            "jd_tdb": [self._date.day, self._date.fraction],
            "sun": {
                "position_m": np.asarray(self._sun_m, dtype=np.float64).tolist(),
                "direction": (to_sun / np.linalg.norm(to_sun)).tolist(),
            },
            "states": {
                name: {
                    "position_m": pose[:3].tolist(),
                    "velocity_m_s": np.mean(self._velocities_m_s[name], axis=0).tolist(),
                    "q_wxyz": pose[3:].tolist(),
                }
                for name, pose in poses.items()
            },
            "effects": [row["name"] for row in self._result["plan"] if row["on"]],
        }
