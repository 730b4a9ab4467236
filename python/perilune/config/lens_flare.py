"""The section `camera.sensor.lens_flare` of the schema: ghosts of bright sources in the lens."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field, model_validator

from perilune.config.errors import fail
from perilune.config.types import Fraction, Strict, triple

_Angle = Annotated[float, Field(strict=True, ge=0.0, le=85.0)]
_Parts = Annotated[tuple[Fraction, Fraction, Fraction], BeforeValidator(triple)]


class Ghost(Strict):
    """An even disc of light that two surfaces of the lens reflect."""

    scale: Annotated[float, Field(strict=True, ge=-2.0, le=2.0)]
    """Its middle is at so many times the source's distance from the optical axis; below 0: on the
    other side."""
    radius_deg: Annotated[float, Field(strict=True, gt=0.0, le=85.0)]
    """Of the disc, seen through the lens; at least half a pixel."""
    intensity: _Parts
    """Part of the source's light that lands in the disc, in all bands or [r, g, b]. Two surfaces
    whose coatings reflect 0.5 %: 2.5e-5."""


GENERIC = (
    Ghost(scale=-1.0, radius_deg=0.6, intensity=(2.5e-5, 2.5e-5, 2.5e-5)),
    Ghost(scale=-0.45, radius_deg=1.5, intensity=(2e-5, 3e-5, 2e-5)),
    Ghost(scale=-1.6, radius_deg=3.0, intensity=(4e-5, 3e-5, 2e-5)),
    Ghost(scale=0.3, radius_deg=0.9, intensity=(2e-5, 2.5e-5, 4e-5)),
    Ghost(scale=0.6, radius_deg=2.2, intensity=(3e-5, 2.5e-5, 2e-5)),
    Ghost(scale=1.4, radius_deg=4.5, intensity=(2.5e-5, 2.5e-5, 3e-5)),
)
"""Of no lens in particular: six pairs of surfaces, each with coatings that reflect about 0.5 %, as
broadband ones do (0.25 to 0.7 % by makers' data), a little more in one band than in another; places
and sizes are spread as in pictures of such lenses."""


class LensFlare(Strict):
    """Ghosts of the sun, in the frame or near it, and of what is brighter than white."""

    ghosts: Annotated[tuple[Ghost, ...], Field(min_length=1, max_length=32)] = GENERIC
    """Default: six of a generic lens with coatings that reflect 0.5 %."""
    baffle_deg: tuple[_Angle, _Angle] = (30.0, 45.0)
    """Angles to the optical axis up to which the sun shines into the lens, and from which on the
    baffle keeps it out; linear between."""

    @model_validator(mode="after")
    def _rising(self) -> LensFlare:
        if self.baffle_deg[0] > self.baffle_deg[1]:
            fail("baffle_deg", "the second angle must not be smaller than the first")
        return self
