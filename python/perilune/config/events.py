"""The section `events` of the schema: an event camera."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from perilune.config.types import Integer, NonNegative, Positive, Strict


class Events(Strict):
    """An event camera with the pixels and the lens of the frame's camera. A pixel reports when the
    natural logarithm of its light has changed by a threshold since its last report."""

    on_threshold: Positive = 0.2
    """Increase of the logarithm that is reported."""
    off_threshold: Positive = 0.2
    """Decrease of the logarithm that is reported."""
    mismatch: Annotated[float, Field(strict=True, ge=0.0, le=1.0)] = 0.0
    """Relative standard deviation of the thresholds of pixels, which stays over frames."""
    dark_radiance_w_m2_sr: Positive = 0.1
    """Radiance that adds to all light, as a pixel's dark current does. Changes well below it are
    not seen."""
    refractory_us: NonNegative = 0.0
    """Time after a report in which a pixel is held; then it starts from the light that it sees."""
    leak_hz: NonNegative = 0.0
    """Reports of an increase per second of a pixel whose light is constant."""
    noise_hz: NonNegative = 0.0
    """Reports per second of a pixel by chance, of either kind."""
    instants: Annotated[Integer, Field(ge=1, le=4096)] = 16
    """Steps between frames of which pictures are made at least."""
    max_halvings: Annotated[Integer, Field(ge=0, le=12)] = 6
    """A step is halved up to so many times where the light does not change linearly."""
    tolerance: Positive = 0.05
    """Deviation of the logarithm from linear change that halves a step."""
    tolerated_pixels: Annotated[float, Field(strict=True, ge=0.0, le=1.0)] = 1e-3
    """Part of the pixels that may deviate by more."""
