"""The section `sky` of the schema: stars and background pictures."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from perilune.config.errors import fail_unread
from perilune.config.types import FileName, Finite, NonNegative, Strict


class Stars(Strict):
    """Stars from a catalogue, as point sources with physical flux and colour."""

    catalogue: FileName
    """Catalogue file: .csv with a header (ra_deg, dec_deg and vmag; optionally number, bv,
    temperature_k, pm_ra_mas_yr along the sky, pm_dec_mas_yr), or .json of the Bright Star Catalogue
    as a list of {RA, Dec, V, K, HR}; ICRF. Relative to this file, or data:... under
    PERILUNE_DATA."""
    limit_magnitude: Annotated[Finite, Field(ge=-30.0, le=60.0)] | None = None
    """Faintest magnitude to read. Default: all stars."""
    catalogue_year: Annotated[Finite, Field(ge=1800.0, le=2200.0)] = 2000.0
    """Julian year of the catalogue's positions. Proper motions bring them to the time of each
    frame, to 0.01 arcseconds."""
    aberration: Annotated[bool, Field(strict=True)] = True
    """Whether stellar aberration shifts positions, by up to 26 arcseconds. The camera moves with
    the root body about the Sun (not with `sun.direction`), and with its trajectory's target."""


class Background(Strict):
    """A picture behind everything: a map of the sky, or an image that fills the frame."""

    map: FileName | None = None
    """Map of the sky: equirectangular PNG, JPEG, WebP or TIFF, north up."""
    frame: Literal["icrf", "galactic", "ecliptic"] = "icrf"
    """map: its axes; ecliptic is that of J2000."""
    center_lon_deg: Finite = 0.0
    """map: right ascension or longitude of the centre column."""
    east: Literal["left", "right"] = "left"
    """map: side on which longitude grows; left for the sky as seen from within."""
    white_mag_arcsec2: Annotated[Finite, Field(ge=-20.0, le=60.0)] = 16.3
    """map: surface brightness (V) of white. Other values are linear after sRGB decoding. With the
    default, the Milky Way of NASA's Deep Star Map 2020 has a mean of 21."""
    image: FileName | None = None
    """Image file: PNG, JPEG, WebP or TIFF. A driver with a choice picks one of several."""
    fit: Literal["cover", "stretch"] = "cover"
    """image: cover crops it to the shape of the frame; stretch distorts it."""
    brightness: NonNegative = 1.0
    """image: radiance of its white, relative to the radiance that the display shows as white."""

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
    """What the camera sees behind everything.

    It lights nothing, and automatic exposure ignores it."""

    stars: Stars | None = None
    """Stars; none by default, because the package has no catalogue."""
    background: Background | None = None
    """Background picture; black by default."""
