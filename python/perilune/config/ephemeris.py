"""The section `ephemeris` of the schema: source of the positions of planets and the Sun."""

from __future__ import annotations

from pydantic import ValidationInfo, field_validator

from perilune.config.bands import found
from perilune.config.types import FileName, Strict


class Ephemeris(Strict):
    """Source of the positions of the Sun and of bodies without an orbit."""

    kernels: tuple[FileName, ...] = ()
    """SPICE kernels (.bsp, such as DE440's de440s.bsp; extra `spice`); later ones take precedence.
    Relative to this file, or data:... under PERILUNE_DATA. Default: series that are accurate to 10
    km for the Moon and Earth, and to 0.0005 of the distance from the Sun for outer planets
    (docs/time_and_ephemerides.md)."""

    @field_validator("kernels")
    @classmethod
    def _found(cls, value: tuple[str, ...], info: ValidationInfo) -> tuple[str, ...]:
        return tuple(found(text, info) for text in value)
