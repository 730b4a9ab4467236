"""The section `labels` of the schema: semantic levels, classes of parts, fixed ids."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field, WithJsonSchema, model_validator

from perilune.config.errors import fail, nearest
from perilune.config.names import problem_of
from perilune.config.types import (
    Integer,
    Positive,
    StaticFinite,
    StaticNonNegative,
    Strict,
    refuse_drawn,
)

LEVELS = ("kind", "object", "part")
"""Levels that every object has."""
GROUND = "ground"
"""A level that is asked for: what of the ground is seen."""
MATERIAL = "material"
"""A level that is asked for: materials of models."""
_BUILT_IN = (*LEVELS, GROUND, MATERIAL)
_SAID = {
    GROUND: "follows from what is seen: terrain, crater, rock, spacecraft",
    MATERIAL: "follows from the model's file: the name of each material",
    "kind": "follows from the section: a body or a spacecraft",
    "object": "the key `class` says it",
    "part": "the key `part_classes` says it",
}


def _named(name: str) -> str:
    """A level's name, which becomes a layer and a column."""
    wrong = problem_of(name)
    if wrong is not None:
        fail("", wrong)
    return name


Level = Annotated[
    str,
    AfterValidator(_named),
    # Schemas know no classes of letters in common: what is certainly none.
    WithJsonSchema({"type": "string", "pattern": r"^[^\s\d./\\:-][^\s./\\:]*$"}),
]
ClassName = Annotated[str, Field(min_length=1)]
ClassPatterns = dict[ClassName, tuple[str, ...]]
"""Class -> shell patterns on part names, material names or `part/material`; the first that
matches counts."""
EntryClasses = dict[Level, ClassName | ClassPatterns]
"""Level -> class of a spacecraft or body at that level, or classes of its parts by patterns."""


def _pair(value: object) -> object:
    """A number becomes the range of it alone."""
    return (value, value) if isinstance(value, (int, float)) else value


NumberRange = Annotated[
    tuple[StaticFinite, StaticFinite], BeforeValidator(_pair), BeforeValidator(refuse_drawn)
]
"""A number, or [least, greatest], both included."""


def _several(value: Any) -> Any:
    """A single number becomes a list of one."""
    return value if isinstance(value, (list, tuple, Mapping, str, type(None))) else (value,)


class Hazard(Strict):
    """What a lander cannot stand on, for the channel `hazard`: a plane is laid through its
    footprint about each point."""

    footprint_m: Annotated[Positive, BeforeValidator(refuse_drawn)] = 10.0
    """Diameter of the footprint, over the feet."""
    max_slope_deg: Annotated[
        float, Field(strict=True, ge=0.0, le=90.0), BeforeValidator(refuse_drawn)
    ] = 10.0
    """Greatest slope of the plane that is safe."""
    max_roughness_m: StaticNonNegative = 0.2
    """Greatest RMS height of the ground over the plane that is safe."""
    max_rock_height_m: StaticNonNegative = 0.3
    """Greatest height over the ground of any rock that touches the footprint."""


class GroundLabels(Strict):
    """The ground around a point, for the channels `slope_baseline`, `rms_height` and `hazard`:
    functions of the place, whatever the camera."""

    baseline_m: Annotated[
        tuple[Positive, ...],
        Field(min_length=1, max_length=8),
        BeforeValidator(_several),
        BeforeValidator(refuse_drawn),
    ] = (10.0,)
    """Diameter of the disc through which a plane is laid: a number, or up to 8 in a list, one for
    each layer of the channels."""
    points: Annotated[Integer, Field(ge=8, le=256)] = 32
    """Heights in the disc. Time grows with them; docs/labels.md has their errors."""
    hazard: Hazard = Hazard.of_defaults()
    """Limits of a lander."""


class CraterLabels(Strict):
    """Which craters the channel `crater_id` and the class `crater` show: all that meet these."""

    least_px: Annotated[float, Field(strict=True, ge=1.0, le=1e5)] = 10.0
    """Least diameter, as pixels at the distance of the crater's centre. Craters of less than four
    cells of the mesh are drawn too low, or not at all."""
    least_depth: Annotated[float, Field(strict=True, ge=0.0, le=1.0)] = 0.2
    """Least depth as it is now, over that of a fresh crater of the same size."""
    least_kept: Annotated[float, Field(strict=True, ge=0.0, le=1.0)] = 0.5
    """Least fraction of a crater's relief that younger ones left, at the point that is seen."""


class CoverageLabels(Strict):
    """The channels `coverage` and `coverage_instance`."""

    samples: Annotated[Integer, Field(ge=1, le=1024)] = 16
    """Rays over each pixel. Time grows with them; docs/labels.md has their errors."""
    layers: Annotated[Integer, Field(ge=1, le=16)] = 4
    """Layers of the channels: instances of a pixel, the largest first."""


class Labels(Strict):
    """Levels and classes of the semantic labels; id 0 is the background at every level."""

    levels: Annotated[tuple[Level, ...], Field(min_length=1, max_length=32)] = LEVELS
    """Levels of `semantic`, in order. kind: body or spacecraft; object: class of the object; part:
    class of the part, or area of a body; ground: terrain, crater, rock, spacecraft, or body for one
    without terrain; material: the material of a model's part, by its name in the file. At levels
    of your own, `classes` of a body or spacecraft gives its class, and `labels.classes` those of
    parts; without one it has id 0."""
    part_classes: ClassPatterns = Field(default_factory=dict)
    """Class of part -> shell patterns on part names, material names or `part/material`
    (case-insensitive); the first match counts. `perilune parts CONFIG` lists the names."""
    classes: dict[Level, ClassPatterns] = Field(default_factory=dict)
    """Level of your own -> class -> such patterns, for the parts of all spacecraft that say nothing
    themselves at that level. Parts that match no pattern have id 0 there."""
    other_part: str = "other"
    """Class of spacecraft parts that match no pattern."""
    ids: dict[Level, dict[str, Annotated[Integer, Field(ge=1, le=65535)]]] = Field(
        default_factory=dict
    )
    """Fixed ids of classes, per level; other classes are numbered in the order of the file."""

    ground: GroundLabels = GroundLabels.of_defaults()
    """Baselines of slope and roughness."""
    coverage: CoverageLabels = CoverageLabels.of_defaults()
    """Rays and layers of the coverage of pixels by instances."""
    craters: CraterLabels | None = CraterLabels.of_defaults()
    """Which craters of the ground are labelled. null: none, they are terrain."""

    @model_validator(mode="after")
    def _unique(self) -> Labels:
        if len(set(self.levels)) != len(self.levels):
            fail("levels", "a level occurs twice")
        for level, names in self.ids.items():
            if level not in LEVELS and level not in self.levels:
                allowed = [*_BUILT_IN, *self.levels]
                fail(f"ids.{level}", f"no level '{level}'{nearest(level, dict.fromkeys(allowed))}")
            if len(set(names.values())) != len(names):
                fail(f"ids.{level}", "two names have the same id")
        return self

    def check(self, stated: Mapping[str, Mapping[str, Any]]) -> None:
        """Inside a validator: refuses levels without any class, and classes at unknown levels.

        stated: key path of each entry's `classes`, with their value."""
        used: set[str] = set()
        for where, classes in (("labels.classes", self.classes), *stated.items()):
            for level, given in classes.items():
                if level in _BUILT_IN:
                    fail(f"{where}.{level}", _SAID[level])
                if level not in self.levels:
                    fail(f"{where}.{level}", f"none of labels.levels{nearest(level, self.levels)}")
                if given:
                    used.add(level)
        for k, level in enumerate(self.levels):
            if level not in _BUILT_IN and level not in used:
                text = (
                    f"no '{level}'{nearest(level, _BUILT_IN)}; or say `classes: {{{level}: ...}}` "
                )
                fail(
                    f"labels.levels[{k}]", text + "of bodies, of spacecraft, or of parts in labels"
                )
