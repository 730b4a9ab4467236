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
    """Pose of a sensor on the platform, whose axes are those of its camera: x right, y down, z
    forward."""

    position_m: Vec3 = (0.0, 0.0, 0.0)
    """Position on the platform: x right, y down, z forward."""
    rotation_deg: Vec3 = (0.0, 0.0, 0.0)
    """Roll, pitch, yaw about the platform's x, then y, then z axis."""


def _quaternion(value: Pose) -> Pose:
    norm = math.hypot(*value[3:])
    if not norm > 0.0:
        fail("", "the quaternion [qw, qx, qy, qz] must not be zero")
    x, y, z, *q = value
    return (x, y, z, q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm)


def _mounting_tag(value: Any) -> str:
    return "pose" if isinstance(value, (list, tuple)) else "mounting"


Transformation = Annotated[
    Annotated[Annotated[Pose, AfterValidator(_quaternion)], Tag("pose")]
    | Annotated[Mounting, Tag("mounting")],
    Discriminator(_mounting_tag),
]


class Sensor(Strict):
    """A camera on the platform: its mounting, and the keys in which it differs from `camera`."""

    width: Annotated[Integer, Field(ge=1, le=32768)] | None = None
    """Image width in pixels. Default: the platform's."""
    height: Annotated[Integer, Field(ge=1, le=32768)] | None = None
    """Image height in pixels. Default: the platform's."""
    fov_deg: Annotated[float, Field(strict=True, gt=0.0, lt=180.0)] | None = None
    """Horizontal field of view, edge to edge. Replaces the platform's fov_deg, focal_px or K."""
    focal_px: Positive | None = None
    """Focal length in pixels. Replaces the platform's fov_deg, focal_px or K."""
    K: Matrix | None = None
    """Intrinsic matrix, 3x3 in row-major order, in pixels. Replaces the platform's fov_deg,
    focal_px or K."""
    lens: Lens | None = None
    """Distortion and focus. Replaces the platform's section as a whole."""
    exposure_time_s: NonNegative | None = None
    """Exposure time; the shutters of all sensors open at the time of the step."""
    line_time_us: Annotated[NonNegative, Field(le=1e12)] | None = None
    """Rolling shutter: delay between the opening of one row and the next."""
    exposure: Exposure | None = None
    """Exposure of `rgb`. Replaces the platform's section as a whole."""
    bands: Bands | None = None
    """Spectral bands of the channel `bands`. Replaces the platform's list as a whole."""
    sensor: ImageSensor | None = None
    """Image sensor. Replaces the platform's section as a whole."""
    transformation: Transformation = Mounting.of_defaults()
    """Pose on the platform: {position_m, rotation_deg}, or [x, y, z, qw, qx, qy, qz] in metres,
    from the sensor's axes to the platform's. `camera.trajectory` moves the platform, whose axes are
    x right, y down, z forward."""
    trigger_interval: Annotated[Integer, Field(ge=1)] = 1
    """Steps from one frame of the sensor to the next; the first is at step 0."""

    @model_validator(mode="after")
    def _intrinsics(self) -> Sensor:
        self._exactly_one(*INTRINSICS, optional=True)
        if self.K is not None:
            check_matrix(self.K)
        return self

    def camera(self, platform: Camera) -> Camera:
        """The platform's camera with the keys of this sensor."""
        own = {key: getattr(self, key) for key in Camera.model_fields if key != "trajectory"}
        own = {key: value for key, value in own.items() if value is not None}
        whole = self.lens is not None and self.lens.model == "equirectangular"
        if whole or any(key in own for key in INTRINSICS):
            own = {**dict.fromkeys(INTRINSICS), **own}
        return platform.model_copy(update=own)
