"""The section `ephemeris` of the schema: where planets and the Sun are from."""

from __future__ import annotations

from pydantic import ValidationInfo, field_validator

from perilune.config.bands import found
from perilune.config.types import FileName, Strict


class Ephemeris(Strict):
    """Of the bodies without an orbit, and of the Sun."""

    kernels: tuple[FileName, ...] = ()
    """SPICE kernels (.bsp, such as DE440's de440s.bsp; extra `spice`) that hold them, the later
    before the earlier; relative to this file, or data:... under PERILUNE_DATA. Without kernels:
    series that are within 10 km of the Moon and Earth, and off by up to 0.0005 of the distance from
    the Sun for outer planets (docs/time_and_ephemerides.md)."""

    @field_validator("kernels")
    @classmethod
    def _found(cls, value: tuple[str, ...], info: ValidationInfo) -> tuple[str, ...]:
        return tuple(found(text, info) for text in value)
