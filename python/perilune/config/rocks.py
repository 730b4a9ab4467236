"""The rocks on a body's ground."""

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
from perilune.config.types import FileName, NonNegative, Positive, Strict

RockLaw = Literal[
    "golombek",
    "change_3",
    "surveyor_1",
    "viper",
    "intercrater",
    "haworth",
    "power",
    "table",
]

_Abundance = Annotated[float, Field(strict=True, gt=0.0, le=1.0)]
_Burial = Annotated[float, Field(strict=True, ge=0.05, le=0.9)]
_Fillet = Annotated[float, Field(strict=True, ge=0.0, le=0.3)]
_Slope = Annotated[float, Field(strict=True, gt=0.0, lt=90.0)]
FITTED_ABUNDANCE = 0.02
"""Least abundance for which Golombek and Rapp (1997) give the decay."""


class RockFamilies(Strict):
    """Weights of the families of shapes; those without a weight have none."""

    block: NonNegative = 0.0
    """Angular, with flat faces."""
    cube: NonNegative = 0.0
    """Six faces at about right angles."""
    wedge: NonNegative = 0.0
    """Few large faces at sharp angles."""
    slab: NonNegative = 0.0
    """Flat, with a broken outline."""
    tablet: NonNegative = 0.0
    """Flat and rounded."""
    shard: NonNegative = 0.0
    """Long and sharp."""
    split: NonNegative = 0.0
    """Rounded, with a few fresh faces."""
    cobble: NonNegative = 0.0
    """Rounded by long exposure."""
    boulder: NonNegative = 0.0
    """Blocky, with worn edges."""
    egg: NonNegative = 0.0
    """Nearly an ellipsoid."""
    breccia: NonNegative = 0.0
    """Knobbly, of fragments of many sizes."""
    pitted: NonNegative = 0.0
    """Worn and rough."""
    model: NonNegative = 0.0
    """One of `models`."""

    @model_validator(mode="after")
    def _some(self) -> RockFamilies:
        if not sum(self.model_dump().values()) > 0.0:
            fail("", "one of the weights must be above 0")
        return self


class RockEjecta(Strict):
    """More rocks about young craters: blocks that impacts dug out and that later ones have not
    ground down yet. Needs terrain.craters."""

    at_rim: Annotated[float, Field(strict=True, gt=0.0, le=1000.0)] = 20.0
    """Density at the rim of a new crater, over that of the law; it is added to it. It falls as
    exp(-1/0.7) per radius outwards, to 5 radii; inside there is a twentieth of it."""
    life_ga: Annotated[float, Field(strict=True, gt=0.0, le=4.5)] = 0.3
    """Age of a crater at which it has none left, in 10^9 years. The density falls as the third
    power of what is left of it: by half in a fifth of it. Small craters that are worn down sooner
    have none from a degradation tau of 0.02 on."""
    least_crater_m: Positive = 25.0
    """Diameter of the smallest craters with blocks: smaller ones lie in the soil alone."""


class Rocks(Strict):
    """Rocks that lie on the ground.

    Their sizes follow a law; each has a shape of its own, is partly buried, and rests on the ground
    whatever its slope. A rock is the same from anywhere: it depends on its place, these keys and
    the seed. Frames have the rocks of two cells of the mesh or more. Their surface is that of the
    body."""

    law: RockLaw = "viper"
    """Cumulative size-frequency law: that of Golombek and Rapp (golombek) or its fit to the site of
    Chang'E-3 (change_3), power laws of the site of Surveyor 1 (surveyor_1), of the design
    specification of VIPER (viper), with fewer (intercrater) or more rocks (haworth), one's own
    power law, or a table."""
    density: Density = 1.0
    """Factor on the number of rocks; 0: none."""
    abundance: _Abundance | None = None
    """Of golombek: fraction of the ground that is covered by rocks."""
    decay_per_m: Positive | None = None
    """Of golombek: the fraction of rocks of D or more falls as exp(-decay_per_m D). Default: their
    fit, 1.79 + 0.152 / abundance, for an abundance of 0.02 or more; below, it must be given."""
    coefficient: NonNegative | None = None
    """Of the power law: rocks of 1 m or more per m^2."""
    exponent: Steepness | None = None
    """Of the power law: exponent of the diameter, 0 or less."""
    table: Rows | None = None
    """Rows [diameter in m, rocks of this diameter or more per m^2]; diameters rise. Power laws
    between the rows."""
    cutoff_m: NonNegative = 3.0
    """Densities are multiplied by exp(-D / cutoff_m): old plains have few large rocks. 0: they are
    not."""
    min_diameter_m: Positive | None = None
    """Smallest diameter, seen from above. Default: 0.05 m, or that of the table's first row if it
    is larger."""
    max_diameter_m: Positive | None = None
    """Largest diameter. Default: 20 m, 0.196 radii of the body, or that of the table's last row,
    whichever is least."""
    seed: Seed = 0
    """Number of the rocks: another seed gives others of the same law."""
    least_burial: _Burial = 0.1
    """Least part of a rock's height that is below the ground; drawn for each, up to most_burial.
    Rocks of fresh craters have 0.05 to 0.2, old ones 0.3 to 0.7. On rough ground rocks are sunk
    further, so that there is no air under them."""
    most_burial: _Burial = 0.5
    """Greatest part of a rock's height that is below the ground."""
    repose_deg: _Slope = 35.0
    """There are no rocks on steeper slopes, and fewer from 0.7 of it on."""
    fillet: _Fillet = 0.0
    """Soil that is heaped at their feet: its mean height over that of the rock; 0: none. Each rock
    has 0.5 to 1.5 times as much, up to 1.4 of it on one side and down to 0.6 on the other. It falls
    from a slope of 32 degrees to nothing, over 3.2 times its height, and is a part of the ground:
    of its heights and labels. Fillets narrower than 1 to 2 cells of the mesh fade."""
    ejecta: RockEjecta | None = None
    """More rocks about young craters; none by default."""
    models: Annotated[tuple[FileName, ...], Field(max_length=32)] = ()
    """Models of rocks (glTF): closed meshes of any size and axes, such as scans of samples. A rock
    of the family `model` has the shape of one of them, stretched by some 15 %, and the surface of
    the body, not the model's textures. Overhangs are filled, and what is narrower than 1.4 degrees
    from the centre is smoothed."""
    families: RockFamilies | None = None
    """Weights of the families of shapes. Default: `models` alone if there are any, otherwise drawn
    shapes, angular ones more often than round ones."""

    @model_validator(mode="after")
    def _one_law(self) -> Rocks:
        owned = {
            "golombek": ("abundance", "decay_per_m"),
            "power": ("coefficient", "exponent"),
            "table": ("table",),
        }
        for law, keys in owned.items():
            if self.law != law:
                self._only_with(f"law: {law}", *keys)
                continue
            for key in keys:
                if getattr(self, key) is None and key != "decay_per_m":
                    fail(key, f"required by law: {law}")
        little = self.abundance is not None and self.abundance < FITTED_ABUNDANCE
        if little and self.decay_per_m is None:
            fail("decay_per_m", f"required by an abundance below {FITTED_ABUNDANCE:g}")
        return self

    @model_validator(mode="after")
    def _models(self) -> Rocks:
        if self.families is not None and bool(self.models) != (self.families.model > 0.0):
            if self.models:
                fail("models", "have no weight: give families.model, or leave `families` out")
            fail("families.model", "needs models")
        return self

    @model_validator(mode="after")
    def _rows(self) -> Rocks:
        check_rows(self.table)
        return self

    @model_validator(mode="after")
    def _ranges(self) -> Rocks:
        check_diameters(self.min_diameter_m, self.max_diameter_m)
        if self.least_burial > self.most_burial:
            fail("least_burial", f"must not be above most_burial, {self.most_burial:g}")
        return self
