"""From a camera's lens to the numbers of the core: distortion and focus."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.config.camera import Camera

F64 = NDArray[np.float64]


def picture_lens(camera: Camera) -> dict[str, Any] | None:
    """Distortion of the pictures, as metadata has it: {"model", "coefficients"}; None without.
    Labels may be without it (lens.labels: undistorted)."""
    found = lens_of(camera)
    return None if found is None else {"model": found[0], "coefficients": found[1].tolist()}


def shutter_times(camera: Camera) -> dict[str, float]:
    """Times of the shutter, as metadata has them, s. An automatic exposure of the sensor is told
    beside them (`exposure_s`)."""
    return {"exposure_s": camera.exposure_time_s, "line_time_s": 1e-6 * camera.line_time_us}


def lens_of(camera: Camera) -> tuple[str, F64] | None:
    """Model and coefficients of the distortion, in the core's form."""
    lens = camera.lens
    if lens is None or lens.model == "rectilinear":
        return None
    names = _core.LENSES[lens.model]["coefficients"]
    return lens.model, np.array([getattr(lens, name) for name in names], np.float64)


def focus_of(
    camera: Camera, K: F64, sensor: Mapping[str, Any] | None
) -> tuple[float, float] | None:
    """Diameter of the aperture and distance in focus, m; None if the camera has no blur.

    sensor: in the core's form, or None. Its pixel pitch gives the focal length in metres."""
    lens = camera.lens
    if lens is None or lens.focus_distance_m is None:
        return None
    distance_m = math.inf if lens.focus_distance_m == "infinity" else lens.focus_distance_m
    if lens.aperture_mm is not None:
        return lens.aperture_mm * 1e-3, distance_m
    assert sensor is not None  # the schema asks for one of the two
    focal_m = math.sqrt(K[0, 0] * K[1, 1]) * sensor["pixel_m"]
    return focal_m / sensor["f_number"], distance_m
