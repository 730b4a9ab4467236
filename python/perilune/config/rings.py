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
_Colour = Annotated[
    tuple[NonNegative, NonNegative, NonNegative], BeforeValidator(triple), _Fixed
]


def _check_order(inner_km: float, outer_km: float) -> None:
    if not outer_km > inner_km:
        fail("outer_radius_km", f"must be more than inner_radius_km, {inner_km:g}")


def _check_albedo(albedo: tuple[float, float, float] | None) -> None:
    if albedo is not None and max(albedo) > 1.0:
        fail("albedo", "must be at most 1")


class Ringlet(Strict):
    """An even part of the rings."""

    inner_radius_km: _Radius
    outer_radius_km: _Radius
    optical_depth: _Depth
    """Along the normal: exp(-depth) of the light comes straight through."""
    albedo: _Colour
    """Of single scattering by its particles: a number for all bands, or [r, g, b], linear."""

    @model_validator(mode="after")
    def _valid(self) -> Ringlet:
        _check_order(self.inner_radius_km, self.outer_radius_km)
        _check_albedo(self.albedo)
        return self


class Rings(Strict):
    """Flat rings in the plane of a body's equator, of particles that scatter the sun's light once,
    and hide what is behind them.

    Either `ringlets`, or radii with a map or with numbers for all of them."""

    inner_radius_km: _Radius | None = None
    """From the body's centre."""
    outer_radius_km: _Radius | None = None
    color_map: FileName | None = None
    """PNG, WebP or TIFF; columns from the inner to the outer radius. Alpha is the part of the light
    that the rings hold back along their normal, the colour (sRGB) the albedo of single scattering.
    Relative to this file, or data:... under PERILUNE_DATA; 1 to 16384 columns."""
    optical_depth: _Depth | None = None
    """Along the normal; with a map a factor on its own (default 1)."""
    albedo: _Colour | None = None
    """Of single scattering; with a map a factor on its colours (default 1), which end at 1."""
    ringlets: tuple[Ringlet, ...] = ()
    """From the inside to the outside; between them are gaps."""
    phase_exponent: Annotated[float, Field(strict=True, ge=0.0, le=20.0), _Fixed] = 3.092
    """Particles scatter by (angle of turn)^exponent: mostly back. The default was measured of
    Saturn's A ring (Dones, Cuzzi and Showalter 1993); 0 is even."""
    dust_share: _Share = 0.0
    """Part of the light that is scattered as by dust, after Henyey and Greenstein."""
    dust_g: Annotated[float, Field(strict=True, ge=-0.98, le=0.98), _Fixed] = 0.7
    """Mean cosine of the angle by which dust turns light; 1 is all forward."""

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
