"""Tracks of wheels on the ground of a body."""

from __future__ import annotations

import itertools
from typing import Annotated

from pydantic import BeforeValidator, Field, model_validator

from perilune.config.errors import fail
from perilune.config.standing import Place
from perilune.config.types import Finite, NonNegative, Positive, Strict, refuse_drawn

_Angle = Annotated[float, Field(strict=True, ge=-80.0, le=80.0)]
_Albedo = Annotated[float, Field(strict=True, ge=0.0, le=4.0)]
_Waypoints = Annotated[tuple[tuple[Finite, Finite], ...], Field(min_length=2)]


class Grousers(Strict):
    """Imprints of the bars on wheels."""

    spacing_m: Positive = 0.1
    """From bar to bar along the track."""
    depth_m: NonNegative = 0.005
    """Below the floor of the rut."""
    angle_deg: _Angle = 0.0
    """Angle of the bars from across the track; to both sides of the middle of a wheel, as a
    chevron."""


class Track(Place):
    """Two ruts of wheels along a way as that of the trajectory traverse: a smooth curve."""

    waypoints_m: Annotated[_Waypoints, BeforeValidator(refuse_drawn)]
    """Points [east, north] in metres from the site, in the plane that touches the ellipsoid there,
    as waypoints_m of traverse."""
    gauge_m: Positive = 1.6
    """Between the middles of the wheels of both sides."""
    wheel_width_m: Positive = 0.25
    """Width of a wheel."""
    depth_m: NonNegative = 0.015
    """Depth of the ruts. Soil is heaped beside them to 0.3 of it."""
    grousers: Grousers | None = Grousers.of_defaults()
    """Imprints of bars on the wheels. null: smooth wheels."""
    albedo: _Albedo = 0.9
    """Factor on the albedo of the ground in the ruts."""

    @model_validator(mode="after")
    def _sizes(self) -> Track:
        if self.gauge_m <= self.wheel_width_m:
            fail("gauge_m", f"must be above wheel_width_m, {self.wheel_width_m:g}")
        if self.depth_m > self.wheel_width_m:
            fail("depth_m", f"must be at most wheel_width_m, {self.wheel_width_m:g}")
        if self.grousers is not None and self.grousers.depth_m > self.wheel_width_m:
            fail("grousers.depth_m", f"must be at most wheel_width_m, {self.wheel_width_m:g}")
        for k, (a, b) in enumerate(itertools.pairwise(self.waypoints_m)):
            if a == b:
                fail(f"waypoints_m[{k + 1}]", "is the point before it")
        return self
