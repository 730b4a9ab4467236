"""{uniform: [low, high]}: uniform between two limits.

A strength other than 1 scales the variance about the middle; values are clipped to the limits. The
limits may be lists of the same length (a colour, a vector)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

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


@dataclass(frozen=True)
class Uniform:
    """One value or several; `count` is None for a single number."""

    count: int | None
    low: tuple[float, ...]
    high: tuple[float, ...]
    jointly: bool

    @property
    def ideal(self) -> Any:
        """The middle."""
        pairs = zip(self.low, self.high, strict=True)
        return shaped(tuple(0.5 * (low + high) for low, high in pairs), self.count)

    @property
    def limits(self) -> Mapping[str, Any]:
        """Both."""
        low, high = shaped(self.low, self.count), shaped(self.high, self.count)
        return {".uniform[0]": low, ".uniform[1]": high}

    @property
    def ideal_key(self) -> str:
        """See Distribution."""
        return ".uniform"

    def _deviations(self, strength: float) -> list[float]:
        widths = [high - low for low, high in zip(self.low, self.high, strict=True)]
        return [math.sqrt(width * width / 12.0 * strength) for width in widths]

    def needs(self, strength: float) -> Need | None:
        """See Distribution."""
        varies = any(self._deviations(strength))
        return Need(False, 1 if self.jointly else len(self.low)) if varies else None

    def draw(self, source: Source, strength: float) -> Any:
        """See the module."""
        deviations = self._deviations(strength)
        if not any(deviations):
            return self.ideal
        uniforms = source.uniforms(len(self.low), self.jointly)
        rows = zip(self.low, self.high, deviations, uniforms, strict=True)
        # Its last factor has mean 0 and variance 1.
        values = [
            0.5 * (low + high) + by * (math.sqrt(12.0) * (uniform - 0.5))
            for low, high, by, uniform in rows
        ]
        return shaped(clip(values, self.low, self.high), self.count)


def parse(name: str, raw: Mapping[str, Any]) -> Uniform:
    """Parses its mapping; `name` is the key path."""
    key, limits = f"{name}.uniform", raw["uniform"]
    if not isinstance(limits, (list, tuple)) or len(limits) != 2:
        raise DriverError(key, f"must be [low, high], not {limits!r}")
    count = size(f"{key}[0]", limits[0]) or size(f"{key}[1]", limits[1])
    low, high = (numbers(f"{key}[{k}]", value, count) for k, value in enumerate(limits))
    for least, most in zip(low, high, strict=True):
        if least > most:
            raise DriverError(key, f"must be [low, high], not [{least:g}, {most:g}]")
    return Uniform(count, low, high, joint(name, raw))


KIND = Kind(
    "uniform",
    ("uniform",),
    ("uniform", "jointly"),
    parse,
    marks=lambda value: not isinstance(value, Mapping),
)
