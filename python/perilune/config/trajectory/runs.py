"""Sections of the trajectories that lead somewhere: linear, spiral, flyby, centred, relative."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from perilune.config.errors import fail
from perilune.config.trajectory.common import Aimed, CameraAxes, Run
from perilune.config.types import Direction, Finite, Integer, NonNegative, Positive, Strict, Vec3

_SPEEDS = ("start_speed_m_s", "end_speed_m_s")


class RelativePose(Strict):
    """A place, and maybe a rotation, in the axes of `frame` at the target's centre."""

    position_m: Vec3
    rotation_deg: Vec3 | None = None
    """Roll, pitch, yaw of the camera, about the axes of `frame` one after the other; without it the
    camera looks at the target."""


class Linear(Aimed, Run):
    """A straight line relative to the target: an approach that may slow down."""

    kind: Literal["linear"]
    start: RelativePose
    end: RelativePose
    """Rotations in both or in neither; the camera turns evenly from one to the other."""
    camera_axes: CameraAxes = "opencv"
    """What the rotations turn: opencv (x right, y down, z forward) or opengl (Blender's: y up,
    z backward)."""
    start_speed_m_s: NonNegative | None = None
    """With `end_speed_m_s`: the speed changes evenly in time from one to the other. With positions
    or duration_s only their ratio counts; without, they say how long the way takes."""
    end_speed_m_s: NonNegative | None = None
    """Default of both: the same speed all the way."""

    @model_validator(mode="after")
    def _complete(self) -> Linear:
        if (self.start.rotation_deg is None) != (self.end.rotation_deg is None):
            fail("end.rotation_deg", "give rotation_deg of both start and end, or of neither")
        if self.start.rotation_deg is None:
            self._only_with("rotation_deg in start and end", "camera_axes")
        else:
            self._only_with("a look at the target: rotations say it", "aim_offset_m", "up")
        given = [key for key in _SPEEDS if getattr(self, key) is not None]
        if len(given) == 1:
            fail(given[0], f"{' and '.join(_SPEEDS)} go together")
        if given and not self.start_speed_m_s and not self.end_speed_m_s:
            fail("end_speed_m_s", "one of the two speeds must be positive")
        return self

    def natural_duration_s(self) -> float | None:
        if self.start_speed_m_s is None or self.end_speed_m_s is None:
            return None
        length = math.dist(self.start.position_m, self.end.position_m)
        return 2.0 * length / (self.start_speed_m_s + self.end_speed_m_s) or None


class Spiral(Aimed, Run):
    """Around the target with a radius that changes evenly with the angle; less than one rotation
    with a falling radius is a flyby."""

    kind: Literal["spiral"]
    start_m: Vec3 | None = None
    """Where it starts, in the axes of `frame`. Out of the plane it winds around a cone."""
    r_start_m: Positive | None = None
    """Instead of start_m: the distance at the start, in the plane, at `start_angle_deg`."""
    r_end_m: Positive | None = None
    """The distance at the end; default: as at the start, a circle."""
    plane: Literal["xy", "yz", "zx"] | None = None
    """Plane of the turning, by axes of `frame`: it goes from the first axis to the second. Default
    without `normal`: xy."""
    normal: Direction | None = None
    """Instead of plane: axis of the turning, right-handed."""
    start_angle_deg: Finite = 0.0
    """With r_start_m: from the plane's first axis; with `normal`, from the axis x of `frame` as it
    falls on the plane (y, where x is the normal)."""
    rotations: Finite = 1.0
    """Turns from start to end; negative ones go the other way."""
    distance_noise_m: NonNegative = 0.0
    """Added to the distance at every step, uniform within plus and minus this."""
    up: Direction | None = None  # type: ignore[assignment]
    """What is up in the image, in the axes of `frame`; default: the axis of the turning."""

    @model_validator(mode="after")
    def _complete(self) -> Spiral:
        self._exactly_one("start_m", "r_start_m")
        self._exactly_one("plane", "normal", optional=True)
        if self.start_m is not None and self.start_angle_deg != 0.0:
            fail("start_angle_deg", "only with r_start_m; start_m says where it starts")
        start = math.hypot(*self.start_m) if self.start_m is not None else self.r_start_m
        assert start is not None  # one of the two is given
        if not start > 0.0:
            fail("start_m", "must not be the target's centre")
        smallest = min(start, self.r_end_m or start)
        if self.distance_noise_m > 0.0 and self.distance_noise_m >= smallest:
            fail("distance_noise_m", f"must be below the smallest distance, {smallest:g}")
        return self


class Flyby(Aimed, Run):
    """A straight pass at a stated closest distance, at even speed."""

    kind: Literal["flyby"]
    closest_m: NonNegative
    """Least distance from the target's centre."""
    direction: Direction = (1.0, 0.0, 0.0)
    """Of the motion, in the axes of `frame`."""
    side: Direction = (0.0, 0.0, 1.0)
    """From the target to the closest point; what of it is across `direction` counts."""
    before_m: NonNegative
    """How far before the closest point it starts, along the way."""
    after_m: NonNegative | None = None
    """How far behind it ends; default: as before."""
    up: Direction | None = None  # type: ignore[assignment]
    """What is up in the image, in the axes of `frame`; default: across `direction` and `side`, so
    that the camera does not roll over."""

    @model_validator(mode="after")
    def _across(self) -> Flyby:
        along = sum(a * b for a, b in zip(self.direction, self.side, strict=True))
        if abs(along) > 1.0 - 1e-12:
            fail("side", "must not be along `direction`")
        return self


class CentredTarget(Aimed, Run):
    """On a line from the target, looking at it; with `landing` down to a last distance."""

    kind: Literal["centred_target"]
    direction: Direction | None = None
    """From the target to the camera, in the axes of `frame`; default: drawn for every run."""
    distance_m: Positive | None = None
    """From the target's centre, at the start."""
    distance_scale: Positive | None = None
    """Instead of distance_m: in radii of the target, a body's largest or a spacecraft's bounding
    sphere's; default of both: 3 radii."""
    landing: Annotated[bool, Field(strict=True)] = False
    """Whether the run ends at `final_distance_m`: the distance to the surface falls by the same
    factor at every step. Without it the distance stays."""
    final_distance_m: Positive | None = None
    """With landing: distance at the end from the body's surface, or the spacecraft's bounding
    sphere, on the line."""

    @model_validator(mode="after")
    def _complete(self) -> CentredTarget:
        self._exactly_one("distance_m", "distance_scale", optional=True)
        if self.landing != (self.final_distance_m is not None):
            fail("final_distance_m", "required with landing: true, and only then")
        if not self.landing and self.direction is not None:
            self._only_with("landing, or a direction that is drawn", *Run.model_fields)
        return self

    def needs_run(self) -> bool:
        return self.landing or self.duration_s is not None


class RelativeState(Strict):
    """Position and velocity relative to the target, in the axes of `frame`, which turn."""

    position_m: Vec3
    velocity_m_s: Vec3 = (0.0, 0.0, 0.0)


class RelativeEllipse(Strict):
    """A bounded relative orbit: forward and radial parts make an ellipse twice as long as high."""

    radial_m: NonNegative
    """Half the height; half the length is twice that."""
    phase_deg: Finite = 0.0
    """At the start: 0 is straight below the centre of the ellipse, 90 the farthest ahead."""
    normal_m: NonNegative = 0.0
    """Amplitude along the orbit normal."""
    normal_phase_deg: Finite = 0.0
    """At the start: 0 is on the orbit's plane, rising."""
    ahead_m: Finite = 0.0
    """How far ahead of the target the centre of the ellipse lies."""


class Relative(Aimed, Run):
    """Free motion beside the target on its orbit (Clohessy-Wiltshire), looking at the target."""

    kind: Literal["relative"]
    frame: Literal["rsw", "lvlh"] = "rsw"
    """Axes of the state, `up` and `aim_offset_m`. rsw: x away from what the target orbits, y
    forward, z along the orbit normal; lvlh: z to what it orbits, y along minus the normal."""
    up: Direction | None = None  # type: ignore[assignment]
    """What is up in the image, in the axes of `frame`; default: along the orbit's normal, or away
    from what is orbited where the run starts within 30 degrees of the normal."""
    state: RelativeState | None = None
    """At the start of the run."""
    ellipse: RelativeEllipse | None = None
    """Instead of a state."""
    duration_s: Positive | None = None
    """Time from start to end. With positions: default one revolution of the target. Without either,
    the motion goes on from the epoch in the time of the frames."""
    positions: Annotated[Integer, Field(ge=1)] | None = None
    """Number of positions, one a step, over `duration_s`."""

    @model_validator(mode="after")
    def _one_start(self) -> Relative:
        self._exactly_one("state", "ellipse")
        if self.positions is None and self.duration_s is None:
            self._only_with("positions or duration_s", "after")
        return self

    @model_validator(mode="after")
    def _by_one(self) -> Relative:
        """Positions and duration go together here."""
        return self

    def needs_run(self) -> bool:
        return False  # the default is the time of the frames
