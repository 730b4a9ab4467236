"""Sections of the trajectories that come from outside: a table of poses, a function."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import ConfigDict, Field, ValidationInfo, field_validator, model_validator

from perilune.config.errors import fail
from perilune.config.trajectory.common import CameraAxes, Frame, Pointing
from perilune.config.types import (
    FileName,
    FunctionName,
    Integer,
    NonNegative,
    Positive,
    Strict,
    Vec3,
    hook_or_function,
)


class Deterministic(Pointing):
    """Poses from a CSV file, one a row; between rows the camera moves and turns evenly."""

    kind: Literal["deterministic"]
    file: FileName
    """Columns frame,x,y,z,qw,qx,qy,qz, with or without this header line; with a header in any
    order, and maybe `t_s` (seconds after the epoch) instead of `frame` (a step). Rising from row to
    row. Relative to this file, or data:... under PERILUNE_DATA."""
    target: str | None = None
    """A body or spacecraft whose centre is the origin; default: the root frame's."""
    frame: Frame = "icrf"
    """Axes at the target: icrf, target (its own), lvlh or rsw (of its orbit)."""
    metres_per_unit: Positive = 1.0
    """Of the positions in the file."""
    offset_m: Vec3 = (0.0, 0.0, 0.0)
    """Added to the positions."""
    camera_axes: CameraAxes = "opencv"
    """What the quaternions turn into the axes of `frame`: opencv (x right, y down, z forward) or
    opengl (Blender's: y up, z backward)."""
    first_frame: Integer = 0
    """The `frame` of the file that step 0 takes; not for t_s."""
    after: Literal["repeat", "hold"] = "repeat"
    """After the last row: repeat begins again with the first row one step later (with t_s: at once,
    as the last row stands for the first); hold stays there. Before the first row: as there."""
    clearance_m: NonNegative | None = None
    """As elsewhere; by default (null) bodies alone are kept clear of."""

    @field_validator("file")
    @classmethod
    def _found(cls, value: str, info: ValidationInfo) -> str:
        """The file's place, where the configuration says what its paths are relative to."""
        find = (info.context or {}).get("path")
        return str(find(value, "camera.trajectory.file")) if find is not None else value

    @model_validator(mode="after")
    def _axes(self) -> Deterministic:
        if self.target is None and self.frame != "icrf":
            fail("frame", f"{self.frame}: only with a target")
        return self


class Hook(Strict):
    """A function of the user's, called as function(world, **params) with a perilune.world.World."""

    model_config = ConfigDict(json_schema_extra=hook_or_function)

    kind: Literal["hook"]
    hook: FunctionName
    """module:function (`function` is understood too). It returns the camera's pose x, y, z, qw, qx,
    qy, qz: metres in the root frame (ICRF axes), and the rotation from the camera's axes (x right,
    y down, z forward) to the root's; as (7,) at the opening of the shutter, or as (2, 7) at opening
    and closing. perilune.look_at makes them. If it has an argument `rng`, it gets a
    numpy.random.Generator of the step; NumPy's and Python's own generators are seeded for the step
    while it runs."""
    target: str | None = None
    """Name of a spacecraft or body. A camera of one pose (7,) keeps its place beside it while the
    shutter is open (default: what is nearest), without turning; two poses say all themselves."""
    params: dict[str, Any] = Field(default_factory=dict)
    """Handed to the function."""

    @model_validator(mode="before")
    @classmethod
    def _older_name(cls, data: Any) -> Any:
        return cls._renamed(data, "function", "hook")
