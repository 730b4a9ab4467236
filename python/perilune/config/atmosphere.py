"""The atmosphere of a body."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from perilune.config.errors import fail
from perilune.config.types import NonNegative, Positive, Strict, refuse_drawn, triple

_Fixed = BeforeValidator(refuse_drawn)
_Bands = Annotated[
    tuple[NonNegative, NonNegative, NonNegative], BeforeValidator(triple), _Fixed
]
_Height = Annotated[Positive, _Fixed]
_G = Annotated[float, Field(strict=True, ge=-0.98, le=0.98)]
_Share = Annotated[float, Field(strict=True, ge=0.0, le=1.0)]


_PARTS = {
    "rayleigh_per_km": (
        "rayleigh_height_km", "rayleigh_upper_from_km", "rayleigh_upper_height_km",
    ),
    "mie_scattering_per_km": (
        "mie_extinction_per_km", "mie_height_km", "mie_upper_from_km", "mie_upper_height_km",
        "mie_g",
    ),
    "ozone_per_km": ("ozone_center_km", "ozone_width_km"),
}
"""What there may be -> the keys that say how it is."""
_PRESET_HAS = {
    "earth": tuple(_PARTS),
    "mars": ("rayleigh_per_km", "mie_scattering_per_km"),
    "none": (),
}


class Atmosphere(Strict):
    """Gas, haze and an ozone layer, whose density depends on the height alone.

    A key that is not given is the preset's. Numbers are for all bands, or [r, g, b]. Heights are
    above the surface; on an oblate body they are longer at the equator and shorter at the poles, by
    as much as the radius is.
    """

    preset: Literal["earth", "mars", "none"] = "none"
    """none: nothing but what the keys below give."""
    rayleigh_per_km: _Bands | None = None
    """Scattering by gas at the surface."""
    rayleigh_height_km: _Height | None = None
    """Scale height: over it the gas thins out by e."""
    rayleigh_upper_from_km: _Height | None = None
    """Above it the gas has the next scale height, as above a tropopause. Default: the preset's, but
    none where rayleigh_height_km is given."""
    rayleigh_upper_height_km: _Height | None = None
    """Scale height there; given together with rayleigh_upper_from_km."""
    mie_scattering_per_km: _Bands | None = None
    """Scattering by haze or dust at the surface."""
    mie_extinction_per_km: _Bands | None = None
    """Scattering and absorption; the default is the scattering over the preset's share of it."""
    mie_height_km: _Height | None = None
    """Scale height of the haze."""
    mie_upper_from_km: _Height | None = None
    """Above it the haze has the next scale height. Default: the preset's, but none where
    mie_height_km is given."""
    mie_upper_height_km: _Height | None = None
    """Scale height there; given together with mie_upper_from_km."""
    mie_g: Annotated[tuple[_G, _G, _G], BeforeValidator(triple), _Fixed] | None = None
    """Parameter of Cornette and Shanks's law: 0 is nearly even, 1 all forward. The mean cosine of
    the angle of scattering is 3 g (4 + g^2) / (5 (2 + g^2))."""
    ozone_per_km: _Bands | None = None
    """Absorption in the middle of the ozone layer."""
    ozone_center_km: _Height | None = None
    """Height of the middle of the ozone layer."""
    ozone_width_km: _Height | None = None
    """The ozone thins out to nothing over it, above and below."""
    top_km: _Height | None = None
    """Beyond it there is no air; at least ten scale heights hide the edge."""
    ground_albedo: (
        Annotated[tuple[_Share, _Share, _Share], BeforeValidator(triple), _Fixed] | None
    ) = None
    """Of the surface where it lights the air, with multiple_scattering."""
    multiple_scattering: Annotated[bool, Field(strict=True)] = True
    """Light that is scattered more than once counts, from the second time on as if evenly to all
    sides: docs/air.md has how far off that is."""

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
