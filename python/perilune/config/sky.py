"""The section `sky` of the schema: stars, and pictures behind everything."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from perilune.config.errors import fail_unread
from perilune.config.types import FileName, Finite, NonNegative, Strict


class Stars(Strict):
    """Stars from a file, as points of light of the right strength and colour."""

    catalogue: FileName
    """.csv with a header (ra_deg, dec_deg and vmag; optional number, bv, temperature_k,
    pm_ra_mas_yr along the sky, pm_dec_mas_yr), or .json of the Bright Star Catalogue as a list of
    {RA, Dec, V, K, HR}; ICRF. Relative to this file, or data:... under PERILUNE_DATA."""
    limit_magnitude: Annotated[Finite, Field(ge=-30.0, le=60.0)] | None = None
    """Fainter stars are not read."""
    catalogue_year: Annotated[Finite, Field(ge=1800.0, le=2200.0)] = 2000.0
    """Julian year that the file's places are of: proper motions bring them to the time of each
    frame, to 0.01 arcseconds."""
    aberration: Annotated[bool, Field(strict=True)] = True
    """Places as a moving camera sees them, up to 26 arcseconds off: it moves with the root body
    about the Sun (not where `sun.direction` is given), and with its trajectory's target."""


class Background(Strict):
    """A picture behind everything: a map of the sky, or an image that fills the frame."""

    map: FileName | None = None
    """Equirectangular PNG, JPEG, WebP or TIFF of the sky; north up."""
    frame: Literal["icrf", "galactic", "ecliptic"] = "icrf"
    """map: its axes; ecliptic is that of J2000."""
    center_lon_deg: Finite = 0.0
    """map: right ascension, or longitude, of its centre column."""
    east: Literal["left", "right"] = "left"
    """map: where longitude grows to; left as the sky is seen from within."""
    white_mag_arcsec2: Annotated[Finite, Field(ge=-20.0, le=60.0)] = 16.3
    """map: surface brightness (V) of its white; values in between are linear after sRGB decoding.
    With the default the Milky Way of NASA's Deep Star Map 2020 has 21 on average."""
    image: FileName | None = None
    """PNG, JPEG, WebP or TIFF; a driver with a choice takes one of several."""
    fit: Literal["cover", "stretch"] = "cover"
    """image: cut to the frame's shape, or stretched to it."""
    brightness: NonNegative = 1.0
    """image: its white over the radiance that the display shows as white."""

    @model_validator(mode="after")
    def _one_kind(self) -> Background:
        self._exactly_one("map", "image")
        own = {
            "map": ("frame", "center_lon_deg", "east", "white_mag_arcsec2"),
            "image": ("fit", "brightness"),
        }
        other = "image" if self.image is None else "map"
        for key in own[other]:
            if key in self.model_fields_set:
                fail_unread(key, f"only for a background with `{other}`")
        return self


class Sky(Strict):
    """What the camera sees behind everything; it lights nothing, and no automatic exposure counts
    it."""

    stars: Stars | None = None
    """Without it there are none: there is no catalogue in the package."""
    background: Background | None = None
    """Black without it."""
