"""What the ground of a body may have beside its colour: relief, open water, lights at night."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from perilune.config.errors import fail
from perilune.config.types import FileName, Fraction, Rgb, Strict, refuse_drawn, triple

_Bands = Annotated[tuple[Fraction, Fraction, Fraction], BeforeValidator(triple)]
_Black = Annotated[float, Field(strict=True, ge=0.0, lt=1.0), BeforeValidator(refuse_drawn)]
_Height = Annotated[float, Field(strict=True, ge=-1e9, le=1e9)]


class Relief(Strict):
    """Slopes of the ground, from a height map, a normal map or both, whose slopes are then added.

    They bend the normal alone: outlines stay smooth, and mountains cast no shadows. Maps are
    equirectangular, PNG, JPEG, WebP or TIFF, relative to this file, or data:... under
    PERILUNE_DATA, with the body's map_center_lon_deg in their middle."""

    height_map: FileName | None = None
    """Grey PNG or TIFF of 16 bits, or TIFF of floats, whose levels are all kept; of 8 bits (of
    colours, red) the 255 steps are terraces where one of them is not small against what a texel
    rises. With it, give height_m or height_unit_m. Numbers that a TIFF marks as missing are filled
    from those around them, with a warning."""
    height_m: _Height | None = None
    """Of white over black: of the largest number of so many bits over 0. Files of int16 or floats
    have no white: give height_unit_m."""
    height_unit_m: _Height | None = None
    """In the place of height_m: of one of the file's numbers (grey PNG and TIFF), as 1 of a TIFF in
    metres, or 0.5 of LOLA's in half metres. What number is the mean radius makes no difference."""
    normal_map: FileName | None = None
    """Red grows with a normal's lean eastwards, green north- or southwards, blue upwards."""
    normal_green: Literal["north", "south"] = "north"
    """Where green of normal_map grows to."""
    normal_strength: Annotated[float, Field(strict=True, ge=-1000.0, le=1000.0)] = 1.0
    """Factor on the slopes of normal_map; published ones are often steeper than the ground."""

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
    """Open water: Fresnel's law for an index of 1.34 on waves whose slopes are those of Cox and
    Munk (1954). No foam."""

    map: FileName | None = None
    """Where it is: white is water. A picture as other maps, linear. Without it, water is where
    the color_map is blue: where linear blue is more than 1.5 (fully: 2.5) times linear red."""
    wind_m_s: Annotated[float, Field(strict=True, ge=0.0, le=100.0)] = 7.0
    """12.5 m above the water; the mean over the oceans is about 7. Measured up to 14."""
    albedo: _Bands | None = None
    """Of what comes back from below the surface (default: the color_map's). The open ocean is about
    [0.003, 0.01, 0.04]: most of the blue that is seen from space is air."""


class NightLights(Strict):
    """Cities and the like. They come on from sunset to the end of civil twilight, 6 deg later.

    The texels of published maps are wider than towns: a random pattern, the same in every frame,
    breaks their light up into towns and gaps. It keeps the map's mean, so that far views are as
    bright as the map."""

    map: FileName
    """Equirectangular PNG, JPEG, WebP or TIFF, sRGB."""
    radiance_w_m2_sr: Rgb = (1e-3, 1e-3, 1e-3)
    """Where the map is white. Centres of large cities are 1e-3 (100 nW cm-2 sr-1 in VIIRS's
    day/night band; Roman et al. 2018), the brightest places ten times that."""
    detail_km: Annotated[float, Field(strict=True, ge=0.0, le=1e9)] | None = None
    """Size of the largest towns with the gaps between them; there are smaller ones, down to a ninth
    of it. 0: no towns, the map as it is. Default: a texel of the map at the equator (20 km of a map
    of the Earth 2048 wide), at most a hundredth of the radius. No place is more than 60 times as
    bright as its map."""
    black: _Black | None = None
    """Linear value of the map, 0..1, up to which there is no light: 0 takes the map as it is.
    Default: by band what all but a twentieth of the body's area is at most, up to 0.02, since many
    maps show seas and land that are not lit in dark blue. It assumes that no more is lit; where all
    of a body is, 0.02 is taken off all of it."""
