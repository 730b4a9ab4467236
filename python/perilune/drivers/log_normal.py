"""{median, log_variance, clip_min, clip_max}: what has a normal logarithm, clipped.

    value = clip(median * exp(N(0, log_variance * strength)), clip_min, clip_max)

`log_variance` is that of the natural logarithm; the median, the value without strength, is above 0.
Lists as with the normal distribution.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from perilune.drivers.common import (
    DriverError,
    Kind,
    Need,
    Source,
    clip,
    joint,
    numbers,
    shaped,
    size,
)
from perilune.drivers.normal import check_ideal, check_variance, in_deviations, need, need_of

KEYS = ("median", "log_variance", "clip_min", "clip_max")


@dataclass(frozen=True)
class LogNormal:
    """One value or several; `count` is None for a number that stands alone."""

    count: int | None
    medians: tuple[float, ...]
    variances: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    jointly: bool

    @property
    def ideal(self) -> Any:
        """The median."""
        return shaped(self.medians, self.count)

    @property
    def limits(self) -> Mapping[str, Any]:
        """Both clips."""
        low, high = shaped(self.low, self.count), shaped(self.high, self.count)
        return {".clip_min": low, ".clip_max": high}

    @property
    def ideal_key(self) -> str:
        """See Distribution."""
        return ".median"

    def needs(self, strength: float) -> Need | None:
        """See Distribution."""
        return need_of(self.variances, strength, self.jointly)

    def draw(self, source: Source, strength: float) -> Any:
        """See the module."""
        return self.at(strength, lambda: source.normals(len(self.medians), self.jointly))

    def at(self, strength: float, normals: Callable[[], list[float]]) -> Any:
        """As that of the normal distribution."""
        deviations = [math.sqrt(variance * strength) for variance in self.variances]
        if not any(deviations):
            return self.ideal
        jitter = [by * normal for by, normal in zip(deviations, normals(), strict=True)]
        with np.errstate(over="ignore"):  # infinity is clipped
            values = np.array(self.medians) * np.exp(jitter)
        return shaped(clip(values.tolist(), self.low, self.high), self.count)

    def standard_limits(self, strength: float) -> list[tuple[float, float]]:
        """Both clips of each number, in standard deviations of its logarithm from the median's."""
        rows = zip(self.medians, self.variances, self.low, self.high, strict=True)
        return [
            (_limit(low, median, variance * strength), _limit(high, median, variance * strength))
            for median, variance, low, high in rows
        ]


def _limit(limit: float, median: float, variance: float) -> float:
    distance = math.log(limit) - math.log(median) if limit > 0.0 else -math.inf
    return in_deviations(distance, variance)


def parse(name: str, raw: Mapping[str, Any]) -> LogNormal:
    """From its mapping; `name` is the key path."""
    need(name, raw, KEYS)
    count = size(f"{name}.median", raw["median"])
    median, variance, low, high = (numbers(f"{name}.{key}", raw[key], count) for key in KEYS)
    if min(median) <= 0.0:
        raise DriverError(f"{name}.median", f"must be above 0: {min(median):g}")
    check_variance(f"{name}.log_variance", variance)
    check_ideal(name, median, low, high, "median")
    return LogNormal(count, median, variance, low, high, joint(name, raw))


KIND = Kind("log_normal", ("median", "log_variance"), (*KEYS, "jointly", "truncated"), parse)
