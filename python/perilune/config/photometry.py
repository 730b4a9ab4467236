"""The section `photometry` of a body: parameters of Hapke's model and simpler ones."""

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
    """Parameters of a photometric model besides the albedo (w of Hapke's model).

    Keys that are not given come from the maps or, without maps, are medians of the Moon (Sato et
    al. 2014). Numbers are for all bands, or [r, g, b]."""

    maps: tuple[FileName, ...] = ()
    """GeoTIFF with the bands w, b, c, B_C0, h_C, B_S0, h_S, roughness in degrees and filling
    factor, as in the LROC WAC Hapke parameter maps: one file for all colours, or [red, green,
    blue]. Their w is used if there is no color_map. Beyond their edges, the edge values are
    used."""
    b: _Lobes | None = None
    """Parameter b of the two-term Henyey-Greenstein phase function: width of the lobes."""
    c: _Backs | None = None
    """Parameter c of the same function: 1 is all backward, -1 all forward. Fits to the Moon exceed
    1."""
    b_s0: _Surges | None = None
    """Amplitude of the shadow-hiding opposition effect."""
    h_s: _Surges | None = None
    """Angular half width of the shadow-hiding opposition effect; 0: none."""
    b_c0: _Surges | None = None
    """Amplitude of the coherent-backscatter opposition effect."""
    h_c: _Surges | None = None
    """Angular half width of the coherent-backscatter opposition effect; 0: none."""
    filling: Annotated[float, Field(strict=True, ge=0.0, le=0.75)] | None = None
    """Filling factor: fraction of the volume that grains fill."""
    roughness_deg: Annotated[float, Field(strict=True, ge=0.0, le=60.0)] | None = None
    """Macroscopic roughness: mean slope of relief below the resolution."""
    k: Annotated[float, Field(strict=True, ge=0.0, le=2.0)] | None = None
    """Minnaert exponent."""
    h_function: Literal["improved", "simple"] = "improved"
    """Approximation of the H function of multiple scattering: improved (Hapke 2002) or simple
    (Hapke 1981)."""
    coherent_surge: Literal["2002", "2012"] = "2002"
    """Shape of the coherent-backscatter peak: Hapke 2002 or 2012. Parameters fitted with one do not
    suit the other."""
