"""Parameters of the photometric laws of a body: Hapke's model and the cheaper ones."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from perilune.config.types import FileName, Strict, triple

_Lobe = Annotated[float, Field(strict=True, ge=0.0, le=0.95)]
_Back = Annotated[float, Field(strict=True, ge=-2.0, le=2.0)]
_Surge = Annotated[float, Field(strict=True, ge=0.0, le=10.0)]
_Lobes = Annotated[tuple[_Lobe, _Lobe, _Lobe], BeforeValidator(triple)]
_Backs = Annotated[tuple[_Back, _Back, _Back], BeforeValidator(triple)]
_Surges = Annotated[tuple[_Surge, _Surge, _Surge], BeforeValidator(triple)]


class Photometry(Strict):
    """What a photometric law reads beside the albedo (w of Hapke's model).

    A key that is not given is the map's; without maps it is the median of the Moon (Sato et al.
    2014). Numbers are for all bands, or [r, g, b].
    """

    maps: tuple[FileName, ...] = ()
    """GeoTIFF of the bands w, b, c, B_C0, h_C, B_S0, h_S, roughness in degrees, filling factor, as
    the LROC WAC Hapke parameter maps: one for all colours, or [red, green, blue]. Their w is taken
    where there is no color_map. Beyond their edges the edge's values hold."""
    b: _Lobes | None = None
    """Width of the lobes of the two-term Henyey-Greenstein phase function."""
    c: _Backs | None = None
    """1 is all back, -1 all forward; fits to the Moon go beyond 1."""
    b_s0: _Surges | None = None
    """Height of the opposition surge by hidden shadows."""
    h_s: _Surges | None = None
    """Its half width; 0 is none."""
    b_c0: _Surges | None = None
    """Height of the opposition surge by coherent backscatter."""
    h_c: _Surges | None = None
    """Its half width; 0 is none."""
    filling: Annotated[float, Field(strict=True, ge=0.0, le=0.75)] | None = None
    """Part of the volume that grains fill."""
    roughness_deg: Annotated[float, Field(strict=True, ge=0.0, le=60.0)] | None = None
    """Mean slope of the relief that is too small to be seen."""
    k: Annotated[float, Field(strict=True, ge=0.0, le=2.0)] | None = None
    """Minnaert's exponent."""
    h_function: Literal["improved", "simple"] = "improved"
    """Of multiple scattering: Hapke 2002, or 1981."""
    coherent_surge: Literal["2002", "2012"] = "2002"
    """Its shape by Hapke 2002, or 2012; parameters fitted with one are not those of the other."""
