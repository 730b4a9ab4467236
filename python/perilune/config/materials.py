"""The sections `materials` and spacecraft.X.materials: graphs, and the triangles that they are on.

What the kinds of nodes are and take is in the core's table; perilune.materials checks against it.
"""

from __future__ import annotations

import re
from typing import Any, Literal

from pydantic import Field, field_validator, model_validator

from perilune.config.errors import fail
from perilune.config.parts import PartBox
from perilune.config.types import Strict

_NODE = re.compile(r"[A-Za-z_][A-Za-z0-9_:-]*")


class Material(Strict):
    """A material as a graph of nodes."""

    file: str | None = None
    """YAML or JSON file of the keys of this mapping; relative to this file, or data:... under
    PERILUNE_DATA. Keys given beside it replace the file's: in `nodes` those of each node (one of
    another type is replaced as a whole), in `drivers` those of each driver likewise."""
    doc: str = ""
    """What it looks like, for readers."""
    nodes: dict[str, dict[str, Any]] = Field(min_length=1)
    """Name -> {type: a kind of node, its inputs and constants}. An input is a number, [x, y, z],
    the name of a node, or `node.output`; a number or a component may be a driver."""
    surface: str | None = None
    """The node that is the surface (default: the only one that is)."""

    @field_validator("nodes")
    @classmethod
    def _names(cls, nodes: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
        for name in nodes:
            if not _NODE.fullmatch(name):
                fail(name, "a node's name is letters, digits, _, - and :, no digit first")
        return nodes


class MaterialUse(Strict):
    """Which triangles of a spacecraft a graph is on: those that fit all that is given."""

    material: str | None = None
    """Shell pattern on the names of the model's materials, in any case (default: all)."""
    part: str | None = None
    """Shell pattern on the names of parts, in any case (default: all)."""
    component: str | None = None
    """Shell pattern on the connected pieces of the mesh, `component-0` the largest, as those of
    `parts: {split: component}` before any are merged (default: all)."""
    box: PartBox | None = None
    """Triangles by place, as `parts.boxes` (default: everywhere)."""
    use: str
    """Name of an entry of `materials`."""
    mode: Literal["replace", "wrap"] = "replace"
    """replace: nothing of the model's material is left but its opacity. wrap: inputs of the surface
    that the graph does not give stay those of the model's material."""

    @model_validator(mode="after")
    def _some_pattern(self) -> MaterialUse:
        if all(row is None for row in (self.material, self.part, self.component, self.box)):
            fail("", "say where: material, part, component, box, or several that all must fit")
        return self
