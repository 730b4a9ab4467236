"""The section `parts` of a spacecraft: how its model is cut into parts."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from perilune.config.errors import fail
from perilune.config.types import Integer, StaticVec3, Strict


class PartBox(Strict):
    """A box along the model's axes; a triangle belongs to it when its centroid is inside."""

    min: StaticVec3
    """The file's units, z up, as `perilune parts` lists them."""
    max: StaticVec3

    @model_validator(mode="after")
    def _ordered(self) -> PartBox:
        for axis, low, high in zip("xyz", self.min, self.max, strict=True):
            if not low < high:
                fail("max", f"{axis}: must be above min ({high:g} is not above {low:g})")
        return self


class Parts(Strict):
    """How a model is cut into parts; `perilune parts CONFIG` lists the result."""

    split: Literal["primitive", "node", "component", "none"] = "primitive"
    """primitive: one part a primitive (material) of a node. node: one a node. component: one a
    connected piece of the mesh, `component-0` the largest. none: the whole model, `model`."""
    merge_below: Annotated[Integer, Field(ge=0)] = 0
    """With split: component, pieces of fewer triangles together are the part `small`."""
    boxes: dict[str, PartBox] = Field(default_factory=dict)
    """Parts by place, before `split` cuts the rest; the first box that fits takes a triangle."""

    @model_validator(mode="after")
    def _merges_components(self) -> Parts:
        if self.merge_below and self.split != "component":
            fail("merge_below", f"only for split: component, not {self.split}")
        return self
