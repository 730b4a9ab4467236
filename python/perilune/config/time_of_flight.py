"""The section `time_of_flight` of the schema: distances from the phase of modulated light."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from perilune.config.types import Integer, NonNegative, Strict

Hertz = Annotated[Integer, Field(ge=1, le=10**12)]


class TimeOfFlight(Strict):
    """A time-of-flight camera with the pixels and the lens of the frame's camera, which lights the
    scene itself."""

    modulation_hz: Annotated[tuple[Hertz, ...], Field(min_length=1, max_length=4)] = (
        20_000_000,
        50_000_000,
    )
    """Frequencies of the light. Together they tell ranges apart up to c / 2 over their largest
    common divisor."""
    samples: Annotated[Integer, Field(ge=1, le=256)] = 16
    """Rays of a pixel, on a grid."""
    band: Literal["red", "green", "blue"] = "red"
    """Colour of the light, which surfaces reflect as in pictures."""
    signal_e: NonNegative = 1e6
    """Electrons, over the four taps of a modulation, from a white Lambert target at 1 m that fills
    the pixel and faces the camera. They fall with the square of the range."""
    ambient_e: NonNegative = 0.0
    """Electrons per tap from other light."""
    read_noise_e: NonNegative = 0.0
    """Standard deviation of a tap, in electrons."""
    contrast: Annotated[float, Field(strict=True, ge=0.0, le=1.0)] = 1.0
    """Contrast of the modulation."""
    full_well_e: NonNegative = 0.0
    """Electrons that a tap holds; a fuller pixel has no range. 0: any number."""
    min_amplitude_e: NonNegative = 0.0
    """Pixels with a smaller amplitude have no range."""
