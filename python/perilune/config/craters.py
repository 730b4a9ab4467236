"""The craters of a body's ground."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from perilune.config.errors import fail
from perilune.config.size_laws import (
    Density,
    Rows,
    Seed,
    Steepness,
    check_diameters,
    check_rows,
)
from perilune.config.types import NonNegative, Positive, Strict

CraterLaw = Literal[
    "neukum_1983",
    "neukum_2001",
    "trask",
    "hartmann_1984",
    "viper",
    "neukum_equilibrium",
    "power",
    "table",
]

_Age = Annotated[float, Field(strict=True, gt=0.0, le=4.5)]
_Power = Annotated[float, Field(strict=True, ge=-3.0, le=3.0)]
_Ellipticity = Annotated[float, Field(strict=True, ge=0.0, le=0.6)]
_Irregularity = Annotated[float, Field(strict=True, ge=0.0, le=3.0)]
_Terraces = Annotated[float, Field(strict=True, ge=0.0, le=1.0)]
_Posts = Annotated[float, Field(strict=True, ge=1.0, le=1000.0)]


class CraterRays(Strict):
    """Bright ejecta and rays of young craters: soil that space has not darkened yet. They change
    the albedo alone; its mean stays."""

    brightness: Annotated[float, Field(strict=True, gt=0.0, le=4.0)] = 0.6
    """By how much fresh ejecta are brighter than old ground: 0.6 is a factor of 1.6 on the
    albedo."""
    fade_ga: Annotated[float, Field(strict=True, gt=0.0, le=4.5)] = 1.0
    """Time in which those of craters of 3 km or more fade, in 10^9 years; in proportion to the
    diameter less for smaller ones."""
    reach: Annotated[float, Field(strict=True, ge=3.0, le=20.0)] = 8.0
    """Length of the longest rays, in radii of the crater."""


class Craters(Strict):
    """Craters below the resolution of elevation models, or everywhere without any.

    Their sizes follow a law, their ages the lunar chronology; impacts since have worn down the old
    ones (diffusion). A crater is the same from anywhere: it depends on its place, these keys and
    the seed."""

    law: CraterLaw = "neukum_equilibrium"
    """Cumulative size-frequency law: production (neukum_1983, neukum_2001), equilibrium (trask,
    hartmann_1984), the lesser of neukum_2001 and trask (neukum_equilibrium), the design
    specification of VIPER for the south polar plains (viper), a power law, or a table."""
    surface_age_ga: _Age = 3.5
    """Age of the surface, in 10^9 years: production grows with it, and no crater is older."""
    density: Density = 1.0
    """Factor on the number of craters; 0: none."""
    coefficient: NonNegative | None = None
    """Of the power law: craters of 1 m or more per m^2."""
    exponent: Steepness | None = None
    """Of the power law: exponent of the diameter, 0 or less."""
    table: Rows | None = None
    """Rows [diameter in m, craters of this diameter or more per m^2]; diameters rise. Power laws
    between the rows."""
    min_diameter_m: Positive | None = None
    """Smallest diameter. Default: 0.1 m, or that of the table's first row if it is larger. Frames
    only have craters of two cells of the mesh or more."""
    max_diameter_m: Positive | None = None
    """Largest diameter. Default: 300 km, 0.196 radii of the body, or that of the table's last row,
    whichever is least."""
    seed: Seed = 0
    """Number of the craters: another seed gives others of the same law."""
    diffusivity_m2_per_myr: NonNegative = 5.5
    """Topographic diffusivity that wears down craters of 1 km, in m^2 per 10^6 years (Fassett and
    Thomson 2014). 0: all are fresh."""
    diffusivity_exponent: _Power = 0.9
    """Exponent of the diameter in the diffusivity of other craters."""
    ellipticity: _Ellipticity = 0.0
    """Largest 1 - minor/major axis; drawn for each crater from 0 on."""
    irregularity: _Irregularity = 1.0
    """Irregularity of rims and floors; 1: as real ones, 0: perfectly round."""
    terraces: _Terraces = 1.0
    """Terraces on the walls of craters from 10 km on; 1: as real ones, 0: smooth walls."""
    rays: CraterRays | None = None
    """Bright ejecta and rays of young craters; none by default."""
    model_posts: _Posts = 6.0
    """Where an elevation model has so many posts along a crater's diameter or more, it shows its
    own craters of this size, and none is added. Those that reach beyond a model are drawn beside
    it."""

    @model_validator(mode="after")
    def _one_law(self) -> Craters:
        for law, keys in (("power", ("coefficient", "exponent")), ("table", ("table",))):
            if self.law != law:
                self._only_with(f"law: {law}", *keys)
                continue
            for key in keys:
                if getattr(self, key) is None:
                    fail(key, f"required by law: {law}")
        return self

    @model_validator(mode="after")
    def _rows(self) -> Craters:
        check_rows(self.table)
        return self

    @model_validator(mode="after")
    def _some_sizes(self) -> Craters:
        check_diameters(self.min_diameter_m, self.max_diameter_m)
        return self
