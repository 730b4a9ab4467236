"""{..., clip_min, clip_max, truncated: true}: truncated normal or log-normal.

Instead of moving the tails onto the limits, it has the distribution's density within the limits,
normalised to 1. It is drawn by the inverse of the cumulative distribution, with one random number
each, so that it works in correlated groups."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from statistics import NormalDist
from typing import Any

from perilune.drivers import log_normal, normal
from perilune.drivers.clipped import Clipped
from perilune.drivers.common import DriverError, Kind, Need, Source

_STANDARD = NormalDist()
_ROOT_2 = math.sqrt(2.0)
_NEAR = 0.1
"""Below this, erf is inverted directly: 0.5 + erf / 2 would lose its digits."""


def truncated_normal(low: float, high: float, uniform: float) -> float:
    """Quantile in [0, 1] of the standard normal truncated to low <= 0 <= high."""
    below, above = math.erf(low / _ROOT_2), math.erf(high / _ROOT_2)
    inner = below + uniform * (above - below)
    if abs(inner) < _NEAR:
        z = 0.5 * math.sqrt(math.pi) * inner
        for _ in range(2):  # Newton's method
            z -= 0.5 * math.sqrt(math.pi) * (math.erf(z) - inner) * math.exp(z * z)
        return _ROOT_2 * z
    # Each half by its own tail, whose digits do not end at those of 1.
    mass = 0.5 * (above - below)
    tail, share, sign = (low, uniform, 1.0) if inner < 0.0 else (high, 1.0 - uniform, -1.0)
    beyond = 0.5 * math.erfc(abs(tail) / _ROOT_2) + share * mass
    return sign * _STANDARD.inv_cdf(beyond) if beyond > 0.0 else tail


@dataclass(frozen=True)
class Truncated:
    """`free` is the distribution with its tails."""

    free: Clipped
    known: dict[float, list[tuple[float, float]]] = field(default_factory=dict, compare=False)
    """Limits by strength."""

    @property
    def ideal(self) -> Any:
        """The ideal of the untruncated distribution; it is the mean only if the limits are
        symmetric."""
        return self.free.ideal

    @property
    def limits(self) -> Mapping[str, Any]:
        """Both."""
        return self.free.limits

    @property
    def ideal_key(self) -> str:
        """See Distribution."""
        return self.free.ideal_key

    def needs(self, strength: float) -> Need | None:
        """See Distribution."""
        need = self.free.needs(strength)
        return need and need._replace(normal=False)

    def scalar_draw(self, strength: float) -> Callable[[float], Any] | None:
        """See Clipped; from a uniform number."""
        placed = self.free.scalar_draw(strength)
        if placed is None:
            return None
        ((low, high),) = self.free.standard_limits(strength)
        return lambda uniform: placed(truncated_normal(low, high, uniform))

    def draw(self, source: Source, strength: float) -> Any:
        """See the module."""
        if self.needs(strength) is None:
            return self.ideal
        if strength not in self.known:
            self.known[strength] = self.free.standard_limits(strength)
        limits = self.known[strength]
        rows = zip(limits, source.uniforms(len(limits), self.free.jointly), strict=True)
        return self.free.at(strength, [truncated_normal(*limit, row) for limit, row in rows])


def parse(name: str, raw: Mapping[str, Any]) -> Clipped | Truncated:
    """Parses its mapping; `name` is the key path."""
    kind = log_normal if any(key in raw for key in log_normal.KIND.markers) else normal
    asked = raw["truncated"]
    if not isinstance(asked, bool):
        raise DriverError(f"{name}.truncated", f"must be true or false, not {asked!r}")
    for key in raw:
        if key in KIND.keys and key not in kind.KIND.keys:
            text = f"is of another distribution; allowed: {', '.join(kind.KIND.keys)}"
            raise DriverError(f"{name}.{key}", text)
    free = kind.KIND.parse(name, raw)
    return Truncated(free) if asked else free


KIND = Kind(
    "truncated",
    ("truncated",),
    tuple(dict.fromkeys((*normal.KIND.keys, *log_normal.KIND.keys))),
    parse,
    marks=lambda value: not isinstance(value, Mapping),
)
