"""The camera of a frame as its labels have it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perilune import _core

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class CameraLabel:
    """The camera in the middle of the exposure: p_camera = R_w2c p_root + t_w2c, OpenCV axes."""

    K: F64
    """(3, 3), pixels, integer pixel centres."""
    width: int
    height: int
    R_w2c: F64
    """(3, 3), from root (ICRF) axes."""
    t_w2c: F64
    """(3,), m."""
    sensor: str | None = None
    """Name of the sensor; None where the configuration has no section `sensors`."""
    lens: tuple[str, F64] | None = None
    """Model and coefficients of the distortion that the labels have (names in `_core.LENSES`); None
    for a pinhole camera, or labels that are undistorted."""

    @property
    def position_m(self) -> F64:
        """The camera's place in the root frame."""
        return -self.R_w2c.T @ self.t_w2c

    def project(self, points_m: F64) -> F64:
        """(N, 2): pixel positions of points (N, 3) in the root frame, m, where the labels have
        them; nan behind the camera and where the lens sees nothing."""
        points = np.ascontiguousarray(np.reshape(points_m, (-1, 3)), dtype=np.float64)
        return _core.project(self.K, self.lens, points @ self.R_w2c.T + self.t_w2c)
