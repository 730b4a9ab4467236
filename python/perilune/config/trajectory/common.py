"""Keys that several kinds of trajectory share: axes, pointing and its noise, positions over
time."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from perilune.config.types import (
    Direction,
    FiniteRange,
    Integer,
    NonNegative,
    Positive,
    Strict,
    Vec3,
)

Frame = Literal["icrf", "target", "lvlh", "rsw"]
"""Axes at the target: icrf; target, its own axes; or those of its orbit about the central body.
lvlh: z towards the central body, y along the negative orbit normal, x completes them (forward).
rsw: x away from the central body, z along the orbit normal, y completes them (forward)."""

CameraAxes = Literal["opencv", "opengl"]
"""Camera axes that stated rotations refer to. opencv: x right, y down, z forward. opengl, as in
Blender: x right, y up, z backward."""

_Deviation = Annotated[NonNegative, Field(le=90.0)]


class Pointing(Strict):
    """Deviations from the stated view, drawn anew at every step."""

    aim_jitter_deg: _Deviation = 0.0
    """Standard deviation of the aim, about each of the two camera axes across the view."""
    pointing_noise_deg: _Deviation = 0.0
    """Standard deviation of an attitude error about each of the three camera axes. It is applied
    last, so it also affects the roll."""
    roll_deg: FiniteRange = (0.0, 0.0)
    """Roll about the optical axis: a number, or [smallest, largest], drawn uniformly."""
    clearance_m: NonNegative | None = 0.0
    """Least distance from every body's surface and every spacecraft's bounding sphere. null: the
    camera may be inside bounding spheres, but not inside a body. A frame that cannot keep it is an
    error."""


class Aimed(Pointing):
    """A camera placed relative to a target and looking at it."""

    target: str
    """Name of the spacecraft or body to look at."""
    frame: Frame = "icrf"
    """Axes of positions, directions and `up`, with the origin at the target's centre. icrf: fixed;
    target: the target's own; lvlh: z towards the target's central body, y along the negative orbit
    normal; rsw: x away from the central body, y forward, z along the orbit normal. All but icrf
    rotate with the target or its orbit."""
    aim_offset_m: Vec3 = (0.0, 0.0, 0.0)
    """Offset of the point to look at from the target's centre, in the axes of `frame`."""
    up: Direction = (0.0, 0.0, 1.0)
    """Up direction of the image, in the axes of `frame`."""


class Run(Strict):
    """How a trajectory is traversed: by steps or by time."""

    positions: Annotated[Integer, Field(ge=1)] | None = None
    """Number of positions, one per step, from the start to the end; 1: only the start. Default:
    time.frames_per_scene, if it is more than 1."""
    duration_s: Positive | None = None
    """Time from the start, which is at the epoch, to the end; instead of positions."""
    after: Literal["repeat", "hold"] = "repeat"
    """After the end: repeat starts again with new draws; hold stays at the end."""

    @model_validator(mode="after")
    def _by_one(self) -> Run:
        self._exactly_one("positions", "duration_s", optional=True)
        return self

    def natural_duration_s(self) -> float | None:
        """Duration in seconds that follows from the kind's own keys, if any."""
        return None

    def needs_run(self) -> bool:
        """Whether the kind needs positions or duration_s."""
        return True


class Redrawn(Strict):
    """A position drawn at random."""

    interval: Annotated[Integer, Field(ge=1)] = 1
    """Steps between draws of the position; time.frames_per_scene draws once a scene. In between it
    is fixed in its axes."""
