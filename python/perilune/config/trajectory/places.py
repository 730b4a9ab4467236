"""Trajectories that are a place: around a target, fixed, in a box, or above the ground."""

from __future__ import annotations

from typing import Literal

from pydantic import model_validator

from perilune.config.errors import fail
from perilune.config.standing import AltitudeAbove
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
    """Random directions and distances around a target, with which the camera moves."""

    kind: Literal["orbit_object"]
    target: str
    """Name of the spacecraft or body."""
    distance_m: PositiveRange
    """Distance from the target's centre: a number, or [smallest, largest], drawn uniformly."""
    distance_noise_m: NonNegative = 0.0
    """Half width of a uniform deviation that is added to the distance at every step."""
    sun_angle_deg: AngleRange | None = None
    """Limits of the phase angle, between target -> camera and target -> Sun; 0: fully lit."""
    cone_axis: Direction = (0.0, 0.0, 1.0)
    """Axis of the cone of `cone_angle_deg`, in the target's own axes."""
    cone_angle_deg: AngleRange | None = None
    """Limits of the angle between target -> camera and the cone's axis."""
    background: str | None = None
    """Name of a body that must be behind the target's centre."""
    roll_deg: FiniteRange = (-180.0, 180.0)
    """Roll about the optical axis, drawn uniformly; 0: ICRF +z is up in the image."""

    @model_validator(mode="after")
    def _noise(self) -> OrbitObject:
        _noise_fits(self.distance_noise_m, self.distance_m[0], "distance_m")
        if self.cone_angle_deg is None:
            self._only_with("cone_angle_deg", "cone_axis")
        return self


class Fixed(Aimed):
    """A fixed position relative to a target, looking at it."""

    kind: Literal["fixed"]
    position_m: Vec3
    """Position from the target's centre, in the axes of `frame`."""
    clearance_m: NonNegative | None = None
    """Least distance from surfaces, as for other kinds. null (default): the camera may be on a
    spacecraft."""


class RandomBox(Pointing, Redrawn):
    """Random positions in a box, with a random rotation or towards a target."""

    kind: Literal["random_box"]
    around: str | None = None
    """Body or spacecraft whose centre is the origin. Default: the origin of the root frame."""
    frame: Frame = "icrf"
    """Axes at `around`: icrf, target (its own), lvlh or rsw (of its orbit)."""
    min_m: Vec3
    """Lower corner of the box."""
    max_m: Vec3
    """Upper corner of the box; positions are uniform in between."""
    rotation_min_deg: Vec3 | None = None
    """Smallest roll, pitch, yaw of the camera, about the fixed axes x, y, z of `frame` in this
    order."""
    rotation_max_deg: Vec3 | None = None
    """Largest roll, pitch, yaw; each is drawn uniformly."""
    camera_axes: CameraAxes = "opencv"
    """Camera axes that the rotation refers to: opencv (x right, y down, z forward) or opengl
    (Blender's: y up, z backward)."""
    target: str | None = None
    """Body or spacecraft to look at, instead of a rotation."""
    target_min_m: Vec3 | None = None
    """Lower corner of a box of points to look at, in the axes of `frame`, instead of a rotation."""
    target_max_m: Vec3 | None = None
    """Upper corner of that box."""
    target_from: Literal["origin", "camera"] = "origin"
    """Origin of the box of points to look at: that of the box of positions, or each position of the
    camera, so that the point is a random direction."""
    up: Direction = (0.0, 0.0, 1.0)
    """Up direction of the image in the axes of `frame`; not with a rotation."""

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
    """A position above a point of a body's surface, rotating with the body."""

    kind: Literal["hover"]
    target: str
    """Name of the body."""
    lon_deg: FiniteRange = (-180.0, 180.0)
    """East longitude of the point: a number, or [smallest, largest], drawn uniformly."""
    lat_deg: FiniteRange = (-90.0, 90.0)
    """Latitude of the point, drawn uniformly over the sphere (in its sine)."""
    latitudes: Latitudes | None = None
    """geodetic: latitude of the surface normal; geocentric: of the line from the body's centre.
    Default: the same as the body's maps."""
    height_m: PositiveRange
    """Height above the point along the normal: a number, or [smallest, largest], drawn
    uniformly."""
    altitude_above: AltitudeAbove | None = None
    """What heights count from. terrain (default): the ground itself, that of a `shape` too. datum:
    the ellipsoid `radii_km`."""
    distance_noise_m: NonNegative = 0.0
    """Half width of a uniform deviation that is added to the height at every step."""
    off_nadir_deg: AngleRange = (0.0, 0.0)
    """Angle between the view and straight down, drawn uniformly; 0 looks at the point, 90 is
    horizontal."""
    azimuth_deg: FiniteRange = (-180.0, 180.0)
    """Direction in which the view is tilted, from north towards east, drawn uniformly. It is up in
    the image."""

    @model_validator(mode="after")
    def _limits(self) -> Hover:
        if self.lat_deg[0] < -90.0 or self.lat_deg[1] > 90.0:
            fail("lat_deg", "latitudes are -90 to 90")
        _noise_fits(self.distance_noise_m, self.height_m[0], "height_m")
        return self
