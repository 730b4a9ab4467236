"""{ideal, jitter_variance, clip_min, clip_max}: normal about the ideal, clipped.

    value = clip(ideal + N(0, jitter_variance * strength), clip_min, clip_max)

If `ideal` is a list (a colour, a vector), the other keys are lists of the same length or one number
for all. Its numbers are drawn independently, or with one draw for all if `jointly: true`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from perilune.drivers.clipped import Clipped, in_deviations
from perilune.drivers.common import Kind


class Normal(Clipped):
    """One value or several; `count` is None for a single number."""

    KEYS = ("ideal", "jitter_variance", "clip_min", "clip_max")

    def varied(self, deviations: list[float], normals: list[float]) -> list[float]:
        """See Clipped."""
        rows = zip(self.middles, deviations, normals, strict=True)
        # -0 + 0 is not -0
        return [mean + by * normal if by != 0.0 else mean for mean, by, normal in rows]

    def scalar_draw(self, strength: float) -> Callable[[float], Any] | None:
        """See Clipped."""
        if self.count is not None:
            return None
        mean, low, high = self.middles[0], self.low[0], self.high[0]
        by = self._deviations(strength)[0]
        return lambda normal: min(max(mean + by * normal, low), high)

    def standard_limits(self, strength: float) -> list[tuple[float, float]]:
        """Both clips of each number, in standard deviations from its ideal."""
        rows = zip(self.middles, self.variances, self.low, self.high, strict=True)
        return [
            (in_deviations(low - mean, own * strength), in_deviations(high - mean, own * strength))
            for mean, own, low, high in rows
        ]


KIND = Kind(
    "normal",
    ("ideal", "jitter_variance"),
    (*Normal.KEYS, "jointly", "truncated"),
    Normal.parse,
)
