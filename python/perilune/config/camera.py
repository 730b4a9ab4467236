"""The camera's section of the schema: intrinsics, exposure and the kinds of trajectory."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from perilune.config.errors import fail
from perilune.config.types import (
    AngleRange,
    Direction,
    Finite,
    FiniteRange,
    Fraction,
    Integer,
    NonNegative,
    Positive,
    PositiveRange,
    Strict,
    Vec3,
)


class OrbitObject(Strict):
    """Random directions and distances around a target; the camera moves with the target."""

    kind: Literal["orbit_object"]
    target: str
    """Name of a spacecraft or body."""
    distance_m: PositiveRange
    """Distance of the target's centre: a number, or [smallest, largest], drawn uniformly."""
    sun_angle_deg: AngleRange | None = None
    """Limits of the angle between target -> camera and target -> Sun: 0 is full light."""
    cone_axis: Direction = (0.0, 0.0, 1.0)
    """Axis of the cone of `cone_angle_deg`, in the target's frame."""
    cone_angle_deg: AngleRange | None = None
    """Limits of the angle between target -> camera and the cone's axis."""
    background: str | None = None
    """A body that must lie behind the target's centre."""
    aim_jitter_deg: Annotated[NonNegative, Field(le=90.0)] = 0.0
    """Standard deviation of the aim, about each of the two camera axes."""
    roll_deg: FiniteRange = (-180.0, 180.0)
    """About the optical axis, drawn uniformly; 0: ICRF +z is up in the image."""
    clearance_m: NonNegative = 0.0
    """Least distance from every body's surface and every spacecraft's bounding sphere."""


class Fixed(Strict):
    """A fixed place relative to a target, looking at it."""

    kind: Literal["fixed"]
    target: str
    """Name of a spacecraft or body."""
    position_m: Vec3
    """From the target's centre, in the axes of `frame`."""
    frame: Literal["icrf", "target"] = "icrf"
    """ICRF axes, or the target's own, with which the camera then turns."""
    aim_offset_m: Vec3 = (0.0, 0.0, 0.0)
    """The point looked at, from the target's centre, in the axes of `frame`."""
    up: Direction = (0.0, 0.0, 1.0)
    """What is up in the image, in the axes of `frame`."""
    roll_deg: Finite = 0.0
    """About the optical axis."""


class Hook(Strict):
    """A function of the user's, called as function(world, **params) with a perilune.world.World."""

    kind: Literal["hook"]
    function: str
    """module:function; returns a camera pose (7,), or two (2, 7): shutter opening and closing."""
    params: dict[str, Any] = Field(default_factory=dict)
    """Handed to the function."""

    @field_validator("function")
    @classmethod
    def _module_function(cls, value: str) -> str:
        module, _, function = value.partition(":")
        if not module or not all(part.isidentifier() for part in function.split(".")):
            fail("", "must be module:function")
        return value


class Exposure(Strict):
    """Radiance to display values."""

    mode: Literal["auto", "fixed"] = "auto"
    percentile: Annotated[float, Field(strict=True, gt=0.0, le=100.0)] = 99.0
    """auto: this percentile of the lit pixels ..."""
    key: Annotated[Fraction, Field(gt=0.0)] = 0.8
    """... is shown at this fraction of white (linear)."""
    white_radiance_w_m2_sr: Positive | None = None
    """fixed: the radiance shown as white."""

    @model_validator(mode="after")
    def _complete(self) -> Exposure:
        if self.mode == "fixed" and self.white_radiance_w_m2_sr is None:
            fail("white_radiance_w_m2_sr", "required for mode: fixed")
        if self.mode == "auto" and self.white_radiance_w_m2_sr is not None:
            fail("white_radiance_w_m2_sr", "only for mode: fixed")
        return self


Matrix = tuple[Finite, Finite, Finite, Finite, Finite, Finite, Finite, Finite, Finite]
INTRINSICS = ("fov_deg", "focal_px", "K")
"""Keys of which a camera has exactly one."""


def check_matrix(K: Matrix) -> None:
    """Inside a validator: refuses what is no matrix of a pinhole camera."""
    if K[0] <= 0.0 or K[4] <= 0.0:
        fail("K", "the focal lengths K[0] and K[4] must be positive")
    if K[3] != 0.0 or K[6:] != (0.0, 0.0, 1.0):
        fail("K", "must be [fx, s, cx, 0, fy, cy, 0, 0, 1]")


class Camera(Strict):
    """A pinhole camera; integer pixel centres, OpenCV axes (x right, y down, z forward)."""

    width: Annotated[Integer, Field(ge=1, le=32768)]
    height: Annotated[Integer, Field(ge=1, le=32768)]
    fov_deg: Annotated[float, Field(strict=True, gt=0.0, lt=180.0)] | None = None
    """Horizontal field of view, edge to edge."""
    focal_px: Positive | None = None
    K: Matrix | None = None
    """Row-major 3x3 matrix, pixels."""
    trajectory: Annotated[OrbitObject | Fixed | Hook, Field(discriminator="kind")]
    exposure_time_s: NonNegative = 0.0
    """Shutter opening to closing; frame times are openings."""
    exposure: Exposure = Exposure()

    @model_validator(mode="after")
    def _intrinsics(self) -> Camera:
        self._exactly_one(*INTRINSICS)
        if self.K is not None:
            check_matrix(self.K)
        return self
