"""Trajectories given from outside: a table of poses, a function."""

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
    """Poses from the rows of a CSV file, interpolated evenly in position and rotation."""

    kind: Literal["deterministic"]
    file: FileName
    """CSV with the columns frame,x,y,z,qw,qx,qy,qz, with or without this header. A header may
    reorder them, and have `t_s` (seconds after the epoch) instead of `frame` (a step). Rows are in
    ascending order. Relative to this file, or data:... under PERILUNE_DATA."""
    target: str | None = None
    """Body or spacecraft whose centre is the origin. Default: the origin of the root frame."""
    frame: Frame = "icrf"
    """Axes at the target: icrf, target (its own), lvlh or rsw (of its orbit)."""
    metres_per_unit: Positive = 1.0
    """Unit of the positions in the file, in metres."""
    offset_m: Vec3 = (0.0, 0.0, 0.0)
    """Offset that is added to the positions."""
    camera_axes: CameraAxes = "opencv"
    """Camera axes that the quaternions turn into the axes of `frame`: opencv (x right, y down, z
    forward) or opengl (Blender's: y up, z backward)."""
    first_frame: Integer = 0
    """Value of the column `frame` that step 0 uses; not with t_s."""
    after: Literal["repeat", "hold"] = "repeat"
    """After the last row: repeat starts again at the first row, one step later (with t_s at once,
    so the last row replaces the first); hold stays there. Applies likewise before the first row."""
    clearance_m: NonNegative | None = None
    """Least distance from surfaces, as for other kinds. null (default): only bodies are avoided."""

    @field_validator("file")
    @classmethod
    def _found(cls, value: str, info: ValidationInfo) -> str:
        """Path of the file, if the folder that paths are relative to is known."""
        find = (info.context or {}).get("path")
        return str(find(value, "camera.trajectory.file")) if find is not None else value

    @model_validator(mode="after")
    def _axes(self) -> Deterministic:
        if self.target is None and self.frame != "icrf":
            fail("frame", f"{self.frame}: only with a target")
        return self


class Hook(Strict):
    """Your function, called as function(world, **params) with a perilune.world.World."""

    model_config = ConfigDict(json_schema_extra=hook_or_function)

    kind: Literal["hook"]
    hook: FunctionName
    """module:function (the key `function` works too). It returns the camera's pose x, y, z, qw, qx,
    qy, qz in metres and the root frame (ICRF axes); the quaternion rotates the camera's axes (x
    right, y down, z forward) to the root's. Shape (7,): as the shutter opens. Shape (2, 7): as it
    opens and closes. perilune.look_at makes such poses. An argument `rng` receives a
    numpy.random.Generator of the step; the global generators of NumPy and Python are seeded for the
    step too."""
    target: str | None = None
    """Spacecraft or body that a camera with one pose (7,) moves along with while the shutter is
    open, without rotating. Default: the nearest. Not used with two poses."""
    params: dict[str, Any] = Field(default_factory=dict)
    """Parameters for the function."""

    @model_validator(mode="before")
    @classmethod
    def _older_name(cls, data: Any) -> Any:
        return cls._renamed(data, "function", "hook")
