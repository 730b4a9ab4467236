"""{ideal, jitter_variance, clip_min, clip_max}: normal about the ideal, clipped.

    value = clip(ideal + N(0, jitter_variance * strength), clip_min, clip_max)

With a list as `ideal` (a colour, a vector) the other keys are lists too, or one number for all; its
numbers are drawn independently, or by one draw for all with `jointly: true`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
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

KEYS = ("ideal", "jitter_variance", "clip_min", "clip_max")


@dataclass(frozen=True)
class Normal:
    """One value or several; `count` is None for a number that stands alone."""

    count: int | None
    means: tuple[float, ...]
    variances: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    jointly: bool

    @property
    def ideal(self) -> Any:
        """As given."""
        return shaped(self.means, self.count)

    @property
    def limits(self) -> Mapping[str, Any]:
        """Both clips."""
        low, high = shaped(self.low, self.count), shaped(self.high, self.count)
        return {".clip_min": low, ".clip_max": high}

    @property
    def ideal_key(self) -> str:
        """See Distribution."""
        return ".ideal"

    def needs(self, strength: float) -> Need | None:
        """See Distribution."""
        return need_of(self.variances, strength, self.jointly)

    def draw(self, source: Source, strength: float) -> Any:
        """See the module."""
        return self.at(strength, lambda: source.normals(len(self.means), self.jointly))

    def at(self, strength: float, normals: Callable[[], list[float]]) -> Any:
        """The value of standard normals, which are asked for only where something varies."""
        deviations = [math.sqrt(variance * strength) for variance in self.variances]
        if not any(deviations):
            return self.ideal
        rows = zip(self.means, deviations, normals(), strict=True)
        # -0 + 0 is not -0
        values = [mean + by * jitter if by != 0.0 else mean for mean, by, jitter in rows]
        return shaped(clip(values, self.low, self.high), self.count)

    def standard_limits(self, strength: float) -> list[tuple[float, float]]:
        """Both clips of each number, in standard deviations from its ideal."""
        found = []
        for mean, own, low, high in zip(
            self.means, self.variances, self.low, self.high, strict=True
        ):
            variance = own * strength
            found.append(
                (in_deviations(low - mean, variance), in_deviations(high - mean, variance))
            )
        return found


def need_of(variances: tuple[float, ...], strength: float, jointly: bool) -> Need | None:
    """Normals, where anything varies."""
    if not any(math.sqrt(variance * strength) for variance in variances):
        return None
    return Need(True, 1 if jointly else len(variances))


def in_deviations(distance: float, variance: float) -> float:
    """How many standard deviations a limit is away; endlessly many where nothing varies."""
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
    """DriverError unless clip_min <= ideal <= clip_max throughout."""
    for value, least, most in zip(ideal, low, high, strict=True):
        if least > most:
            raise DriverError(f"{name}.clip_min", f"{least:g} is above clip_max = {most:g}")
        if not least <= value <= most:
            raise DriverError(
                f"{name}.{key}",
                f"{value:g} is outside [clip_min, clip_max] = [{least:g}, {most:g}]",
            )


def check_variance(name: str, variances: tuple[float, ...]) -> None:
    """DriverError for one below 0."""
    for variance in variances:
        if variance < 0.0:
            raise DriverError(name, f"must not be negative: {variance:g}")


def need(name: str, raw: Mapping[str, Any], keys: tuple[str, ...]) -> None:
    """DriverError naming the first key that is missing."""
    for key in keys:
        if key not in raw:
            raise DriverError(name, f"a driver needs {', '.join(keys)}; {key} is missing")


def parse(name: str, raw: Mapping[str, Any]) -> Normal:
    """From its mapping; `name` is the key path."""
    need(name, raw, KEYS)
    count = size(f"{name}.ideal", raw["ideal"])
    mean, variance, low, high = (numbers(f"{name}.{key}", raw[key], count) for key in KEYS)
    check_variance(f"{name}.jitter_variance", variance)
    check_ideal(name, mean, low, high)
    return Normal(count, mean, variance, low, high, joint(name, raw))


KIND = Kind("normal", ("ideal", "jitter_variance"), (*KEYS, "jointly", "truncated"), parse)
