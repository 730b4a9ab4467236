"""The sections `articulation` and `animation` of a spacecraft: parts of its model that move."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from perilune.config.errors import fail
from perilune.config.types import Finite, Integer, StaticVec3, Strict


class Joint(Strict):
    """A node of the model, with all that hangs on it, turned about an axis or moved along it.

    Axes are the model's, z up: an axis (x, y, z) of the glTF file is (x, -z, y) here. All joints
    are given in the rest pose and travel with the joints of the nodes above them; several on one
    node act from the last to the first."""

    node: str
    """Shell pattern on the names of the model's nodes (`perilune parts CONFIG --nodes`); one must
    match."""
    axis: StaticVec3
    """Direction of the axis; right-handed."""
    axes: Literal["node", "object"] = "node"
    """What axis, normal and pivot_m are given in. node: the node's own axes, from its origin,
    whatever its scale. object: the object's axes, from its origin, as object_coords has them."""
    pivot_m: StaticVec3 = (0.0, 0.0, 0.0)
    """A point of the axis in the rest pose, at the model's ideal size."""
    angle_deg: Finite | None = None
    """Angle from the rest pose; added to what rate_deg_s and towards give."""
    rate_deg_s: Finite | None = None
    """The angle grows from the epoch on."""
    towards: str | None = None
    """`sun`, or a body or spacecraft: turns until `normal` comes as near to its direction from the
    pivot as the axis allows. One on the axis leaves the angle at 0."""
    normal: StaticVec3 | None = None
    """With towards: what points there, in the rest pose (of solar cells, their outward normal)."""
    translation_m: Finite | None = None
    """Way along the axis, instead of a turn."""

    @model_validator(mode="after")
    def _one_motion(self) -> Joint:
        turns = [key for key in ("angle_deg", "rate_deg_s", "towards") if self._has(key)]
        if self._has("translation_m") == bool(turns):
            fail("", "give translation_m, or some of angle_deg, rate_deg_s and towards")
        if self._has("towards") and self._has("rate_deg_s"):
            fail("rate_deg_s", "not with towards")
        if self._has("towards") != self._has("normal"):
            fail("normal", "goes with towards: what points there")
        for key in ("axis", "normal"):
            if getattr(self, key) == (0.0, 0.0, 0.0):
                fail(key, "a direction must not be zero")
        return self

    def _has(self, key: str) -> bool:
        return getattr(self, key) is not None

    @property
    def kind(self) -> Literal["turn", "slide", "towards"]:
        """Which joint of the core it is."""
        if self.translation_m is not None:
            return "slide"
        return "turn" if self.towards is None else "towards"


class Animation(Strict):
    """The model's own glTF animations, played at the frame's time."""

    name: str | None = None
    """Shell pattern on their names (`perilune parts CONFIG --nodes`); all that match play."""
    index: Annotated[Integer, Field(ge=0)] | None = None
    """Or the number of one of them, from 0."""
    speed: Finite = 1.0
    """Seconds of animation a second."""
    start_s: Finite = 0.0
    """Seconds of animation that have run at the epoch."""
    loop: Literal["repeat", "clamp", "pingpong"] = "repeat"
    """What follows the end of each: the beginning; nothing, it stays; the way back."""

    @model_validator(mode="after")
    def _one_name(self) -> Animation:
        self._exactly_one("name", "index")
        return self
