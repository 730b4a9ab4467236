"""The section `camera.sensor.lens_flare` of the schema: ghosts of bright sources in the lens."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field, model_validator

from perilune.config.errors import fail
from perilune.config.types import Fraction, Strict, triple

_Angle = Annotated[float, Field(strict=True, ge=0.0, le=85.0)]
_Parts = Annotated[tuple[Fraction, Fraction, Fraction], BeforeValidator(triple)]


class Ghost(Strict):
    """A uniform disc of light, reflected between two surfaces of the lens."""

    scale: Annotated[float, Field(strict=True, ge=-2.0, le=2.0)]
    """Position of the disc's centre along the line from the optical axis to the source, as a
    multiple of the source's distance from the axis. Negative: on the other side of the axis."""
    radius_deg: Annotated[float, Field(strict=True, gt=0.0, le=85.0)]
    """Angular radius of the disc; at least half a pixel."""
    intensity: _Parts
    """Fraction of the source's light in the disc, for all bands or as [r, g, b]. Two coatings that
    reflect 0.5 % each: 2.5e-5."""


GENERIC = (
    Ghost.model_construct(scale=-1.0, radius_deg=0.6, intensity=(2.5e-5, 2.5e-5, 2.5e-5)),
    Ghost.model_construct(scale=-0.45, radius_deg=1.5, intensity=(2e-5, 3e-5, 2e-5)),
    Ghost.model_construct(scale=-1.6, radius_deg=3.0, intensity=(4e-5, 3e-5, 2e-5)),
    Ghost.model_construct(scale=0.3, radius_deg=0.9, intensity=(2e-5, 2.5e-5, 4e-5)),
    Ghost.model_construct(scale=0.6, radius_deg=2.2, intensity=(3e-5, 2.5e-5, 2e-5)),
    Ghost.model_construct(scale=1.4, radius_deg=4.5, intensity=(2.5e-5, 2.5e-5, 3e-5)),
)
"""A generic lens: six pairs of surfaces with broadband coatings that reflect about 0.5 % each (0.25
to 0.7 % in makers' data), a little more in one band than in another. Positions and sizes are spread
as in pictures taken with such lenses."""


class LensFlare(Strict):
    """Ghosts of the Sun, in the frame or near it, and of pixels that are brighter than white."""

    ghosts: Annotated[tuple[Ghost, ...], Field(min_length=1, max_length=32)] = GENERIC
    """Discs of light. Default: the six of a generic lens with coatings that reflect 0.5 %."""
    baffle_deg: tuple[_Angle, _Angle] = (30.0, 45.0)
    """Angles between the Sun and the optical axis: up to the first, the Sun shines into the lens;
    from the second on, the baffle blocks it; linear in between."""

    @model_validator(mode="after")
    def _rising(self) -> LensFlare:
        if self.baffle_deg[0] > self.baffle_deg[1]:
            fail("baffle_deg", "the second angle must not be smaller than the first")
        return self
