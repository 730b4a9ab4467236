"""How bodies and spacecraft are turned: the sections `attitude` and `rotation` of the schema."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Tag, model_validator

from perilune.config.errors import fail
from perilune.config.types import Direction, FileName, Finite, PositiveVec3, Strict, Vec3


class Spin(Strict):
    """A rotation to the reference axes, and a constant spin from the epoch on."""

    rotation_deg: Vec3 = (0.0, 0.0, 0.0)
    """Roll, pitch, yaw: about x, then y, then z of the reference axes."""
    spin_axis: Direction = (0.0, 0.0, 1.0)
    """In the thing's own frame; in the reference axes with rotation_mode: global."""
    spin_rate_deg_s: Finite = 0.0
    """Turn about spin_axis in a second."""
    rotation_deg_step_v: Finite | Vec3 | None = None
    """Instead of a rate, the turn from one step to the next: degrees about spin_axis, or roll,
    pitch, yaw of one step. Needs time.step_s."""
    rotation_mode: Literal["local", "global"] = "local"
    """Whether the axis of the spin turns with the thing (local) or stands in the reference axes."""

    @model_validator(mode="after")
    def _one_spin(self) -> Spin:
        if self.rotation_deg_step_v is not None and "spin_rate_deg_s" in self.model_fields_set:
            fail("rotation_deg_step_v", "does not go with spin_rate_deg_s, the same in a second")
        if isinstance(self.rotation_deg_step_v, tuple) and "spin_axis" in self.model_fields_set:
            fail("spin_axis", "does not go with three angles in rotation_deg_step_v")
        if not {"spin_rate_deg_s", "rotation_deg_step_v"} & self.model_fields_set:
            spin = "spin_rate_deg_s or rotation_deg_step_v"
            self._only_with(spin, "spin_axis", "rotation_mode")
        return self

    @property
    def turns_by_step(self) -> bool:
        """Whether it is the step that says how fast it turns."""
        step = self.rotation_deg_step_v
        return step is not None and any(step if isinstance(step, tuple) else (step,))


class Inertial(Spin):
    """Relative to ICRF axes."""

    pointing: Literal["inertial"] = "inertial"


class Lvlh(Spin):
    """Relative to the local vertical and horizon of the orbit: z to the parent's centre, y along
    minus the orbit normal, x near the velocity. `nadir` is another word for it."""

    pointing: Literal["lvlh", "nadir"]


class SunPointing(Spin):
    """Relative to axes with x towards the Sun and z as near the orbit normal as can be."""

    pointing: Literal["sun"]


class VelocityPointing(Spin):
    """Relative to axes with x along the velocity about the parent, y along minus the orbit normal
    and z on the parent's side."""

    pointing: Literal["velocity"]


class TargetPointing(Spin):
    """Relative to axes with z towards another thing and y as far from `up` as can be (as a camera
    that looks at it sees them: x right, y down)."""

    pointing: Literal["target"]
    target: str
    """Name of a body or spacecraft."""
    up: Direction | None = None
    """ICRF axes; default: the orbit normal."""


_Tensor = tuple[Vec3, Vec3, Vec3]


class Tumble(Strict):
    """A free rigid body: no torque acts on it."""

    pointing: Literal["tumble"]
    inertia_kg_m2: PositiveVec3 | _Tensor
    """Moments about the thing's axes x, y, z, or its inertia tensor as rows; only ratios matter."""
    rate_deg_s: Vec3
    """Angular velocity at the epoch, in the thing's own axes."""
    rotation_deg: Vec3 = (0.0, 0.0, 0.0)
    """Roll, pitch, yaw at the epoch, from ICRF axes."""


class AttitudeTable(Spin):
    """Relative to tabulated axes: between two lines the rotation is the shortest, at constant rate.
    """

    pointing: Literal["table"]
    file: FileName
    """CSV with the columns t_s (seconds after the epoch) or time_utc, and qw, qx, qy, qz (the
    thing's axes to ICRF); relative to this file, or data:... under PERILUNE_DATA. What
    `perilune orbit` writes is such a table."""
    object: str | None = None
    """Which object's lines to take, in a table with a column `object`."""


def _pointing(value: Any) -> str:
    mapping = isinstance(value, Mapping)
    found = value.get("pointing") if mapping else getattr(value, "pointing", None)
    return "inertial" if found is None else "lvlh" if found == "nadir" else str(found)


Attitude = Annotated[
    Annotated[Inertial, Tag("inertial")]
    | Annotated[Lvlh, Tag("lvlh")]
    | Annotated[SunPointing, Tag("sun")]
    | Annotated[VelocityPointing, Tag("velocity")]
    | Annotated[TargetPointing, Tag("target")]
    | Annotated[Tumble, Tag("tumble")]
    | Annotated[AttitudeTable, Tag("table")],
    Discriminator(_pointing),
]
"""How a spacecraft is turned; `pointing` says against which axes (default: inertial)."""


def _rotation_tag(value: Any) -> str:
    return "body" if isinstance(value, str) else "spin"


BodyRotation = Annotated[
    Annotated[Literal["body"], Tag("body")] | Annotated[Spin, Tag("spin")],
    Discriminator(_rotation_tag),
]
"""`body`: the table's rotation; or a fixed one and a spin, relative to ICRF axes."""
