"""The camera of a frame, as its labels see it."""

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
    """(3, 3) intrinsic matrix, pixels, integer pixel centres."""
    width: int
    height: int
    R_w2c: F64
    """(3, 3) rotation from root (ICRF) axes to camera axes."""
    t_w2c: F64
    """(3,) translation, m."""
    sensor: str | None = None
    """Name of the sensor; None without a section `sensors`."""
    lens: tuple[str, F64] | None = None
    """Model and coefficients of the labels' distortion (names in `_core.LENSES`); None for a
    pinhole camera or undistorted labels."""

    @property
    def position_m(self) -> F64:
        """Position (3,) of the camera in the root frame, m."""
        return -self.R_w2c.T @ self.t_w2c

    def project(self, points_m: F64) -> F64:
        """Pixel positions (N, 2) of points (N, 3) in the root frame, m, with the labels'
        distortion; nan behind the camera and where the lens sees nothing."""
        points = np.ascontiguousarray(np.reshape(points_m, (-1, 3)), dtype=np.float64)
        return _core.project(self.K, self.lens, points @ self.R_w2c.T + self.t_w2c)
