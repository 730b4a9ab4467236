"""Sections of the trajectories that are a place: random around a target, fixed, in a box, hover."""

from __future__ import annotations

from typing import Literal

from pydantic import model_validator

from perilune.config.errors import fail
from perilune.config.trajectory.common import Aimed, CameraAxes, Frame, Pointing, Redrawn
from perilune.config.types import (
    AngleRange,
    Direction,
    FiniteRange,
    Latitudes,
    NonNegative,
    PositiveRange,
    Vec3,
)


def _noise_fits(noise: float, smallest: float, key: str) -> None:
    if noise > 0.0 and noise >= smallest:
        fail("distance_noise_m", f"{noise:g} must be below the smallest {key}, {smallest:g}")


class OrbitObject(Pointing, Redrawn):
    """Random directions and distances around a target; the camera moves with the target."""

    kind: Literal["orbit_object"]
    target: str
    """Name of a spacecraft or body."""
    distance_m: PositiveRange
    """Distance of the target's centre: a number, or [smallest, largest], drawn uniformly."""
    distance_noise_m: NonNegative = 0.0
    """Added to the distance at every step, uniform within plus and minus this."""
    sun_angle_deg: AngleRange | None = None
    """Limits of the angle between target -> camera and target -> Sun: 0 is full light."""
    cone_axis: Direction = (0.0, 0.0, 1.0)
    """Axis of the cone of `cone_angle_deg`, in the target's frame."""
    cone_angle_deg: AngleRange | None = None
    """Limits of the angle between target -> camera and the cone's axis."""
    background: str | None = None
    """A body that must lie behind the target's centre."""
    roll_deg: FiniteRange = (-180.0, 180.0)
    """About the optical axis, drawn uniformly; 0: ICRF +z is up in the image."""

    @model_validator(mode="after")
    def _noise(self) -> OrbitObject:
        _noise_fits(self.distance_noise_m, self.distance_m[0], "distance_m")
        if self.cone_angle_deg is None:
            self._only_with("cone_angle_deg", "cone_axis")
        return self


class Fixed(Aimed):
    """A fixed place relative to a target, looking at it."""

    kind: Literal["fixed"]
    position_m: Vec3
    """From the target's centre, in the axes of `frame`."""
    clearance_m: NonNegative | None = None
    """As elsewhere; by default (null) the camera may sit on a spacecraft."""


class RandomBox(Pointing, Redrawn):
    """Random places in a box, turned at random or towards something."""

    kind: Literal["random_box"]
    around: str | None = None
    """A body or spacecraft whose centre is the origin; default: the root frame's."""
    frame: Frame = "icrf"
    """Axes at `around`: icrf, target (its own), lvlh or rsw (of its orbit)."""
    min_m: Vec3
    """Corner of the box."""
    max_m: Vec3
    """Opposite corner; positions are uniform in between."""
    rotation_min_deg: Vec3 | None = None
    """Smallest roll, pitch, yaw of the camera, about the axes of `frame` one after the other."""
    rotation_max_deg: Vec3 | None = None
    """Largest; each is drawn uniformly."""
    camera_axes: CameraAxes = "opencv"
    """What the rotation turns: opencv (x right, y down, z forward) or opengl (Blender's: y up,
    z backward)."""
    target: str | None = None
    """Instead of a rotation: a body or spacecraft to look at."""
    target_min_m: Vec3 | None = None
    """Instead of a rotation: a corner of a box of points to look at, in the axes of `frame`."""
    target_max_m: Vec3 | None = None
    """Opposite corner."""
    target_from: Literal["origin", "camera"] = "origin"
    """Where the box of points to look at counts from: the origin of the box of places, or each
    place of the camera (the point is then a random direction)."""
    up: Direction = (0.0, 0.0, 1.0)
    """With something to look at: what is up in the image, in the axes of `frame`."""

    @model_validator(mode="after")
    def _complete(self) -> RandomBox:
        self._exactly_one("rotation_min_deg", "target", "target_min_m")
        for low, high in (
            ("min_m", "max_m"),
            ("rotation_min_deg", "rotation_max_deg"),
            ("target_min_m", "target_max_m"),
        ):
            a, b = getattr(self, low), getattr(self, high)
            if (a is None) != (b is None):
                fail(high if b is None else low, f"{low} and {high} go together")
            if a is not None and any(x > y for x, y in zip(a, b, strict=True)):
                fail(high, f"must not be below {low} in any component")
        if self.target_min_m is None:
            self._only_with("target_min_m", "target_from")
        if self.rotation_min_deg is None:
            self._only_with("rotation_min_deg", "camera_axes")
        else:
            self._only_with("something to look at", "up")
        if self.around is None and self.frame != "icrf":
            fail("frame", f"{self.frame}: only with `around`")
        return self


class Hover(Pointing, Redrawn):
    """Over a point of a body's surface, turning with the body."""

    kind: Literal["hover"]
    target: str
    """Name of a body."""
    lon_deg: FiniteRange = (-180.0, 180.0)
    """East longitude of the point: a number, or [smallest, largest], drawn uniformly."""
    lat_deg: FiniteRange = (-90.0, 90.0)
    """Latitude of the point, drawn uniformly in its sine."""
    latitudes: Latitudes | None = None
    """geodetic: lon_deg and lat_deg are of the surface's normal; geocentric: of the line from the
    body's centre. Default: what the body's maps count by, so that the camera hovers over what they
    have there."""
    height_m: PositiveRange
    """Over the point, along the normal: a number, or [smallest, largest], drawn uniformly."""
    distance_noise_m: NonNegative = 0.0
    """Added to the height at every step, uniform within plus and minus this."""
    off_nadir_deg: AngleRange = (0.0, 0.0)
    """Angle of the view from straight down, drawn uniformly: 0 looks at the point, 90 is level."""
    azimuth_deg: FiniteRange = (-180.0, 180.0)
    """Where the view leans to, from north over east, drawn uniformly; that is up in the image."""

    @model_validator(mode="after")
    def _limits(self) -> Hover:
        if self.lat_deg[0] < -90.0 or self.lat_deg[1] > 90.0:
            fail("lat_deg", "latitudes are -90 to 90")
        _noise_fits(self.distance_noise_m, self.height_m[0], "height_m")
        return self
