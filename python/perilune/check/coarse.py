"""A simulation that renders the frames of another with few samples, for a comparison of colour."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from perilune import _core
from perilune.simulation import Simulation

_OTHER_NOISE = 0x5EED
"""Changes the seed of the sampling alone: what a frame shows stays."""


class Coarse(Simulation):
    """The same frames, by `samples` samples a pixel, and if asked with other noise."""

    samples = 1
    other_noise = False

    @classmethod
    def of(cls, sim: Simulation, samples: int, other_noise: bool = False) -> Coarse:
        """Shares the models, maps and scenes of the other."""
        coarse = cls(*sim.__reduce__()[1])
        coarse.share(sim)
        coarse.samples, coarse.other_noise = samples, other_noise
        return coarse

    def _request(self, *args: Any) -> _core.FrameRequest:
        request = super()._request(*args)
        quality: Mapping[str, Any] = {**request["quality"], "samples": self.samples}
        request["quality"] = quality  # type: ignore[typeddict-item]
        if self.other_noise:
            request["seed"] ^= _OTHER_NOISE
        return request
