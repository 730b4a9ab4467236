"""What the ground of a body has besides its colour: relief, open water, city lights."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from perilune.config.errors import fail
from perilune.config.types import FileName, Fraction, Rgb, Strict, refuse_drawn, triple

_Bands = Annotated[tuple[Fraction, Fraction, Fraction], BeforeValidator(triple)]
_Black = Annotated[float, Field(strict=True, ge=0.0, lt=1.0), BeforeValidator(refuse_drawn)]
_Height = Annotated[float, Field(strict=True, ge=-1e9, le=1e9)]


class Relief(Strict):
    """Terrain slopes from a height map, a normal map or both, which are then added.

    Slopes change the normals only: outlines stay smooth and mountains cast no shadows. Maps are
    equirectangular PNG, JPEG, WebP or TIFF, relative to this file, or data:... under PERILUNE_DATA;
    their centre is at the body's map_center_lon_deg."""

    height_map: FileName | None = None
    """Height map; needs height_m or height_unit_m. Grey PNG or TIFF with 16 bits, or TIFF with
    floats, keep all their levels. In files with 8 bits (red, if coloured) the 255 levels show as
    terraces, unless one level is small against the rise across a texel. Numbers that a TIFF marks
    as missing are filled from their neighbours, with a warning."""
    height_m: _Height | None = None
    """Height difference between black (0) and white (the largest number of the file's bit depth).
    Files of int16 or floats have no white: give height_unit_m."""
    height_unit_m: _Height | None = None
    """Metres per unit of the file's numbers (grey PNG and TIFF), instead of height_m: 1 for a TIFF
    in metres, 0.5 for LOLA's half metres. An offset makes no difference."""
    normal_map: FileName | None = None
    """Tangent-space normal map: red grows eastwards, green northwards or southwards, blue
    upwards."""
    normal_green: Literal["north", "south"] = "north"
    """Direction in which green of normal_map grows."""
    normal_strength: Annotated[float, Field(strict=True, ge=-1000.0, le=1000.0)] = 1.0
    """Factor on the slopes of normal_map; published maps are often steeper than the ground."""

    @model_validator(mode="after")
    def _complete(self) -> Relief:
        if self.height_map is None and self.normal_map is None:
            fail("height_map", "give height_map, normal_map or both")
        self._exactly_one("height_m", "height_unit_m", optional=True)
        if self.height_map is None:
            self._only_with("a height_map", "height_m", "height_unit_m")
        elif self.height_m is None and self.height_unit_m is None:
            fail("height_m", "height_map needs height_m (white over black) or height_unit_m (of 1)")
        if self.normal_map is None:
            self._only_with("a normal_map", "normal_green", "normal_strength")
        return self


class Ocean(Strict):
    """Open water: Fresnel reflection (index 1.34) on waves with the slope distribution of Cox and
    Munk (1954). No foam."""

    map: FileName | None = None
    """Water mask: white is water; a linear map like the others. Default: where the color_map is
    blue, that is where linear blue is more than 1.5 (fully: 2.5) times linear red."""
    wind_m_s: Annotated[float, Field(strict=True, ge=0.0, le=100.0)] = 7.0
    """Wind speed 12.5 m above the water, which sets the wave slopes. The mean over the oceans is
    about 7; slopes were measured up to 14."""
    albedo: _Bands | None = None
    """Albedo of the water body, below the surface. Default: the color_map. The open ocean has about
    [0.003, 0.01, 0.04]: most of its blue as seen from space comes from the air."""


class NightLights(Strict):
    """City lights, on where the Sun is down.

    They come on between sunset and the end of civil twilight, when the Sun is 6 degrees below the
    horizon. Texels of published maps are wider than towns, so a random pattern breaks their light
    up into towns and gaps. It is the same in every frame and keeps the map's mean, so distant views
    are as bright as the map."""

    map: FileName
    """Map of the lights: equirectangular PNG, JPEG, WebP or TIFF, sRGB."""
    radiance_w_m2_sr: Rgb = (1e-3, 1e-3, 1e-3)
    """Radiance where the map is white. Centres of large cities have 1e-3 (100 nW cm-2 sr-1 in
    VIIRS's day/night band; Roman et al. 2018), the brightest places ten times that."""
    detail_km: Annotated[float, Field(strict=True, ge=0.0, le=1e9)] | None = None
    """Size of the largest towns with their gaps; others are as small as a ninth of it. 0: the map
    unchanged. Default: a texel of the map at the equator (20 km for a map of the Earth 2048 pixels
    wide), at most a hundredth of the radius. No place is more than 60 times as bright as its
    map."""
    black: _Black | None = None
    """Black level: linear value of the map, 0 to 1, up to which there is no light; 0 uses the map
    unchanged. Default: per band, the 95th percentile over the body's area, at most 0.02, because
    many maps show unlit sea and land in dark blue. This assumes that at most a twentieth of the
    body is lit; otherwise 0.02 is subtracted everywhere."""
