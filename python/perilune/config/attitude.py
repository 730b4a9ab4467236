"""The sections `attitude` and `rotation`: orientation of spacecraft and bodies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Tag, model_validator

from perilune.config.errors import fail
from perilune.config.types import Direction, FileName, Finite, PositiveVec3, Strict, Vec3


class Spin(Strict):
    """A rotation relative to the reference axes, and a constant spin from the epoch on."""

    rotation_deg: Vec3 = (0.0, 0.0, 0.0)
    """Roll, pitch, yaw about x, then y, then z of the reference axes."""
    spin_axis: Direction = (0.0, 0.0, 1.0)
    """Axis of the spin in the object's own axes; with rotation_mode: global, in the reference
    axes."""
    spin_rate_deg_s: Finite = 0.0
    """Rate of the spin about spin_axis."""
    rotation_deg_step_v: Finite | Vec3 | None = None
    """Spin per step, instead of a rate: degrees about spin_axis, or roll, pitch, yaw. Needs
    time.step_s."""
    rotation_mode: Literal["local", "global"] = "local"
    """Whether the spin axis is fixed in the object (local) or in the reference axes (global)."""

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
        """Whether the spin is given per step."""
        step = self.rotation_deg_step_v
        return step is not None and any(step if isinstance(step, tuple) else (step,))


class Inertial(Spin):
    """Relative to ICRF axes."""

    pointing: Literal["inertial"] = "inertial"


class Lvlh(Spin):
    """Relative to the local vertical, local horizontal axes of the orbit: z towards the central
    body, y along the negative orbit normal, x near the velocity. `nadir` is a synonym."""

    pointing: Literal["lvlh", "nadir"]


class SunPointing(Spin):
    """Relative to axes with x towards the Sun and z as close to the orbit normal as possible."""

    pointing: Literal["sun"]


class VelocityPointing(Spin):
    """Relative to axes with x along the velocity about the central body, y along the negative orbit
    normal, and z on the central body's side."""

    pointing: Literal["velocity"]


class TargetPointing(Spin):
    """Relative to axes with z towards a target and y as far from `up` as possible, as for a camera
    that looks at the target: x right, y down."""

    pointing: Literal["target"]
    target: str
    """Name of the body or spacecraft that it points at."""
    up: Direction | None = None
    """Up direction in ICRF axes. Default: the orbit normal."""


class GroundPointing(Spin):
    """Relative to the axes of what is on the ground: x forward, y to the left, z the normal of the
    ground under the footprint (orbits of the kinds surface and traverse) or along the thrust
    (powered_descent). Default for these kinds of orbits, and only for them."""

    pointing: Literal["ground"]


_Tensor = tuple[Vec3, Vec3, Vec3]


class Tumble(Strict):
    """Torque-free rotation of a rigid body."""

    pointing: Literal["tumble"]
    inertia_kg_m2: PositiveVec3 | _Tensor
    """Principal moments about the object's axes x, y, z, or the inertia tensor as rows. Only ratios
    matter."""
    rate_deg_s: Vec3
    """Angular velocity at the epoch, in the object's own axes."""
    rotation_deg: Vec3 = (0.0, 0.0, 0.0)
    """Roll, pitch, yaw at the epoch, relative to ICRF axes."""


class AttitudeTable(Spin):
    """Relative to tabulated axes, interpolated along the shortest rotation at a constant rate
    (slerp)."""

    pointing: Literal["table"]
    file: FileName
    """CSV with the columns t_s (seconds after the epoch) or time_utc, and qw, qx, qy, qz (from the
    object's axes to ICRF), as `perilune orbit` writes it. Relative to this file, or data:... under
    PERILUNE_DATA."""
    object: str | None = None
    """Object to take from a table with a column `object`."""


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
    | Annotated[AttitudeTable, Tag("table")]
    | Annotated[GroundPointing, Tag("ground")],
    Discriminator(_pointing),
]
"""Orientation of a spacecraft; `pointing` selects the reference axes. Default: inertial;
on the ground (orbits of the kinds surface, traverse, powered_descent): ground."""


def _rotation_tag(value: Any) -> str:
    return "body" if isinstance(value, str) else "spin"


BodyRotation = Annotated[
    Annotated[Literal["body"], Tag("body")] | Annotated[Spin, Tag("spin")],
    Discriminator(_rotation_tag),
]
"""`body`: the table's rotation; or a fixed rotation and a spin, relative to ICRF axes."""
