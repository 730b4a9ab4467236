"""The sections `materials` and spacecraft.X.materials: material graphs and their assignment.

The kinds of nodes and their inputs are in the core's table; perilune.materials checks against
it."""

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
from perilune.config.labels import ClassName, Level, NumberRange
from perilune.config.parts import PartBox
from perilune.config.types import Finite, Integer, StaticNonNegative, Strict, Vec3

_NODE = re.compile(r"[A-Za-z_][A-Za-z0-9_:-]*")
_PREFIXES = ("OAISYS_", "driver:")


def driver_name(node: str) -> str | None:
    """NAME of a node called `OAISYS_NAME` or `driver:NAME`."""
    for prefix in _PREFIXES:
        if node.startswith(prefix):
            return node.removeprefix(prefix)
    return None


def _kept(value: Any, check: ValidatorFunctionWrapHandler) -> Any:
    """The value unchanged, so that a number drawn by a driver stays one."""
    try:
        check(value)
    except ValidationError:
        fail("", f"must be a driver, a number or three numbers, not {value!r}")
    return value


class DriverSection(Strict):
    """Values for the nodes `OAISYS_NAME` or `driver:NAME` of graphs, by NAME.

    Such a node has the type `value` or `color` and keeps its own value without an entry. An entry
    that names no node, or changes nothing, is an error."""

    drivers: dict[str, Annotated[Finite | Vec3, WrapValidator(_kept)]] = Field(min_length=1)
    """NAME -> a driver of a number or a linear RGB colour, or a fixed value."""
    jitter_strength: StaticNonNegative | tuple[StaticNonNegative, ...] | None = None
    """Factor on every variance; 0 gives exactly the ideal values. A list: one factor per draw, the
    last for all later draws. Default: drivers.strength."""
    step_interval: Annotated[Integer, Field(ge=1)] | None = None
    """Steps between draws. Default: drivers.interval."""


def _drivers_in_file(schema: dict[str, Any]) -> None:
    """Lets settings stand alone beside `file`, which then has the drivers."""
    schema.pop("required", None)


def _nodes_in_file(schema: dict[str, Any]) -> None:
    """Checks that the graph is here or in the file."""
    schema.pop("required", None)
    schema["anyOf"] = [{"required": ["nodes"]}, {"required": ["file"]}]


class MaterialDrivers(DriverSection):
    """Drivers that several spacecraft share, or draw independently."""

    model_config = ConfigDict(json_schema_extra=_drivers_in_file)

    per: Literal["material", "instance"] = "material"
    """material: one draw for all users of the node. instance: a draw for each spacecraft."""


class GraphClasses(Strict):
    """Classes of points of a surface at one level of labels, by a value of its graph."""

    value: Annotated[str, Field(min_length=1)]
    """Name of a node, or `node.output`, whose value says the class of a point. Of a vector or
    colour the mean or luminance counts. No footprint is averaged over."""
    classes: Annotated[dict[ClassName, NumberRange], Field(min_length=1)]
    """Class -> its number, or [least, greatest], both included. The first that has the value
    counts; where none has it the id is 0."""

    @model_validator(mode="after")
    def _ranges(self) -> GraphClasses:
        for name, (low, high) in self.classes.items():
            if low > high:
                fail(f"classes.{name}", f"[{low:g}, {high:g}]: the least comes first")
        return self


class Material(Strict):
    """A material as a graph of nodes."""

    model_config = ConfigDict(json_schema_extra=_nodes_in_file)

    file: str | None = None
    """YAML or JSON file with the keys of this mapping; relative to this file, or data:... under
    PERILUNE_DATA. Image paths in it are relative to that file. Keys given here override the file's:
    node by node in `nodes` (a node of another type is replaced as a whole), driver by driver in
    `drivers`."""
    doc: str = ""
    """Description, for readers."""
    nodes: dict[str, dict[str, Any]] = Field(min_length=1)
    """Name -> {type: kind of node, its inputs and constants}. An input is a number, [x, y, z], the
    name of a node, or `node.output`. Numbers and components take drivers."""
    surface: str | None = None
    """Name of the output node. Default: the only node that is a surface."""
    labels: dict[Level, GraphClasses] = Field(default_factory=dict)
    """Level of labels.levels -> classes of points on surfaces with this material, in place of those
    that their part or area has there."""
    drivers: MaterialDrivers | None = None
    """Values for the graph's nodes `OAISYS_NAME` or `driver:NAME`."""
    instances: dict[str, DriverSection] = Field(default_factory=dict)
    """Spacecraft -> values for it, which take precedence over those of `drivers`. `per: instance`
    fills this in."""

    @field_validator("nodes")
    @classmethod
    def _names(cls, nodes: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
        for name in nodes:
            if not _NODE.fullmatch(name):
                fail(name, "a node's name is letters, digits, _, - and :, no digit first")
        return nodes


class MaterialUse(Strict):
    """Assignment of a graph to the triangles of a spacecraft that match all given conditions."""

    material: str | None = None
    """Shell pattern on the names of the model's materials (case-insensitive). Default: all."""
    part: str | None = None
    """Shell pattern on the names of parts (case-insensitive). Default: all."""
    component: str | None = None
    """Shell pattern on connected pieces of the mesh, named as by `parts: {split: component}` before
    merging; `component-0` is the largest. Default: all."""
    box: PartBox | None = None
    """Box that the triangles are in, as in `parts.boxes`. Default: everywhere."""
    use: str
    """Name of an entry of `materials`."""
    required: bool = True
    """Whether it is an error if no triangle matches."""
    mode: Literal["replace", "wrap"] = "replace"
    """replace: the graph replaces the model's material, except its opacity. wrap: inputs of the
    surface that the graph does not set come from the model's material."""

    @model_validator(mode="after")
    def _some_pattern(self) -> MaterialUse:
        if all(row is None for row in (self.material, self.part, self.component, self.box)):
            fail("", "say where: material, part, component, box, or several that all must fit")
        return self
