"""The Sun: its place, its light and its disc."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from perilune.config.bands import Spectrum
from perilune.config.types import Direction, Finite, Latitudes, NonNegative, Positive, Strict


class Angles(Strict):
    """A direction given by two angles, each of which takes a driver."""

    azimuth_deg: Finite
    """Angle about z, from x towards y."""
    elevation_deg: Annotated[float, Field(strict=True, ge=-90.0, le=90.0)]
    """Angle from the xy plane towards z."""


def _direction_tag(value: Any) -> str:
    return "angles" if isinstance(value, (Mapping, Angles)) else "vector"


def _vector(value: tuple[float, float, float] | Angles) -> tuple[float, float, float]:
    if not isinstance(value, Angles):
        return value
    azimuth, elevation = math.radians(value.azimuth_deg), math.radians(value.elevation_deg)
    flat = math.cos(elevation)
    return (flat * math.cos(azimuth), flat * math.sin(azimuth), math.sin(elevation))


_Micrometres = Annotated[float, Field(strict=True, ge=0.4226, le=1.1)]


SRGB_UM = (0.612, 0.549, 0.465)
"""Dominant wavelengths of the sRGB primaries red, green and blue, in micrometres."""


class SiteSun(Strict):
    """A place in the sky, seen from a site on the ellipsoid of the root body."""

    lon_deg: Finite
    """East longitude of the site."""
    lat_deg: Annotated[float, Field(strict=True, ge=-90.0, le=90.0)]
    """Latitude of the site."""
    latitudes: Latitudes | None = None
    """geodetic: latitude of the surface normal; geocentric: of the line from the body's centre.
    Default: the same as the body's maps."""
    azimuth_deg: Finite
    """Azimuth of the Sun's centre, from north towards east."""
    elevation_deg: Annotated[float, Field(strict=True, ge=-90.0, le=90.0)]
    """Elevation of the Sun's centre over the horizontal plane of the site."""


class Sun(Strict):
    """The Sun. Its position follows from the date, unless a direction is given."""

    radius_km: Positive = 695700.0
    """Radius of the disc."""
    irradiance_w_m2: NonNegative = 1361.0
    """Solar constant: irradiance at 1 au over all wavelengths."""
    spectrum: Spectrum | None = None
    """Spectrum of the Sun from a file. Default: a black body of 5850 K with 0.7 of its light below
    0.4 um, within 6 % of the Sun in every 50 nm from 0.3 to 1.1 um. Colours look the same with
    either."""
    band_wavelengths_um: tuple[_Micrometres, _Micrometres, _Micrometres] | None = None
    """Wavelengths of red, green and blue, at which limb darkening (Neckel 2005) and atmospheric
    scattering are computed. Default: 0.612, 0.549 and 0.465, those of sRGB. By default, limb
    darkening in images uses what the camera's `bands` see of each colour, and presets of
    atmospheres are means over each colour of sRGB."""
    direction: (
        Annotated[
            Annotated[Direction, Tag("vector")] | Annotated[Angles, Tag("angles")],
            Discriminator(_direction_tag),
            AfterValidator(_vector),
        ]
        | None
    ) = None
    """Direction from the root body to the Sun in ICRF axes, instead of that of the date: a vector,
    or {azimuth_deg, elevation_deg}."""
    at: SiteSun | None = None
    """Place of the Sun in the sky of a site on the root body, instead of that of the date; it stays
    there as the body rotates."""
    distance_au: Positive = 1.0
    """Distance of the Sun from the root body; used only with `direction` or `at`."""

    @property
    def wavelengths_um(self) -> tuple[float, float, float]:
        """Wavelengths of red, green and blue, in micrometres."""
        return self.band_wavelengths_um or SRGB_UM

    @property
    def by_date(self) -> bool:
        """Whether the date says where the Sun is."""
        return self.direction is None and self.at is None

    @model_validator(mode="after")
    def _given(self) -> Sun:
        self._exactly_one("direction", "at", optional=True)
        if self.by_date:
            self._only_with("direction or at: the date says where the Sun is", "distance_au")
        return self
