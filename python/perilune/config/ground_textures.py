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


_Fixed = BeforeValidator(refuse_drawn)
_Pixels = Annotated[int, Field(strict=True, ge=16, le=4096), _Fixed]


class Clods(Strict):
    """Fragments of soil and rock too small for `rocks`, angular or rounded, that lie on the ground.

    Their numbers follow a power law. The defaults are those of Surveyor I (Shoemaker and Morris
    1970)."""

    min_diameter_m: Annotated[Positive, _Fixed] = 0.008
    max_diameter_m: Annotated[Positive, _Fixed] = 0.06
    """At most an eighth of `size_m`. Leave larger ones to `rocks`."""
    density_per_m2: NonNegative = 39.0
    """Number of 1 cm or more on a square metre."""
    exponent: Positive = 2.11
    """Those of D or more are as D^-exponent."""
    pixels: _Pixels = 512
    """Along the sample: its finest detail is `size_m` over this."""


class Mottling(Strict):
    """Two kinds of ground, as dust and bedrock, in patches of up to a sixth of `size_m`."""

    contrast: Annotated[Finite, Field(gt=0.0, le=1.0)]
    """Difference of their albedos over the mean, which stays."""
    cover: Annotated[Finite, Field(gt=0.0, lt=1.0)] = 0.5
    """Fraction of the bright one."""
    border: Annotated[Positive, _Fixed] = 1.0
    """Width of what lies between them, in deviations of the fractal that parts them: 0.2 makes
    borders sharp, 4 clouds."""
    hurst: Annotated[Finite, Field(ge=0.0, le=1.0), _Fixed] = 0.5
    """Of that fractal: 1 makes borders smooth, 0 frays them."""
    pixels: _Pixels = 512
    """Along the sample: its finest detail is `size_m` over this."""


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
    clods: Clods | None = None
    """Heights that are made, in place of `displacement`."""
    mottling: Mottling | None = None
    """Factors on the albedo that are made, in place of `albedo`."""

    @model_validator(mode="after")
    def _some(self) -> GroundTexture:
        given = (self.displacement, self.roughness, self.albedo, self.clods, self.mottling)
        if all(image is None for image in given):
            fail("", "needs displacement, clods, roughness, albedo or mottling")
        if self.displacement is not None and self.clods is not None:
            fail("clods", "not beside displacement: give another texture")
        if self.albedo is not None and self.mottling is not None:
            fail("mottling", "not beside albedo: give another texture")
        if self.clods is not None:
            self._fits(self.clods)
        return self

    def _fits(self, clods: Clods) -> None:
        if clods.max_diameter_m > 0.125 * self.size_m:
            most = f"at most {0.125 * self.size_m:g}, an eighth of size_m"
            fail("clods.max_diameter_m", f"{clods.max_diameter_m:g} must be {most}")
        if clods.min_diameter_m >= clods.max_diameter_m:
            fail("clods.min_diameter_m", "must be below max_diameter_m")
