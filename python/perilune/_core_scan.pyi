"""Tables of the C core for sensors with rays of their own: `perilune._core` has their names."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

RAY_SOURCES: tuple[dict[str, Any], ...]
"""Every ray source: {"name", "doc", "list": name of its list of numbers or None, "values": tuple of
{"name", "doc", "low", "high", "whole"}}. A source is a mapping of "kind", its values and list by
name, "sub_rays" (1..256 rays of a beam), "divergence_rad" (full angle of a beam) and "aperture_m"."""

EVENT: Sequence[tuple[Any, ...]]
"""dtype of Renderer.events' records."""

LIDAR_RETURN: Sequence[tuple[Any, ...]]
"""dtype of Renderer.lidar's records."""

TIME_OF_FLIGHT_PIXEL: Sequence[tuple[Any, ...]]
"""dtype of Renderer.time_of_flight's records."""

def source_extent(spec: Mapping[str, Any], /) -> tuple[int, float]:
    """Number of beams of a ray source, and the time in s at which the last one leaves."""

def source_rays(spec: Mapping[str, Any], /) -> F64:
    """(beams, sub_rays, 8): origin, direction, time_s, line of all rays, in the sensor's axes."""
