"""{median, log_variance, clip_min, clip_max}: log-normal, clipped.

    value = clip(median * exp(N(0, log_variance * strength)), clip_min, clip_max)

`log_variance` is the variance of the natural logarithm. The median is the ideal and above 0. Lists
work as for the normal distribution."""

from __future__ import annotations

import math

import numpy as np

from perilune.drivers.clipped import Clipped, in_deviations
from perilune.drivers.common import DriverError, Kind


class LogNormal(Clipped):
    """One value or several; `count` is None for a single number."""

    KEYS = ("median", "log_variance", "clip_min", "clip_max")

    def varied(self, deviations: list[float], normals: list[float]) -> list[float]:
        """See Clipped."""
        jitter = [by * normal for by, normal in zip(deviations, normals, strict=True)]
        with np.errstate(over="ignore"):  # infinity is clipped
            values = np.array(self.middles) * np.exp(jitter)
        found: list[float] = values.tolist()
        return found

    def standard_limits(self, strength: float) -> list[tuple[float, float]]:
        """Both clips of each number, in standard deviations of the logarithm from the median's."""
        rows = zip(self.middles, self.variances, self.low, self.high, strict=True)
        return [
            (_limit(low, median, variance * strength), _limit(high, median, variance * strength))
            for median, variance, low, high in rows
        ]

    @classmethod
    def check_middle(cls, name: str, middle: tuple[float, ...]) -> None:
        """See Clipped."""
        if min(middle) <= 0.0:
            raise DriverError(f"{name}.median", f"must be above 0: {min(middle):g}")


def _limit(limit: float, median: float, variance: float) -> float:
    distance = math.log(limit) - math.log(median) if limit > 0.0 else -math.inf
    return in_deviations(distance, variance)


KIND = Kind(
    "log_normal",
    ("median", "log_variance"),
    (*LogNormal.KEYS, "jointly", "truncated"),
    LogNormal.parse,
)
