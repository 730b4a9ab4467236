"""Keypoints of spacecraft and landmarks on bodies: named points whose images are labels."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from perilune.config.types import FileName, Finite, Latitudes, StaticNonNegative, Strict, Vec3

PointName = Annotated[str, Field(min_length=1, max_length=200)]


def _placed(value: Any) -> Any:
    """Three numbers become a keypoint there."""
    return value if isinstance(value, Mapping) else {"position_m": value}


class Keypoint(Strict):
    """A point of a spacecraft; [x, y, z] stands for {position_m: [x, y, z]}."""

    position_m: Vec3
    """Place in the spacecraft's frame, with its moving parts at rest."""
    node: str | None = None
    """Node of the model that carries it, where nodes move. Default: the spacecraft itself."""


class Keypoints(Strict):
    """Keypoints of a spacecraft, for the table `keypoints` of a sample."""

    points: dict[PointName, Annotated[Keypoint, BeforeValidator(_placed)]] = Field(
        default_factory=dict
    )
    """Name -> place."""
    file: FileName | None = None
    """More of them in the spacecraft's frame, m: JSON (name: [x, y, z], or a list of [x, y, z]),
    CSV (name,x,y,z), NumPy (n, 3), or MATLAB with one array of 3 rows, as SPEED+ has it. Without
    names they are numbered from 1."""
    nodes: tuple[str, ...] = ()
    """Shell patterns on names of the model's nodes (case-insensitive): the origin of each is a
    keypoint of its name, and moves with it."""
    depth_m: StaticNonNegative = 0.01
    """How far a keypoint may lie below the surface of its own spacecraft and count as seen."""


class Landmark(Strict):
    """A place on the ground of a body."""

    lon_deg: Finite
    """East longitude."""
    lat_deg: Annotated[float, Field(strict=True, ge=-90.0, le=90.0)]
    """Latitude."""
    latitudes: Latitudes | None = None
    """geodetic: latitude of the surface normal; geocentric: of the line from the body's centre.
    Default: the same as the body's maps."""
    height_m: Finite = 0.0
    """Height over the ground, along the radius."""
