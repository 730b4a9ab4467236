"""The key `faces` of a spacecraft: which sides of its faces exist."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from perilune.config.errors import fail
from perilune.drivers import Drawn

Sides = Literal["double_sided", "as_stated", "single_sided"]
DEFAULT: Sides = "double_sided"


def _kind(value: object) -> str:
    if isinstance(value, Drawn):
        fail("", "takes no driver: it is fixed when the scene is built")
    return "by material" if isinstance(value, dict) else "all"


Faces = Annotated[
    Annotated[Sides, Tag("all")]
    | Annotated[dict[str, Sides], Field(min_length=1), Tag("by material")],
    Discriminator(_kind),
]
"""Sides for all materials; or shell pattern on a material's name (case-insensitive) -> sides."""
