"""Renders the frames of a simulation again with few samples, to compare colour."""

from __future__ import annotations

from typing import Any

from perilune import _core
from perilune.sample import Sample
from perilune.simulation import Simulation

_OTHER_NOISE = 0x5EED
"""Changes only the seed of the sampling, so that a frame's content stays."""


class Coarse(Simulation):
    """The same frames with `samples` samples per pixel."""

    samples = 1
    beside: Sample | None = None
    """A frame that is rendered again with other noise, at its exposure."""

    @classmethod
    def of(cls, sim: Simulation, samples: int) -> Coarse:
        """Shares the models, maps and scenes of another simulation."""
        coarse = cls(*sim.__reduce__()[1])
        coarse._remarks = sim._remarks  # models are reported once
        coarse.samples = samples
        return coarse

    def again(self, sample: Sample, channels: list[str]) -> Sample:
        """The same frame with other noise."""
        self.beside = sample
        try:
            return self.frame(sample.meta["index"], channels=channels)
        finally:
            self.beside = None

    def _request(self, *args: Any) -> _core.FrameRequest:
        request = super()._request(*args)
        request["quality"]["samples"] = self.samples
        if self.beside is not None:
            request["seed"] ^= _OTHER_NOISE
            _expose_as(request, self.beside.meta)
        return request

    def _metered(self, *args: Any) -> Any:
        return None if self.beside is not None else super()._metered(*args)


def _expose_as(request: _core.FrameRequest, meta: dict[str, Any]) -> None:
    """Applies the exposure that was metered on another frame."""
    white = meta["white_radiance"]
    if white is not None:
        request["exposure"]["mode"] = "fixed"
        request["exposure"]["white_radiance"] = white
    if request.get("sensor") is not None and "exposure_s" in meta:
        sensor = dict(request["sensor"] or {})
        sensor.update(auto_time=None, exposure_s=meta["exposure_s"], gain=meta["gain_e_dn"])
        request["sensor"] = sensor
