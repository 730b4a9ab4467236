"""The section camera.lens: one model a kind of distortion, coefficients as in OpenCV."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from perilune.config.types import Finite, Strict


class _Lens(Strict):
    labels: Literal["distorted", "undistorted"] = "distorted"
    """distorted: labels lie on the image. undistorted: labels are those of the pinhole camera K
    alone, and cost a second pass where colour is asked for too."""


class BrownConrady(_Lens):
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


class Fisheye(_Lens):
    """The angle off the axis is the radius: theta (1 + k1 theta^2 + ... + k4 theta^8), OpenCV's
    fisheye model. Sees beyond a right angle; give focal_px or K, pixels per radian."""

    model: Literal["fisheye"]
    k1: Finite = 0.0
    k2: Finite = 0.0
    k3: Finite = 0.0
    k4: Finite = 0.0


Lens = Annotated[BrownConrady | Fisheye, Field(discriminator="model")]
