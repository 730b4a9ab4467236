"""The section `sensors` of the schema: several cameras on the platform that `camera` moves."""

from __future__ import annotations

import math
from typing import Annotated, Any

from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from perilune.config.bands import Bands
from perilune.config.camera import INTRINSICS, Camera, Exposure, Matrix, check_matrix
from perilune.config.errors import fail
from perilune.config.lens import Lens
from perilune.config.sensor import ImageSensor
from perilune.config.types import Finite, Integer, NonNegative, Positive, Strict, Vec3

Pose = tuple[Finite, Finite, Finite, Finite, Finite, Finite, Finite]


class Mounting(Strict):
    """Where a sensor sits on the platform; the platform's axes are those of its camera."""

    position_m: Vec3 = (0.0, 0.0, 0.0)
    """x right, y down, z forward."""
    rotation_deg: Vec3 = (0.0, 0.0, 0.0)
    """Roll, pitch, yaw: about the platform's x, then y, then z axis."""


def _quaternion(value: Pose) -> Pose:
    norm = math.hypot(*value[3:])
    if not norm > 0.0:
        fail("", "the quaternion [qw, qx, qy, qz] must not be zero")
    x, y, z, *q = value
    return (x, y, z, q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm)


def _mounting_tag(value: Any) -> str:
    return "pose" if isinstance(value, (list, tuple)) else "mounting"


class Sensor(Strict):
    """A camera on the platform: the keys of `camera` that it has differently, and its place."""

    width: Annotated[Integer, Field(ge=1, le=32768)] | None = None
    height: Annotated[Integer, Field(ge=1, le=32768)] | None = None
    fov_deg: Annotated[float, Field(strict=True, gt=0.0, lt=180.0)] | None = None
    """Horizontal field of view, edge to edge; replaces the platform's fov_deg, focal_px or K."""
    focal_px: Positive | None = None
    """Likewise."""
    K: Matrix | None = None
    """Likewise: a row-major 3x3 matrix, pixels."""
    lens: Lens | None = None
    """Replaces the platform's section as a whole."""
    exposure_time_s: NonNegative | None = None
    """Shutter opening to closing; all sensors of a step open together."""
    line_time_us: Annotated[NonNegative, Field(le=1e12)] | None = None
    """Rolling shutter: each row opens so much after the one above it."""
    exposure: Exposure | None = None
    """Replaces the platform's section as a whole."""
    bands: Bands | None = None
    """Replaces the platform's list as a whole."""
    sensor: ImageSensor | None = None
    """Likewise."""
    transformation: Annotated[
        Annotated[Annotated[Pose, AfterValidator(_quaternion)], Tag("pose")]
        | Annotated[Mounting, Tag("mounting")],
        Discriminator(_mounting_tag),
    ] = Mounting()
    """Sensor to platform: {position_m, rotation_deg}, or [x, y, z, qw, qx, qy, qz] in metres. The
    platform is where `camera.trajectory` puts it, with axes x right, y down, z forward."""
    trigger_interval: Annotated[Integer, Field(ge=1)] = 1
    """Takes a frame every so many steps, from step 0 on."""

    @model_validator(mode="after")
    def _intrinsics(self) -> Sensor:
        self._exactly_one(*INTRINSICS, optional=True)
        if self.K is not None:
            check_matrix(self.K)
        return self

    def camera(self, platform: Camera) -> Camera:
        """The platform's camera with this sensor's keys in it."""
        own = {key: getattr(self, key) for key in Camera.model_fields if key != "trajectory"}
        own = {key: value for key, value in own.items() if value is not None}
        if any(key in own for key in INTRINSICS):
            own = {**dict.fromkeys(INTRINSICS), **own}
        return platform.model_copy(update=own)
