"""The section `camera.lens` of the schema: focus, and one class for each model of distortion."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from perilune.config.types import Finite, NonNegative, Positive, Strict


class _Lens(Strict):
    focus_distance_m: Positive | Literal["infinity"] | None = None
    """Distance of the plane of focus along the optical axis. Nearer and farther objects are blurred
    in colour channels, never in labels. Default: everything is sharp."""
    aperture_mm: Annotated[NonNegative, Field(le=1e5)] | None = None
    """Diameter of the aperture that blurs; 0: a pinhole. Default: the aperture of the camera's
    `sensor`."""


class Rectilinear(_Lens):
    """No distortion."""

    model: Literal["rectilinear"] = "rectilinear"


class _Bent(_Lens):
    labels: Literal["distorted", "undistorted"] = "distorted"
    """distorted: labels match the distorted image. undistorted: labels are those of the pinhole
    camera K; a frame with colour channels then needs a second pass."""


class BrownConrady(_Bent):
    """Radial and tangential distortion, as in OpenCV's rational model with 8 coefficients: x' = x
    (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2),
    with x = X / Z, y = Y / Z and r^2 = x^2 + y^2; y' likewise."""

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
    """Equidistant projection with distortion, OpenCV's fisheye model: the image radius is theta (1
    + k1 theta^2 + ... + k4 theta^8) for an angle theta to the optical axis. It can see more than 90
    degrees off the axis; give focal_px or K, in pixels per radian. It has no plane of focus."""

    model: Literal["fisheye"]
    k1: Finite = 0.0
    k2: Finite = 0.0
    k3: Finite = 0.0
    k4: Finite = 0.0


class Equirectangular(_Lens):
    """A panorama: columns are azimuths, rows elevations, in equal steps; the optical axis is in the
    middle. Without focal_px and K it shows all directions, 360 by 180 degrees; these give a part of
    them, in pixels per radian. It has no plane of focus. Images do not join at their left and right
    edges: what lies on both has a box from edge to edge."""

    model: Literal["equirectangular"]


def _modelled(value: Any) -> Any:
    if isinstance(value, Mapping) and "model" not in value:
        return {"model": "rectilinear", **value}
    return value


Lens = Annotated[
    Annotated[Rectilinear | BrownConrady | Fisheye | Equirectangular, Field(discriminator="model")],
    BeforeValidator(_modelled),
]
