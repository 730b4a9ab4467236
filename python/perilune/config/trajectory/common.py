"""What the kinds of trajectory share: axes, the aim and its noise, and the run over positions."""

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
"""Axes at the target: ICRF's; its own; or those of its orbit: lvlh with z to the centre of what it
orbits, y along minus the orbit normal and x completing them (forward), rsw with x away from that
centre, z along the orbit normal and y completing them (forward)."""

CameraAxes = Literal["opencv", "opengl"]
"""What stated rotations turn: a camera with x right, y down, z forward; or as in Blender with
x right, y up, z backward."""

_Deviation = Annotated[NonNegative, Field(le=90.0)]


class Pointing(Strict):
    """What is added to the stated view. All of it is drawn anew at every step."""

    aim_jitter_deg: _Deviation = 0.0
    """Standard deviation of the aim, about each of the two camera axes across the view."""
    pointing_noise_deg: _Deviation = 0.0
    """Standard deviation of an error of attitude, about each of the three camera axes; comes last,
    so that roll has it too."""
    roll_deg: FiniteRange = (0.0, 0.0)
    """About the optical axis: a number, or [smallest, largest], drawn uniformly."""
    clearance_m: NonNegative | None = 0.0
    """Least distance from every body's surface and every spacecraft's bounding sphere; null: the
    camera may be inside those spheres, but not in a body. Where it cannot be kept the frame is an
    error that says so."""


class Aimed(Pointing):
    """Looking at a target, and placed relative to it."""

    target: str
    """Name of a spacecraft or body."""
    frame: Frame = "icrf"
    """Axes of positions, directions and `up`, with the origin at the target's centre: icrf; target:
    the target's own; lvlh: z to what the target orbits, y along minus the orbit normal; rsw: x away
    from what it orbits, y forward, z along the orbit normal. All but icrf turn with the target."""
    aim_offset_m: Vec3 = (0.0, 0.0, 0.0)
    """The point looked at, from the target's centre, in the axes of `frame`."""
    up: Direction = (0.0, 0.0, 1.0)
    """What is up in the image, in the axes of `frame`."""


class Run(Strict):
    """Going through a trajectory: by steps or by time."""

    positions: Annotated[Integer, Field(ge=1)] | None = None
    """Number of positions, one a step, the first at the start and the last at the end; 1: the start
    alone. Default: time.frames_per_scene, if that is more than 1."""
    duration_s: Positive | None = None
    """Instead of positions: from the start to the end in this time, the start at the epoch."""
    after: Literal["repeat", "hold"] = "repeat"
    """At the end: repeat goes through it again, with new draws; hold stays at the end."""

    @model_validator(mode="after")
    def _by_one(self) -> Run:
        self._exactly_one("positions", "duration_s", optional=True)
        return self

    def natural_duration_s(self) -> float | None:
        """How long a kind takes when it states this by itself."""
        return None

    def needs_run(self) -> bool:
        """Whether the kind must know how long it takes."""
        return True


class Redrawn(Strict):
    """Drawn at random."""

    interval: Annotated[Integer, Field(ge=1)] = 1
    """The place is drawn anew every so many steps (as many as time.frames_per_scene: once a
    scene); in between it stays in its axes."""
