"""{ideal, jitter_variance, clip_min, clip_max}: normal about the ideal, clipped.

    value = clip(ideal + N(0, jitter_variance * strength), clip_min, clip_max)

With a list as `ideal` (a colour, a vector) the other keys are lists too, or one number for all; its
numbers are drawn independently, or by one draw for all with `jointly: true`.
"""

from __future__ import annotations

from perilune.drivers.clipped import Clipped, in_deviations
from perilune.drivers.common import Kind


class Normal(Clipped):
    """See the module."""

    KEYS = ("ideal", "jitter_variance", "clip_min", "clip_max")

    def varied(self, deviations: list[float], normals: list[float]) -> list[float]:
        """See Clipped."""
        rows = zip(self.middles, deviations, normals, strict=True)
        # -0 + 0 is not -0
        return [mean + by * normal if by != 0.0 else mean for mean, by, normal in rows]

    def standard_limits(self, strength: float) -> list[tuple[float, float]]:
        """See Clipped."""
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
