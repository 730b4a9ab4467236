"""The section `volumes` of the schema: dust, gas and glow within bounds.

To add a shape: its section here and its line in `Volume`; its file in csrc/geom and its line in the
table there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from perilune.config.errors import fail
from perilune.config.materials import DriverSection
from perilune.config.types import Fraction, Rgb, Strict, Vec3, triple

_Fractions = Annotated[tuple[Fraction, Fraction, Fraction], BeforeValidator(triple)]
# Limits of single precision along any path through any volume; far beyond use.
_Place = Annotated[float, Field(strict=True, ge=-1e15, le=1e15)]
_SIZE_MIN_M = 1e-9
_Size = Annotated[float, Field(strict=True, ge=_SIZE_MIN_M, le=1e15)]
_SizeOrNone = Annotated[float, Field(strict=True, ge=0.0, le=1e15)]
_Sizes = Annotated[tuple[_Size, _Size, _Size], BeforeValidator(triple)]


class BaseVolume(Strict):
    """A scattering and emitting medium within a shape that moves with a body or a spacecraft.

    Light is scattered once. Bodies and other volumes cast shadows into it; spacecraft do not.
    Labels and depth ignore it. Where volumes overlap, their densities add up."""

    parent: str
    """Body or spacecraft that it is fixed to."""
    position_m: tuple[_Place, _Place, _Place] = (0.0, 0.0, 0.0)
    """Position of the shape's origin, in the parent's axes."""
    rotation_deg: Vec3 = (0.0, 0.0, 0.0)
    """Roll, pitch, yaw of the shape about the parent's x, then y, then z axis."""
    extinction_per_m: Rgb = (0.0, 0.0, 0.0)
    """Extinction coefficient at a density of 1; a path of 1 / extinction transmits 37 %."""
    albedo: _Fractions = (1.0, 1.0, 1.0)
    """Single-scattering albedo: fraction of the extinction that is scattered."""
    g: Annotated[float, Field(strict=True, ge=-0.98, le=0.98)] = 0.0
    """Asymmetry parameter of the Henyey-Greenstein phase function, the mean cosine of the
    scattering angle: 0 is isotropic, 1 all forward, -1 all backward."""
    emission_w_m3_sr: Rgb = (0.0, 0.0, 0.0)
    """Radiance that a metre of path adds, at a density of 1."""
    material: str | None = None
    """Name of an entry of `materials`, evaluated as a medium: `alpha` is the density (0 to 1),
    `base_color` a factor on the albedo, and its emission is added, per metre. `coordinates` are
    metres in the shape's axes. Default: a density of 1."""
    material_drivers: DriverSection | None = None
    """Values for driver nodes of this graph that the material's own drivers do not set."""
    core_m: _SizeOrNone = 0.0
    """Shortest step along a ray, used near the shape's origin; steps grow with the distance from
    it, which suits media that thin out from there. 0: equal steps. For volumes with a material."""

    @model_validator(mode="after")
    def _something_of(self) -> BaseVolume:
        if self.material is None:
            self._only_with("a material", "core_m", "material_drivers")
        given = self.model_fields_set
        if "extinction_per_m" not in given:
            if self.material is None and "emission_w_m3_sr" not in given:
                text = "give extinction_per_m, emission_w_m3_sr or a material: it is of nothing"
                fail("extinction_per_m", text)
            self._only_with("extinction_per_m", "albedo", "g")
        return self


class BoxVolume(BaseVolume):
    """A box centred at the origin."""

    shape: Literal["box"]
    size_m: _Sizes
    """Side lengths along x, y, z."""

    @property
    def numbers_m(self) -> tuple[float, float, float]:
        """Its numbers in the core's order."""
        return self.size_m


class EllipsoidVolume(BaseVolume):
    """An ellipsoid centred at the origin."""

    shape: Literal["ellipsoid"]
    radii_m: _Sizes
    """Radius of a sphere, or semi-axes along x, y, z."""

    @property
    def numbers_m(self) -> tuple[float, float, float]:
        """Its numbers in the core's order."""
        return self.radii_m


class ConeVolume(BaseVolume):
    """A cone or truncated cone from the origin along z."""

    shape: Literal["cone"]
    start_radius_m: _SizeOrNone = 0.0
    """Radius at the origin."""
    end_radius_m: _SizeOrNone
    """Radius at the other end."""
    length_m: _Size

    @property
    def numbers_m(self) -> tuple[float, float, float]:
        """Its numbers in the core's order."""
        return (self.start_radius_m, self.end_radius_m, self.length_m)

    @model_validator(mode="after")
    def _some_radius(self) -> ConeVolume:
        if self.start_radius_m == self.end_radius_m == 0.0:
            fail("end_radius_m", "a cone needs a radius at one of its ends")
        for key in ("start_radius_m", "end_radius_m"):
            if 0.0 < getattr(self, key) < _SIZE_MIN_M:
                fail(key, f"must be 0, or at least {_SIZE_MIN_M:g}")
        return self


def _shape(value: Any) -> str | None:
    found = value.get("shape") if isinstance(value, Mapping) else getattr(value, "shape", None)
    return found if isinstance(found, str) else None


Volume = Annotated[
    Annotated[BoxVolume, Tag("box")]
    | Annotated[EllipsoidVolume, Tag("ellipsoid")]
    | Annotated[ConeVolume, Tag("cone")],
    Discriminator(_shape),
]
"""A volume; `shape` selects its form."""
