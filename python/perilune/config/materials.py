"""The sections `materials` and spacecraft.X.materials: graphs, and the triangles that they are on.

What the kinds of nodes are and take is in the core's table; perilune.materials checks against it.
"""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from pydantic import (
    ConfigDict,
    Field,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    field_validator,
    model_validator,
)

from perilune.config.errors import fail
from perilune.config.parts import PartBox
from perilune.config.types import Finite, Integer, StaticNonNegative, Strict, Vec3

_NODE = re.compile(r"[A-Za-z_][A-Za-z0-9_:-]*")
_PREFIXES = ("OAISYS_", "driver:")


def driver_name(node: str) -> str | None:
    """NAME of a node called `OAISYS_NAME` or `driver:NAME`."""
    return next((node.removeprefix(p) for p in _PREFIXES if node.startswith(p)), None)


def _kept(value: Any, check: ValidatorFunctionWrapHandler) -> Any:
    """The value as it is: a number stays one that a driver has drawn."""
    try:
        check(value)
    except ValidationError:
        fail("", f"must be a driver, a number or three numbers, not {value!r}")
    return value


class DriverSection(Strict):
    """Values of the nodes `OAISYS_NAME` or `driver:NAME` of graphs, by NAME.

    Such a node is of the type `value` or `color`; without an entry it keeps its own value. An entry
    that names no node, or whose nodes change nothing, is an error."""

    drivers: dict[str, Annotated[Finite | Vec3, WrapValidator(_kept)]] = Field(min_length=1)
    """NAME -> a driver of a number or a colour (linear RGB), or a fixed one."""
    jitter_strength: StaticNonNegative | tuple[StaticNonNegative, ...] | None = None
    """Factor on every variance; 0 gives exactly the ideal values (default: drivers.strength). A
    list: one a draw, the last for all draws after them."""
    step_interval: Annotated[Integer, Field(ge=1)] | None = None
    """Steps between draws (default: drivers.interval)."""


def _drivers_in_file(schema: dict[str, Any]) -> None:
    """Beside `file` a setting can stand alone: the drivers are in the file."""
    schema.pop("required", None)


def _nodes_in_file(schema: dict[str, Any]) -> None:
    """The graph stands here or in the file."""
    schema.pop("required", None)
    schema["anyOf"] = [{"required": ["nodes"]}, {"required": ["file"]}]


class MaterialDrivers(DriverSection):
    """Drivers that several spacecraft share, or draw independently."""

    model_config = ConfigDict(json_schema_extra=_drivers_in_file)

    per: Literal["material", "instance"] = "material"
    """material: one draw for all that has the node. instance: each spacecraft draws its own."""


class Material(Strict):
    """A material as a graph of nodes."""

    model_config = ConfigDict(json_schema_extra=_nodes_in_file)

    file: str | None = None
    """YAML or JSON file of the keys of this mapping; relative to this file, or data:... under
    PERILUNE_DATA. Paths of images in it are relative to it. Keys given beside it replace the
    file's: in `nodes` those of each node (one of another type is replaced as a whole), in `drivers`
    those of each driver likewise."""
    doc: str = ""
    """What it looks like, for readers."""
    nodes: dict[str, dict[str, Any]] = Field(min_length=1)
    """Name -> {type: a kind of node, its inputs and constants}. An input is a number, [x, y, z],
    the name of a node, or `node.output`; a number or a component may be a driver."""
    surface: str | None = None
    """The node that is the surface (default: the only one that is)."""
    drivers: MaterialDrivers | None = None
    """Values of the graph's nodes `OAISYS_NAME` or `driver:NAME`."""
    instances: dict[str, DriverSection] = Field(default_factory=dict)
    """Spacecraft -> values there, before those of `drivers`; what `per: instance` becomes."""

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
    required: bool = True
    """false: no error when no triangle fits."""
    mode: Literal["replace", "wrap"] = "replace"
    """replace: nothing of the model's material is left but its opacity. wrap: inputs of the surface
    that the graph does not give stay those of the model's material."""

    @model_validator(mode="after")
    def _some_pattern(self) -> MaterialUse:
        if all(row is None for row in (self.material, self.part, self.component, self.box)):
            fail("", "say where: material, part, component, box, or several that all must fit")
        return self
