"""Keys of what stands on the ground of a body, moves over it or comes down to it."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from perilune.base.curves import curve
from perilune.config.errors import fail
from perilune.config.types import Finite, Latitudes, NonNegative, Positive, Strict

if TYPE_CHECKING:
    from perilune.config.schema import Config

_Latitude = Annotated[float, Field(strict=True, ge=-90.0, le=90.0)]


def _both(value: object) -> object:
    """For BeforeValidator: a single number becomes two."""
    return (value, value) if isinstance(value, (int, float)) else value


Footprint = Annotated[tuple[Positive, Positive], BeforeValidator(_both)]
AltitudeAbove = Literal["terrain", "datum"]
"""What heights count from. terrain: the ground itself, that of a `shape` too. datum: the ellipsoid
`radii_km`."""


class Place(Strict):
    """A place on a body."""

    lon_deg: Finite
    """East longitude."""
    lat_deg: _Latitude
    """Latitude."""
    latitudes: Latitudes | None = None
    """geodetic: latitude of the surface normal; geocentric: of the line from the body's centre.
    Default: the same as the body's maps."""


class Site(Place):
    """A place on a body, and what heights count from there."""

    altitude_above: AltitudeAbove | None = None
    """What heights count from. terrain (default): the ground itself, that of a `shape` too. datum:
    the ellipsoid `radii_km`."""


class Standing(Site):
    """What stands on the ground."""

    heading_deg: Finite = 0.0
    """Direction of the axis x, from north towards east."""
    level: Annotated[bool, Field(strict=True)] = False
    """Whether the axis z is the vertical. false: the normal of the ground under the footprint."""


class Way(Site):
    """A way over the ground: a smooth curve through waypoints, along which pitch and roll are those
    of the ground."""

    waypoints_m: Annotated[tuple[tuple[Finite, Finite], ...], Field(min_length=2)]
    """Points [east, north] in metres from the site, in the plane that touches the ellipsoid there;
    straight lines in it are great circles on the body. At least two."""
    level: Annotated[bool, Field(strict=True)] = False
    """Whether the axis z is the vertical. false: the normal of the ground under the footprint."""

    @model_validator(mode="after")
    def _apart(self) -> Way:
        for k, (a, b) in enumerate(itertools.pairwise(self.waypoints_m)):
            if a == b:
                fail(f"waypoints_m[{k + 1}]", "is the point before it")
        return self

    @property
    def length_m(self) -> float:
        """Length of the curve in the plane of the site."""
        return curve(self.waypoints_m).length


class Descent(Site):
    """A powered descent from the epoch on: a gravity turn, that is thrust against the velocity
    over the ground, to a place above it, and then straight down.

    The gravity is that of a point mass; there is no air. The throttle is constant, at the thrust
    that ends the turn at `touchdown_speed_m_s` and `final_height_m`; after it, it carries the
    weight. The turn counts on the rotation of the body (Coriolis and centrifugal forces)."""

    place: Literal["touchdown", "start"] = "touchdown"
    """Whether lon_deg and lat_deg are the place of the touch-down or of the start."""
    heading_deg: Finite = 0.0
    """Direction of the horizontal velocity at the start, from north towards east."""
    start_height_m: Positive
    """Height at the start."""
    horizontal_speed_m_s: NonNegative
    """Horizontal speed over the ground at the start."""
    descent_speed_m_s: NonNegative = 0.0
    """Speed downwards at the start."""
    touchdown_speed_m_s: Annotated[Positive, Field(ge=0.01)] = 1.0
    """Speed at the end of the turn and at the touch-down."""
    final_height_m: NonNegative = 0.0
    """Height at which the turn ends. Below it, the descent is straight down at
    `touchdown_speed_m_s`."""
    specific_impulse_s: Positive | None = None
    """Specific impulse: the thrust accelerates more as propellant is used up. Default: the
    acceleration by the thrust is constant."""
    max_acceleration_m_s2: Positive | None = None
    """Acceleration by the whole thrust at the start. A descent that needs more is refused. Default:
    any thrust."""

    @model_validator(mode="after")
    def _slower(self) -> Descent:
        square = self.horizontal_speed_m_s**2 + self.descent_speed_m_s**2
        if not square > self.touchdown_speed_m_s**2:
            fail(
                "touchdown_speed_m_s",
                f"{self.touchdown_speed_m_s:g} must be below the speed at the start, "
                f"{square**0.5:g} m/s",
            )
        if self.final_height_m >= self.start_height_m:
            fail("final_height_m", f"must be below start_height_m, {self.start_height_m:g}")
        return self


def check_datum(config: Config, path: str, section: Any, body: str | None) -> None:
    """Inside a validator: refuses altitude_above where the datum is the ground."""
    if getattr(section, "altitude_above", None) is None or body not in config.bodies:
        return
    if config.bodies[body].shape is None and config.bodies[body].terrain is None:
        fail(f"{path}.altitude_above", f"{body} is a smooth ellipsoid: the datum is its ground")
