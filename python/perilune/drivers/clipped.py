"""Common base of the normal and the log-normal distribution: a middle, a variance, and two
clips."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Self

from perilune.drivers.common import (
    DriverError,
    Need,
    Source,
    clip,
    joint,
    numbers,
    shaped,
    size,
)


@dataclass(frozen=True)
class Clipped:
    """One value or several; `count` is None for a single number."""

    KEYS: ClassVar[tuple[str, str, str, str]]
    """Keys of the middle, the variance and the two clips."""

    count: int | None
    middles: tuple[float, ...]
    variances: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    jointly: bool
    known: dict[float, list[float]] = field(
        default_factory=dict, compare=False, repr=False, kw_only=True
    )
    """Standard deviations by strength; empty if nothing varies."""

    def varied(self, deviations: list[float], normals: list[float]) -> list[float]:
        """Unclipped values for standard normals. deviations: standard deviations."""
        raise NotImplementedError

    def scalar_draw(self, _: float) -> Callable[[float], Any] | None:
        """From a standard normal to the value of a single number, at a strength at which it varies:
        what `at` gives, in one step. None where there is no such function."""
        return None

    def standard_limits(self, strength: float) -> list[tuple[float, float]]:
        """Both clips of each number, in standard deviations from the middle."""
        raise NotImplementedError

    @property
    def ideal(self) -> Any:
        """The middle, as given."""
        return shaped(self.middles, self.count)

    @property
    def limits(self) -> Mapping[str, Any]:
        """Both clips."""
        low, high = shaped(self.low, self.count), shaped(self.high, self.count)
        return {".clip_min": low, ".clip_max": high}

    @property
    def ideal_key(self) -> str:
        """See Distribution."""
        return f".{self.KEYS[0]}"

    def _deviations(self, strength: float) -> list[float]:
        found = self.known.get(strength)
        if found is None:
            found = [math.sqrt(variance * strength) for variance in self.variances]
            found = self.known[strength] = found if any(found) else []
        return found

    def needs(self, strength: float) -> Need | None:
        """Normals, if anything varies."""
        if not self._deviations(strength):
            return None
        return Need(True, 1 if self.jointly else len(self.variances))

    def draw(self, source: Source, strength: float) -> Any:
        """See Distribution."""
        if not self._deviations(strength):
            return self.ideal
        return self.at(strength, source.normals(len(self.middles), self.jointly))

    def at(self, strength: float, normals: list[float]) -> Any:
        """Value for standard normals, at a strength at which something varies."""
        values = self.varied(self._deviations(strength), normals)
        if self.count is None:
            return min(max(values[0], self.low[0]), self.high[0])
        return list(clip(values, self.low, self.high))

    @classmethod
    def parse(cls, name: str, raw: Mapping[str, Any]) -> Self:
        """Parses its mapping; `name` is the key path."""
        need(name, raw, cls.KEYS)
        middle_key, variance_key = cls.KEYS[:2]
        count = size(f"{name}.{middle_key}", raw[middle_key])
        middle, variance, low, high = (
            numbers(f"{name}.{key}", raw[key], count) for key in cls.KEYS
        )
        cls.check_middle(name, middle)
        for row in variance:
            if row < 0.0:
                raise DriverError(f"{name}.{variance_key}", f"must not be negative: {row:g}")
        check_ideal(name, middle, low, high, middle_key)
        return cls(count, middle, variance, low, high, joint(name, raw))

    @classmethod
    def check_middle(cls, name: str, middle: tuple[float, ...]) -> None:
        """DriverError for a middle that the distribution cannot have."""


def in_deviations(distance: float, variance: float) -> float:
    """Distance of a limit in standard deviations; infinite if nothing varies."""
    deviation = math.sqrt(variance)
    if math.isinf(distance) or deviation == 0.0:
        return math.copysign(math.inf, distance)
    return distance / deviation


def check_ideal(
    name: str,
    ideal: tuple[float, ...],
    low: tuple[float, ...],
    high: tuple[float, ...],
    key: str = "ideal",
) -> None:
    """DriverError unless clip_min <= ideal <= clip_max for every number."""
    for value, least, most in zip(ideal, low, high, strict=True):
        if least > most:
            raise DriverError(f"{name}.clip_min", f"{least:g} is above clip_max = {most:g}")
        if not least <= value <= most:
            raise DriverError(
                f"{name}.{key}",
                f"{value:g} is outside [clip_min, clip_max] = [{least:g}, {most:g}]",
            )


def need(name: str, raw: Mapping[str, Any], keys: tuple[str, ...]) -> None:
    """DriverError that names the first missing key."""
    for key in keys:
        if key not in raw:
            raise DriverError(name, f"a driver needs {', '.join(keys)}; {key} is missing")
