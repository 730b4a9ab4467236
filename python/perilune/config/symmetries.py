"""Symmetries of a model, as BOP takes them."""

from __future__ import annotations

from perilune.config.types import StaticVec3, Strict


class ContinuousSymmetry(Strict):
    """Full rotational symmetry about a line in the model's frame."""

    axis: StaticVec3
    """Direction of the line."""
    offset_m: StaticVec3 = (0.0, 0.0, 0.0)
    """A point on the line."""


class DiscreteSymmetry(Strict):
    """A rotation about a point that maps the model onto itself."""

    rotation_deg: StaticVec3
    """Roll, pitch, yaw of the rotation."""
    offset_m: StaticVec3 = (0.0, 0.0, 0.0)
    """A point on the axis of rotation, in the model's frame."""


class Symmetries(Strict):
    """Symmetries of a model in its frame, for BOP.

    They are never guessed. Each is checked: the rotated model must lie within a tenth of its
    diameter, or 15 mm, of itself, as BOP asks."""

    discrete_deg: tuple[StaticVec3, ...] = ()
    """Rotations (roll, pitch, yaw) about the frame's origin that map the model onto itself. List
    all of them, with those of `discrete`, except the identity."""
    discrete: tuple[DiscreteSymmetry, ...] = ()
    """Rotations about other points."""
    continuous: tuple[ContinuousSymmetry, ...] = ()
    """Rotational symmetries about lines."""
