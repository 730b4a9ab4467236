"""The section camera.lens: where it focuses, and one model a kind of distortion."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from perilune.config.types import Finite, NonNegative, Positive, Strict


class _Lens(Strict):
    focus_distance_m: Positive | Literal["infinity"] | None = None
    """Depth along the optical axis that is sharp; nearer and farther things blur in colour, never
    in labels. Without it all is sharp."""
    aperture_mm: Annotated[NonNegative, Field(le=1e5)] | None = None
    """Diameter of the lens, for its blur; 0: a pinhole. Default: as the camera's `sensor` says."""


class Rectilinear(_Lens):
    """No distortion."""

    model: Literal["rectilinear"] = "rectilinear"


class _Bent(_Lens):
    labels: Literal["distorted", "undistorted"] = "distorted"
    """distorted: labels lie on the image. undistorted: labels are those of the pinhole camera K
    alone, and cost a second pass where colour is asked for too."""


class BrownConrady(_Bent):
    """Radial and tangential polynomials, OpenCV's rational model of 8 coefficients:
    x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6) + 2 p1 x y
    + p2 (r^2 + 2 x^2), and y' likewise, of x = X / Z and y = Y / Z."""

    model: Literal["brown_conrady"]
    k1: Finite = 0.0
    k2: Finite = 0.0
    p1: Finite = 0.0
    p2: Finite = 0.0
    k3: Finite = 0.0
    k4: Finite = 0.0
    k5: Finite = 0.0
    k6: Finite = 0.0


class Fisheye(_Bent):
    """The angle off the axis is the radius: theta (1 + k1 theta^2 + ... + k4 theta^8), OpenCV's
    fisheye model. Sees beyond a right angle; give focal_px or K, pixels per radian. Has no plane of
    focus."""

    model: Literal["fisheye"]
    k1: Finite = 0.0
    k2: Finite = 0.0
    k3: Finite = 0.0
    k4: Finite = 0.0


def _modelled(value: Any) -> Any:
    if isinstance(value, Mapping) and "model" not in value:
        return {"model": "rectilinear", **value}
    return value


Lens = Annotated[
    Annotated[Rectilinear | BrownConrady | Fisheye, Field(discriminator="model")],
    BeforeValidator(_modelled),
]
