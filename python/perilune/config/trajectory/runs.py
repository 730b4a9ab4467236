"""Trajectories that lead somewhere: linear, spiral, flyby, centred, relative."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from perilune.config.errors import fail
from perilune.config.standing import AltitudeAbove
from perilune.config.trajectory.common import Aimed, CameraAxes, Run
from perilune.config.types import Direction, Finite, Integer, NonNegative, Positive, Strict, Vec3

_SPEEDS = ("start_speed_m_s", "end_speed_m_s")


class RelativePose(Strict):
    """A position, and optionally a rotation, in the axes of `frame` at the target's centre."""

    position_m: Vec3
    """Position from the target's centre."""
    rotation_deg: Vec3 | None = None
    """Roll, pitch, yaw of the camera, about the fixed axes x, y, z of `frame` in this order.
    Default: the camera looks at the target."""


class Linear(Aimed, Run):
    """A straight line relative to the target, such as an approach that slows down."""

    kind: Literal["linear"]
    start: RelativePose
    """Pose at the start."""
    end: RelativePose
    """Pose at the end. Both poses have a rotation or neither; the camera rotates evenly between
    them."""
    camera_axes: CameraAxes = "opencv"
    """Camera axes that the rotations refer to: opencv (x right, y down, z forward) or opengl
    (Blender's: y up, z backward)."""
    start_speed_m_s: NonNegative | None = None
    """Speed at the start; it changes evenly in time to `end_speed_m_s`. With positions or
    duration_s only the ratio of the two matters; without them they determine the duration."""
    end_speed_m_s: NonNegative | None = None
    """Speed at the end. Default of both: a constant speed."""

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
    """A spiral around the target, whose radius changes evenly with the angle.

    Less than one rotation with a shrinking radius is a flyby."""

    kind: Literal["spiral"]
    start_m: Vec3 | None = None
    """Start position in the axes of `frame`. Out of the plane, the spiral lies on a cone."""
    r_start_m: Positive | None = None
    """Distance at the start, in the plane and at `start_angle_deg`; instead of start_m."""
    r_end_m: Positive | None = None
    """Distance at the end. Default: as at the start, a circle."""
    plane: Literal["xy", "yz", "zx"] | None = None
    """Plane of the spiral by axes of `frame`; it turns from the first axis to the second. Default
    without `normal`: xy."""
    normal: Direction | None = None
    """Axis of rotation (right-handed), instead of plane."""
    start_angle_deg: Finite = 0.0
    """With r_start_m: angle from the first axis of `plane`; with `normal`, from the projection of
    the axis x of `frame` (of y, if x is the normal)."""
    rotations: Finite = 1.0
    """Number of turns from start to end; negative ones turn the other way."""
    distance_noise_m: NonNegative = 0.0
    """Half width of a uniform deviation that is added to the distance at every step."""
    up: Direction | None = None  # type: ignore[assignment]
    """Up direction of the image in the axes of `frame`. Default: the axis of rotation."""

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
    """A straight pass with a given closest distance, at constant speed."""

    kind: Literal["flyby"]
    closest_m: NonNegative
    """Closest distance from the target's centre, or height there with `altitude_above`."""
    altitude_above: AltitudeAbove | None = None
    """closest_m is a height at the closest point over a body, in `frame: target`. terrain: over the
    ground itself, that of a `shape` too. datum: over the ellipsoid `radii_km`. Default: closest_m
    is a distance from the centre."""
    direction: Direction = (1.0, 0.0, 0.0)
    """Direction of motion, in the axes of `frame`."""
    side: Direction = (0.0, 0.0, 1.0)
    """Direction from the target to the closest point; its component along `direction` is
    ignored."""
    before_m: NonNegative
    """Length of the path before the closest point."""
    after_m: NonNegative | None = None
    """Length of the path after the closest point. Default: before_m."""
    up: Direction | None = None  # type: ignore[assignment]
    """Up direction of the image in the axes of `frame`. Default: perpendicular to `direction` and
    `side`, so that the camera does not roll over."""

    @model_validator(mode="after")
    def _across(self) -> Flyby:
        along = sum(a * b for a, b in zip(self.direction, self.side, strict=True))
        if abs(along) > 1.0 - 1e-12:
            fail("side", "must not be along `direction`")
        if self.altitude_above is not None and self.frame != "target":
            fail("altitude_above", "only with frame: target, in which the ground stands still")
        return self


class CentredTarget(Aimed, Run):
    """A position on a line from the target, looking at it; with `landing`, a descent along that
    line."""

    kind: Literal["centred_target"]
    direction: Direction | None = None
    """Direction from the target to the camera, in the axes of `frame`. Default: drawn for every
    run."""
    distance_m: Positive | None = None
    """Distance from the target's centre at the start."""
    distance_scale: Positive | None = None
    """Distance at the start in radii of the target (a body's largest, or that of a spacecraft's
    bounding sphere), instead of distance_m. Default of both: 3 radii."""
    landing: Annotated[bool, Field(strict=True)] = False
    """Whether the camera descends to `final_distance_m`; its distance to the surface falls by the
    same factor at every step. false: the distance stays."""
    final_distance_m: Positive | None = None
    """With landing: distance at the end from the body's surface, or the spacecraft's bounding
    sphere, along the line."""

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
    """Position and velocity relative to the target, in the rotating axes of `frame`."""

    position_m: Vec3
    velocity_m_s: Vec3 = (0.0, 0.0, 0.0)


class RelativeEllipse(Strict):
    """A bounded relative orbit: an ellipse in the orbital plane, twice as long (forward) as high
    (radially)."""

    radial_m: NonNegative
    """Radial semi-axis; the forward semi-axis is twice as long."""
    phase_deg: Finite = 0.0
    """Phase at the start: 0 is straight below the centre of the ellipse, 90 farthest ahead."""
    normal_m: NonNegative = 0.0
    """Amplitude along the orbit normal."""
    normal_phase_deg: Finite = 0.0
    """Phase of the motion along the normal at the start: 0 is in the orbital plane, rising."""
    ahead_m: Finite = 0.0
    """Forward offset of the centre of the ellipse from the target."""


class Relative(Aimed, Run):
    """Free motion beside the target on its orbit (Clohessy-Wiltshire), looking at the target."""

    kind: Literal["relative"]
    frame: Literal["rsw", "lvlh"] = "rsw"
    """Axes of the state, `up` and `aim_offset_m`. rsw: x away from the target's central body, y
    forward, z along the orbit normal; lvlh: z towards the central body, y along the negative orbit
    normal."""
    up: Direction | None = None  # type: ignore[assignment]
    """Up direction of the image in the axes of `frame`. Default: the orbit normal; away from the
    central body if the run starts within 30 degrees of the normal."""
    state: RelativeState | None = None
    """State at the start of the run."""
    ellipse: RelativeEllipse | None = None
    """Bounded orbit, instead of a state."""
    duration_s: Positive | None = None
    """Time from start to end; with positions, one revolution of the target by default. Without
    either, the motion goes on from the epoch with the time of the frames."""
    positions: Annotated[Integer, Field(ge=1)] | None = None
    """Number of positions, one per step, over `duration_s`."""

    @model_validator(mode="after")
    def _one_start(self) -> Relative:
        self._exactly_one("state", "ellipse")
        if self.positions is None and self.duration_s is None:
            self._only_with("positions or duration_s", "after")
        return self

    @model_validator(mode="after")
    def _by_one(self) -> Relative:
        """Overridden, because positions and duration_s may be given together here."""
        return self

    def needs_run(self) -> bool:
        return False  # the default is the time of the frames
