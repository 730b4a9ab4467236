"""The section `parts` of a spacecraft: how its model is cut into parts."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from perilune.config.errors import fail
from perilune.config.types import Integer, StaticVec3, Strict


class PartBox(Strict):
    """A box along the model's axes. It holds the triangles whose centroids are inside."""

    min: StaticVec3
    """Lower corner, in the file's units with z up, as `perilune parts` lists them."""
    max: StaticVec3
    """Upper corner."""

    @model_validator(mode="after")
    def _ordered(self) -> PartBox:
        for axis, low, high in zip("xyz", self.min, self.max, strict=True):
            if not low < high:
                fail("max", f"{axis}: must be above min ({high:g} is not above {low:g})")
        return self


class Parts(Strict):
    """Division of a model into parts; `perilune parts CONFIG` lists the result."""

    split: Literal["primitive", "node", "component", "none"] = "primitive"
    """primitive: a part per primitive (material) of a node. node: a part per node. component: a
    part per connected piece of the mesh; `component-0` is the largest. none: the whole model is the
    part `model`."""
    merge_below: Annotated[Integer, Field(ge=0)] = 0
    """With split: component, pieces with fewer triangles than this together form the part
    `small`."""
    boxes: dict[str, PartBox] = Field(default_factory=dict)
    """Parts by position, taken before `split` divides the rest. A triangle belongs to the first box
    that holds it."""

    @model_validator(mode="after")
    def _merges_components(self) -> Parts:
        if self.merge_below and self.split != "component":
            fail("merge_below", f"only for split: component, not {self.split}")
        return self
