"""Trajectories over the ground of a body: along a way, or down to a touch-down."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from perilune.config.standing import Descent, Footprint, Way
from perilune.config.trajectory.common import Pointing, Run
from perilune.config.types import Finite, Integer, Positive

_Elevation = Annotated[float, Field(strict=True, ge=-90.0, le=90.0)]


class Traverse(Pointing, Run, Way):
    """A drive or a flight over the ground along a curve, such as that of a rover's mast."""

    kind: Literal["traverse"]
    target: str
    """Name of the body."""
    height_m: Positive
    """Height over the ground along the axis z of the way."""
    footprint_m: Footprint | None = None
    """Length and width of the ground, one number for both, whose best plane gives pitch, roll and
    height. Default: height_m."""
    yaw_deg: Finite = 0.0
    """Direction of the view, from forward to the left."""
    pitch_deg: _Elevation = 0.0
    """Elevation of the view over the plane of forward and left; -90: down."""
    speed_m_s: Positive | None = None
    """Speed along the curve; instead of positions or duration_s."""

    @model_validator(mode="after")
    def _one_rate(self) -> Traverse:
        self._exactly_one("positions", "duration_s", "speed_m_s", optional=True)
        return self

    def natural_duration_s(self) -> float | None:
        return None if self.speed_m_s is None else self.length_m / self.speed_m_s


class PoweredDescent(Pointing, Descent):
    """A camera that comes down to the ground by a gravity turn (see `Descent`)."""

    kind: Literal["powered_descent"]
    target: str
    """Name of the body."""
    height_m: Positive
    """Height of the camera over the ground after the touch-down."""
    look: Literal["nadir", "thrust", "site"] = "nadir"
    """Optical axis: nadir, straight down; thrust, against the thrust, as for a camera below a
    lander; site, at the place of the touch-down."""
    tilt_deg: Annotated[float, Field(strict=True, ge=-180.0, le=180.0)] = 0.0
    """Angle from that axis towards the heading."""
    positions: Annotated[Integer, Field(ge=2)] | None = None
    """Number of positions, one per step, evenly in time from the start to the touch-down. Default:
    the descent takes its own time from the epoch on."""
    after: Literal["repeat", "hold"] = "hold"
    """After the touch-down: hold stays there; repeat starts again."""
