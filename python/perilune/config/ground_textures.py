"""Textures of the ground: images of a small sample of it."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field, model_validator

from perilune.config.errors import fail
from perilune.config.types import FileName, Finite, NonNegative, Positive, Strict, refuse_drawn

_Seed = Annotated[int, Field(strict=True, ge=0, lt=2**64)]


class HeightImage(Strict):
    """An image of heights."""

    file: FileName
    """PNG of grey levels, or NumPy array."""
    low_m: Annotated[Finite, BeforeValidator(refuse_drawn)] = 0.0
    """Height of black, or of 0 in an array of floats."""
    high_m: Annotated[Finite, BeforeValidator(refuse_drawn)]
    """Height of white, or of 1 in an array of floats."""


class FactorImage(Strict):
    """An image of factors."""

    file: FileName
    """PNG of grey levels, or NumPy array."""
    low: Annotated[NonNegative, BeforeValidator(refuse_drawn)] = 0.0
    """Factor of black, or of 0 in an array of floats."""
    high: Annotated[NonNegative, BeforeValidator(refuse_drawn)] = 1.0
    """Factor of white, or of 1 in an array of floats."""


class GroundTexture(Strict):
    """Images of one sample of ground, of the same shape, laid all over the body: in patches of a
    quarter of the image that are turned and shifted at random, without a visible repeat."""

    size_m: Annotated[Positive, BeforeValidator(refuse_drawn)]
    """Width of the images on the ground."""
    seed: _Seed = 0
    """Number of the patches: another seed gives others of the same images."""
    displacement: HeightImage | None = None
    """Heights, of which the mean is taken away: relief in the mesh down to its cells, slopes down
    to the pixel, and below it the variance of slopes in the reflectance."""
    roughness: FactorImage | None = None
    """Factors on Hapke's roughness; only for reflectance with a roughness."""
    albedo: FactorImage | None = None
    """Factors on the albedo."""

    @model_validator(mode="after")
    def _some(self) -> GroundTexture:
        if self.displacement is None and self.roughness is None and self.albedo is None:
            fail("", "needs displacement, roughness or albedo")
        return self
