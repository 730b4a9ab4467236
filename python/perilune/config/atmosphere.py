"""The section `atmosphere` of a body."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from perilune.config.errors import fail
from perilune.config.types import NonNegative, Positive, Strict, refuse_drawn, triple

_Fixed = BeforeValidator(refuse_drawn)
_Bands = Annotated[tuple[NonNegative, NonNegative, NonNegative], BeforeValidator(triple), _Fixed]
_Height = Annotated[Positive, _Fixed]
_G = Annotated[float, Field(strict=True, ge=-0.98, le=0.98)]
_Share = Annotated[float, Field(strict=True, ge=0.0, le=1.0)]


_PARTS = {
    "rayleigh_per_km": (
        "rayleigh_height_km",
        "rayleigh_upper_from_km",
        "rayleigh_upper_height_km",
    ),
    "mie_scattering_per_km": (
        "mie_extinction_per_km",
        "mie_height_km",
        "mie_upper_from_km",
        "mie_upper_height_km",
        "mie_g",
    ),
    "ozone_per_km": ("ozone_center_km", "ozone_width_km"),
}
"""Constituent of an atmosphere -> the keys that describe it."""
_PRESET_HAS = {
    "earth": tuple(_PARTS),
    "mars": ("rayleigh_per_km", "mie_scattering_per_km"),
    "none": (),
}


class Atmosphere(Strict):
    """Gas, haze and an ozone layer, whose densities depend on height alone.

    Keys that are not given have the preset's values. Numbers are for all bands, or [r, g, b].
    Heights are above the surface; on an oblate body they scale with the local radius, larger at the
    equator and smaller at the poles."""

    preset: Literal["earth", "mars", "none"] = "none"
    """Atmosphere that the keys below modify. none: only what they give."""
    rayleigh_per_km: _Bands | None = None
    """Rayleigh scattering coefficient of the gas at the surface."""
    rayleigh_height_km: _Height | None = None
    """Scale height of the gas: its density falls by a factor e over it."""
    rayleigh_upper_from_km: _Height | None = None
    """Height above which the gas has rayleigh_upper_height_km, as above a tropopause. Default: the
    preset's, or none if rayleigh_height_km is given."""
    rayleigh_upper_height_km: _Height | None = None
    """Scale height of the gas there; required with rayleigh_upper_from_km."""
    mie_scattering_per_km: _Bands | None = None
    """Scattering coefficient of haze or dust at the surface."""
    mie_extinction_per_km: _Bands | None = None
    """Extinction coefficient (scattering and absorption) of haze or dust at the surface. Default:
    the scattering divided by the preset's single-scattering albedo."""
    mie_height_km: _Height | None = None
    """Scale height of the haze."""
    mie_upper_from_km: _Height | None = None
    """Height above which the haze has mie_upper_height_km. Default: the preset's, or none if
    mie_height_km is given."""
    mie_upper_height_km: _Height | None = None
    """Scale height of the haze there; required with mie_upper_from_km."""
    mie_g: Annotated[tuple[_G, _G, _G], BeforeValidator(triple), _Fixed] | None = None
    """Parameter g of the Cornette-Shanks phase function: 0 is nearly isotropic, 1 all forward. The
    mean cosine of the scattering angle is 3 g (4 + g^2) / (5 (2 + g^2))."""
    ozone_per_km: _Bands | None = None
    """Absorption coefficient in the middle of the ozone layer."""
    ozone_center_km: _Height | None = None
    """Height of the middle of the ozone layer."""
    ozone_width_km: _Height | None = None
    """Distance above and below the middle over which the ozone falls to zero."""
    top_km: _Height | None = None
    """Top of the atmosphere. Ten scale heights or more hide the edge."""
    ground_albedo: (
        Annotated[tuple[_Share, _Share, _Share], BeforeValidator(triple), _Fixed] | None
    ) = None
    """Albedo of the surface in the light that it reflects into the air, with
    multiple_scattering."""
    multiple_scattering: Annotated[bool, Field(strict=True)] = True
    """Whether light that is scattered more than once counts, approximated as isotropic from the
    second time on; docs/air.md gives the error."""

    @model_validator(mode="after")
    def _something(self) -> Atmosphere:
        there = [key for key in _PARTS if key in _PRESET_HAS[self.preset] or getattr(self, key)]
        for key, details in _PARTS.items():
            if key not in there:
                self._only_with(f"{key}: preset {self.preset} has none", *details)
        if not there:
            fail("preset", f"none: there is no air without one of {', '.join(_PARTS)}")
        if not self.multiple_scattering:
            self._only_with("multiple_scattering", "ground_albedo")
        return self

    @model_validator(mode="after")
    def _layers(self) -> Atmosphere:
        for part in ("rayleigh", "mie"):
            keys = (f"{part}_upper_from_km", f"{part}_upper_height_km")
            given = [key for key in keys if getattr(self, key) is not None]
            if len(given) == 1:
                missing = next(key for key in keys if key not in given)
                fail(given[0], f"needs {missing}: the upper layer is said by both")
        return self

    @model_validator(mode="after")
    def _haze(self) -> Atmosphere:
        scattering, extinction = self.mie_scattering_per_km, self.mie_extinction_per_km
        if scattering is not None and extinction is not None:
            for band, (part, whole) in enumerate(zip(scattering, extinction, strict=True)):
                if part > whole:
                    fail(
                        "mie_extinction_per_km",
                        f"band {band + 1} is {whole:g}, less than the scattering, {part:g}",
                    )
        return self
