"""The camera's section of the schema: intrinsics, exposure, and how it moves."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from perilune.config.bands import Bands
from perilune.config.errors import fail
from perilune.config.lens import Lens
from perilune.config.sensor import ImageSensor
from perilune.config.trajectory import Trajectory
from perilune.config.types import Finite, Fraction, Integer, NonNegative, Positive, Strict


class Exposure(Strict):
    """Exposure of `rgb`: how radiance becomes display values."""

    mode: Literal["auto", "fixed"] = "auto"
    """auto: metered in each frame; fixed: white_radiance_w_m2_sr."""
    percentile: Annotated[float, Field(strict=True, gt=0.0, le=100.0)] = 99.0
    """auto: percentile of the lit pixels' luminance that is shown at the level `key`."""
    key: Annotated[Fraction, Field(gt=0.0)] = 0.8
    """auto: linear fraction of white at which the metered percentile is shown."""
    min_white_radiance_w_m2_sr: NonNegative = 1e-4
    """auto: lower limit of the radiance shown as white, so that dark scenes stay dark, as in a
    photograph. A sunlit white surface that is darker than the limit replaces it. The default suits
    f/1.4, half a second and ISO 50000, typical settings for pictures of cities from orbit. 0: no
    limit."""
    white_radiance_w_m2_sr: Positive | None = None
    """fixed: radiance shown as white."""

    @model_validator(mode="after")
    def _complete(self) -> Exposure:
        if self.mode == "fixed" and self.white_radiance_w_m2_sr is None:
            fail("white_radiance_w_m2_sr", "required for mode: fixed")
        if self.mode == "auto" and self.white_radiance_w_m2_sr is not None:
            self._only_with("mode: fixed", "white_radiance_w_m2_sr")
        if self.mode == "fixed":
            self._only_with("mode: auto", "percentile", "key", "min_white_radiance_w_m2_sr")
        return self


Matrix = tuple[Finite, Finite, Finite, Finite, Finite, Finite, Finite, Finite, Finite]
INTRINSICS = ("fov_deg", "focal_px", "K")
"""Keys for the focal length; a camera has exactly one of them."""


def check_matrix(K: Matrix) -> None:
    """Inside a validator: refuses a matrix that is not that of a pinhole camera."""
    if K[0] <= 0.0 or K[4] <= 0.0:
        fail("K", "the focal lengths K[0] and K[4] must be positive")
    if K[3] != 0.0 or K[6:] != (0.0, 0.0, 1.0):
        fail("K", "must be [fx, s, cx, 0, fy, cy, 0, 0, 1]")


class Camera(Strict):
    """A camera with integer pixel centres and OpenCV axes (x right, y down, z forward)."""

    width: Annotated[Integer, Field(ge=1, le=32768)]
    """Image width in pixels."""
    height: Annotated[Integer, Field(ge=1, le=32768)]
    """Image height in pixels."""
    fov_deg: Annotated[float, Field(strict=True, gt=0.0, lt=180.0)] | None = None
    """Horizontal field of view, edge to edge. A panorama takes focal_px or K in its place, or none:
    it then shows all directions."""
    focal_px: Positive | None = None
    """Focal length in pixels."""
    K: Matrix | None = None
    """Intrinsic matrix [fx, s, cx, 0, fy, cy, 0, 0, 1], 3x3 in row-major order, in pixels."""
    lens: Lens | None = None
    """Distortion and focus. Default: a pinhole camera without either. A pixel that the lens cannot
    see is an error."""
    trajectory: Trajectory
    exposure_time_s: NonNegative = 0.0
    """Exposure time; the shutter opens at the time of the frame. Motion during the exposure blurs
    the image, even where `sensor.exposure` chooses an exposure time of its own."""
    line_time_us: Annotated[NonNegative, Field(le=1e12)] = 0.0
    """Rolling shutter: delay between the opening of one row and the next, from the top down. 0: a
    global shutter."""
    exposure: Exposure = Exposure.of_defaults()
    bands: Bands = "srgb"
    """Spectral bands of the channel `bands`. srgb: red, green and blue of a display, weighted by
    the eye's response. monochrome: 0.4 to 0.9 um. Or a list of your own bands."""
    sensor: ImageSensor | None = None
    """Image sensor, which adds the channels `raw` and `sensor_rgb`; the other channels stay free of
    its noise."""

    @model_validator(mode="after")
    def _intrinsics(self) -> Camera:
        self._exactly_one(*INTRINSICS, optional=self.is_panorama)
        if self.K is not None:
            check_matrix(self.K)
        return self

    @property
    def window_s(self) -> float:
        """Time from the opening of the first row to the closing of the last, in seconds."""
        return self.exposure_time_s + 1e-6 * self.line_time_us * (self.height - 1)

    @property
    def is_panorama(self) -> bool:
        """Whether its image is equirectangular."""
        return self.lens is not None and self.lens.model == "equirectangular"

    @property
    def label_lens(self) -> Literal["distorted", "undistorted"] | None:
        """Whether labels include the lens's distortion; None for a camera without distortion."""
        lens = self.lens
        if lens is None or lens.model == "rectilinear":
            return None
        return "distorted" if lens.model == "equirectangular" else lens.labels

    def check_lens(self, where: str, fov: str) -> None:
        """Inside a validator: refuses an incomplete focus, and a panorama with a field of view.
        where, fov: key paths of lens and fov_deg."""
        lens = self.lens
        if self.is_panorama and self.fov_deg is not None:
            fail(
                fov,
                f"leave it out with {where}.model: equirectangular, which shows all directions, or "
                "give focal_px or K in pixels per radian for a part of them",
            )
        if not self.is_panorama and all(getattr(self, key) is None for key in INTRINSICS):
            fail(fov, "required: the platform's camera is a panorama, and this sensor is none")
        if lens is None or lens.focus_distance_m is None:
            if lens is not None and lens.aperture_mm is not None:
                fail(f"{where}.aperture_mm", "blurs nothing without focus_distance_m")
            return
        if lens.model in ("fisheye", "equirectangular"):
            kind = "a fisheye lens" if lens.model == "fisheye" else "a panorama"
            fail(f"{where}.focus_distance_m", f"{kind} has no plane of focus")
        if lens.aperture_mm is None and self.sensor is None:
            fail(f"{where}.aperture_mm", "required for a focus where there is no `sensor`")
