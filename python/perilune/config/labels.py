"""The section `labels` of the schema: levels of `semantic`, classes of parts, fixed ids."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated

from pydantic import Field, model_validator

from perilune.config.errors import fail, nearest
from perilune.config.types import Integer, Strict

LEVELS = ("kind", "object", "part")
"""Levels that everything has."""
_SAID = {
    "kind": "follows from the section: a body or a spacecraft",
    "object": "the key `class` says it",
    "part": "the key `part_classes` says it",
}
Level = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_-]*$")]
Classes = dict[Level, Annotated[str, Field(min_length=1)]]
"""Level -> name of the class that a body or spacecraft has there."""


class Labels(Strict):
    """What the levels of `semantic` mean; id 0 is the background at every level."""

    levels: Annotated[tuple[Level, ...], Field(min_length=1)] = LEVELS
    """kind of thing (body, spacecraft), class of object, class of part; or levels of your own, at
    which `classes` of a body or spacecraft say what it is. One without is 0 there."""
    part_classes: dict[str, tuple[str, ...]] = Field(default_factory=dict)
    """Class of part -> shell patterns on part names, material names or `part/material`, in any
    case; first match wins. `perilune parts CONFIG` lists the names."""
    other_part: str = "other"
    """Class of the parts of a spacecraft that no pattern matches."""
    ids: dict[Level, dict[str, Annotated[Integer, Field(ge=1, le=65535)]]] = Field(
        default_factory=dict
    )
    """Fixed ids of class names per level; the others are numbered in the order of the file."""

    @model_validator(mode="after")
    def _unique(self) -> Labels:
        if len(set(self.levels)) != len(self.levels):
            fail("levels", "a level occurs twice")
        for level, names in self.ids.items():
            if level not in LEVELS and level not in self.levels:
                allowed = [*LEVELS, *self.levels]
                fail(f"ids.{level}", f"no level '{level}'{nearest(level, dict.fromkeys(allowed))}")
            if len(set(names.values())) != len(names):
                fail(f"ids.{level}", "two names have the same id")
        return self

    def check(self, stated: Iterable[tuple[str, Mapping[str, str]]]) -> None:
        """Inside a validator: refuses levels that nothing has, and classes at no level.

        stated: key path of each entry's `classes`, and these."""
        used: set[str] = set()
        for where, classes in stated:
            for level in classes:
                if level in LEVELS:
                    fail(f"{where}.{level}", _SAID[level])
                if level not in self.levels:
                    fail(f"{where}.{level}", f"none of labels.levels{nearest(level, self.levels)}")
            used.update(classes)
        for k, level in enumerate(self.levels):
            if level not in LEVELS and level not in used:
                text = f"no '{level}'{nearest(level, LEVELS)}; or say `classes: {{{level}: ...}}` "
                fail(f"labels.levels[{k}]", text + "of bodies or spacecraft")
