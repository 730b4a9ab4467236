"""The sections `articulation` and `animation` of a spacecraft: moving parts of its model."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from perilune.config.errors import fail
from perilune.config.types import Finite, Integer, StaticVec3, Strict


class Joint(Strict):
    """A joint: turns a node of the model, with all nodes below it, about an axis, or moves it along
    the axis.

    Axes are the model's, z up: an axis (x, y, z) of the glTF file is (x, -z, y) here. Joints are
    given in the rest pose and move with the joints of the nodes above them. Several joints of one
    node act from the last to the first."""

    node: str
    """Shell pattern on the names of the model's nodes (`perilune parts CONFIG --nodes`), which must
    match one node."""
    axis: StaticVec3
    """Direction of the axis; rotations are right-handed."""
    axes: Literal["node", "object"] = "node"
    """Axes of axis, normal and pivot_m. node: the node's own axes and origin, without its scale.
    object: the object's axes and origin, as in object_coords."""
    pivot_m: StaticVec3 = (0.0, 0.0, 0.0)
    """A point on the axis in the rest pose, at the model's ideal size."""
    angle_deg: Finite | None = None
    """Angle from the rest pose; added to the angles of rate_deg_s and towards."""
    rate_deg_s: Finite | None = None
    """Rate at which the angle grows from the epoch on."""
    towards: str | None = None
    """`sun`, or a body or spacecraft: turns `normal` as close to its direction from the pivot as
    the axis allows. A target on the axis leaves the angle at 0."""
    normal: StaticVec3 | None = None
    """With towards: direction in the rest pose that is turned towards it, such as the outward
    normal of solar cells."""
    translation_m: Finite | None = None
    """Displacement along the axis, instead of a rotation."""

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
        """Kind of joint in the core."""
        if self.translation_m is not None:
            return "slide"
        return "turn" if self.towards is None else "towards"


class Animation(Strict):
    """The model's own glTF animations, played at the frame's time."""

    name: str | None = None
    """Shell pattern on the names of animations (`perilune parts CONFIG --nodes`); all that match
    are played."""
    index: Annotated[Integer, Field(ge=0)] | None = None
    """Number of one animation, from 0, instead of a name."""
    speed: Finite = 1.0
    """Playback speed: seconds of animation per second."""
    start_s: Finite = 0.0
    """Time within the animation at the epoch."""
    loop: Literal["repeat", "clamp", "pingpong"] = "repeat"
    """After the end of an animation: repeat starts again, clamp stays, pingpong runs backwards."""

    @model_validator(mode="after")
    def _one_name(self) -> Animation:
        self._exactly_one("name", "index")
        return self
