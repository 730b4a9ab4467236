"""The rings of a body."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated

from pydantic import BeforeValidator, Field, model_validator

from perilune.config.errors import fail
from perilune.config.types import FileName, NonNegative, Positive, Strict, refuse_drawn, triple

_Fixed = BeforeValidator(refuse_drawn)
_Radius = Annotated[Positive, _Fixed]
_Depth = Annotated[float, Field(strict=True, ge=0.0, le=1000.0), _Fixed]
_Share = Annotated[float, Field(strict=True, ge=0.0, le=1.0), _Fixed]
_Colour = Annotated[tuple[NonNegative, NonNegative, NonNegative], BeforeValidator(triple), _Fixed]


def _check_order(inner_km: float, outer_km: float) -> None:
    if not outer_km > inner_km:
        fail("outer_radius_km", f"must be more than inner_radius_km, {inner_km:g}")


def _check_albedo(albedo: tuple[float, float, float] | None) -> None:
    if albedo is not None and max(albedo) > 1.0:
        fail("albedo", "must be at most 1")


class Ringlet(Strict):
    """A uniform part of the rings."""

    inner_radius_km: _Radius
    """Inner radius, from the body's centre."""
    outer_radius_km: _Radius
    """Outer radius, from the body's centre."""
    optical_depth: _Depth
    """Optical depth along the normal: a fraction exp(-depth) of the light passes straight
    through."""
    albedo: _Colour
    """Single-scattering albedo of the particles: a number for all bands, or linear [r, g, b]."""

    @model_validator(mode="after")
    def _valid(self) -> Ringlet:
        _check_order(self.inner_radius_km, self.outer_radius_km)
        _check_albedo(self.albedo)
        return self


class Rings(Strict):
    """Flat rings in a body's equatorial plane.

    Their particles scatter sunlight once and hide what is behind them. Give either `ringlets`, or
    radii with a map or with uniform values."""

    inner_radius_km: _Radius | None = None
    """Inner radius, from the body's centre."""
    outer_radius_km: _Radius | None = None
    """Outer radius, from the body's centre."""
    color_map: FileName | None = None
    """PNG, WebP or TIFF with 1 to 16384 columns from the inner to the outer radius. Alpha is the
    fraction of light that the rings block along their normal, the colour (sRGB) the
    single-scattering albedo. Relative to this file, or data:... under PERILUNE_DATA."""
    optical_depth: _Depth | None = None
    """Optical depth along the normal; with a map, a factor on the map's (default 1)."""
    albedo: _Colour | None = None
    """Single-scattering albedo; with a map, a factor on its colours (default 1), limited to 1."""
    ringlets: tuple[Ringlet, ...] = ()
    """Ringlets from the inside out, with gaps between them."""
    phase_exponent: Annotated[float, Field(strict=True, ge=0.0, le=20.0), _Fixed] = 3.092
    """Exponent of the phase function (scattering angle)^exponent, which is mostly backscattering.
    0: isotropic. The default was measured in Saturn's A ring (Dones, Cuzzi and Showalter 1993)."""
    dust_share: _Share = 0.0
    """Fraction of the scattered light that follows the Henyey-Greenstein phase function of dust."""
    dust_g: Annotated[float, Field(strict=True, ge=-0.98, le=0.98), _Fixed] = 0.7
    """Asymmetry parameter of the dust: mean cosine of the scattering angle; 1 is all forward."""

    @model_validator(mode="after")
    def _dusty(self) -> Rings:
        if "dust_share" not in self.model_fields_set:
            self._only_with("a dust_share", "dust_g")
        return self

    @model_validator(mode="after")
    def _one_form(self) -> Rings:
        plain = ("inner_radius_km", "outer_radius_km", "color_map", "optical_depth", "albedo")
        given = [key for key in plain if getattr(self, key) is not None]
        if self.ringlets:
            if given:
                fail(given[0], "give ringlets, or one ring by the other keys")
            for before, after in pairwise(self.ringlets):
                if after.inner_radius_km < before.outer_radius_km:
                    fail(
                        "ringlets",
                        f"one begins at {after.inner_radius_km:g} km, within the one before it",
                    )
            return self
        needed = ["inner_radius_km", "outer_radius_km"]
        if self.color_map is None:
            needed += ["optical_depth", "albedo"]
            _check_albedo(self.albedo)
        for key in needed:
            if key not in given:
                what = "a color_map" if key in ("optical_depth", "albedo") else "ringlets"
                fail(key, f"required without {what}")
        assert self.inner_radius_km is not None
        assert self.outer_radius_km is not None
        _check_order(self.inner_radius_km, self.outer_radius_km)
        return self
