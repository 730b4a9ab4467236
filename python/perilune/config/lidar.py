"""The section `lidars` of the schema: scanners on the platform that `camera` moves."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from perilune.config.errors import fail
from perilune.config.sensors import Mounting, Transformation
from perilune.config.types import Finite, Integer, NonNegative, Positive, Strict

Count = Annotated[Integer, Field(ge=1, le=65536)]
Pulses = Annotated[Integer, Field(ge=1, le=2**26)]
Angle = Annotated[float, Field(strict=True, gt=0.0, le=177.0)]
Swing = Annotated[float, Field(strict=True, ge=0.0, le=180.0)]
Tilt = Annotated[float, Field(strict=True, ge=0.0, le=80.0)]


class Flash(Strict):
    """A grid of beams that all leave when the shutter opens, as the pixels of a pinhole camera."""

    kind: Literal["flash"]
    columns: Count = 128
    """Beams per row."""
    rows: Count = 128
    """Number of rows."""
    width_deg: Angle = 20.0
    """Angle from the left edge to the right one."""
    height_deg: Angle = 20.0
    """Angle from the top edge to the bottom one."""


class Spinning(Strict):
    """A column of beams that turns about the y axis of the LiDAR, from left to right."""

    kind: Literal["spinning"]
    elevations_deg: Annotated[
        tuple[Annotated[float, Field(strict=True, ge=-90.0, le=90.0)], ...], Field(min_length=1)
    ]
    """Elevation of each beam over the plane of x and z, in which the column turns."""
    steps: Pulses = 1800
    """Columns in a scan."""
    from_deg: Finite = -180.0
    """Azimuth of the first column; 0 is z, 90 is x."""
    to_deg: Finite = 180.0
    """Azimuth where the column after the last one would be."""
    rate_hz: Positive = 18_000.0
    """Columns per second."""


class Raster(Strict):
    """One beam that sweeps line by line, in turn to the right and to the left."""

    kind: Literal["raster"]
    columns: Count = 256
    """Pulses per line."""
    rows: Count = 256
    """Number of lines."""
    width_deg: Swing = 20.0
    """Angle of a line."""
    height_deg: Swing = 20.0
    """Angle from the first line to the last."""
    rate_hz: Positive = 100_000.0
    """Pulses per second."""


class Lissajous(Strict):
    """One beam on a mirror that swings about two axes as sines."""

    kind: Literal["lissajous"]
    pulses: Pulses = 65536
    """Pulses in a scan."""
    width_deg: Swing = 20.0
    """Angle from the left end to the right one."""
    height_deg: Swing = 20.0
    """Angle from the top end to the bottom one."""
    x_hz: NonNegative = 410.0
    """Swings to the right and back per second."""
    y_hz: NonNegative = 370.0
    """Swings up and back per second."""
    phase_deg: Finite = 90.0
    """Phase of the swing up at the start."""
    rate_hz: Positive = 100_000.0
    """Pulses per second."""


class Rosette(Strict):
    """One beam through two turning wedge prisms (Risley prisms)."""

    kind: Literal["rosette"]
    pulses: Pulses = 65536
    """Pulses in a scan."""
    first_deg: Tilt = 10.0
    """Deflection by the first prism."""
    second_deg: Tilt = 9.0
    """Deflection by the second prism."""
    first_hz: Finite = 121.7
    """Turns of the first prism per second; below 0: the other way round."""
    second_hz: Finite = -77.3
    """Turns of the second prism per second."""
    rate_hz: Positive = 100_000.0
    """Pulses per second."""


Pattern = Annotated[
    Flash | Spinning | Raster | Lissajous | Rosette,
    Field(discriminator="kind"),
]

BANDS = ("red", "green", "blue")


class Lidar(Strict):
    """A pulsed LiDAR. Its axes are x right, y down, z forward."""

    pattern: Pattern
    """Where and when its beams go."""
    transformation: Transformation = Mounting.of_defaults()
    """Pose on the platform: {position_m, rotation_deg}, or [x, y, z, qw, qx, qy, qz] in metres."""
    divergence_deg: Annotated[float, Field(strict=True, ge=0.0, le=20.0)] = 0.0
    """Full angle of a beam, which is evenly bright."""
    aperture_m: NonNegative = 0.0
    """Diameter of a beam where it leaves."""
    sub_rays: Annotated[Integer, Field(ge=1, le=256)] = 1
    """Rays that represent a beam. One is its axis; more find what a part of it meets."""
    instants: Annotated[Integer, Field(ge=1, le=4096)] = 8
    """Instants of a scan at which articulated parts are moved and the ground's tiles are chosen.
    All else is where it is at the time of each beam, for any number."""
    band: Literal["red", "green", "blue"] = "red"
    """Colour of the light, which surfaces reflect as in pictures."""
    returns: Literal["all", "first", "strongest", "last"] = "all"
    """Which returns of a beam are kept."""
    max_returns: Annotated[Integer, Field(ge=1, le=8)] = 3
    """Largest number of returns that are told apart; the strongest count."""
    range_resolution_m: NonNegative = 0.3
    """Surfaces nearer to each other along a beam give one return: half of the length of a pulse."""
    range_m: tuple[NonNegative, Positive] = (0.0, 1e12)
    """Smallest and largest range that is reported."""
    unambiguous_range_m: Positive | None = None
    """Larger ranges are reported less a multiple of this: c / 2 over the rate of pulses. Default:
    pulses are told apart."""
    reference_range_m: Positive = 1.0
    """Range at which a white Lambert target that fills the beam and faces the sensor has an
    intensity of 1."""
    min_intensity: NonNegative = 0.0
    """Weaker returns are not detected."""
    dropout: Annotated[float, Field(strict=True, ge=0.0, le=1.0)] = 0.0
    """Probability that a return is lost."""
    range_noise_m: NonNegative = 0.0
    """Standard deviation of ranges, normally distributed."""
    shot_noise_m: NonNegative = 0.0
    """Standard deviation that is added, at an intensity of 1; it grows with the inverse root of the
    intensity."""
    intensity_noise: NonNegative = 0.0
    """Relative standard deviation of intensities."""

    @model_validator(mode="after")
    def _ranges(self) -> Lidar:
        if self.range_m[0] >= self.range_m[1]:
            fail("range_m", "is [smallest, largest]")
        if self.divergence_deg == 0.0 and self.aperture_m == 0.0 and self.sub_rays > 1:
            fail("sub_rays", "a beam without divergence_deg and aperture_m is one ray")
        return self
