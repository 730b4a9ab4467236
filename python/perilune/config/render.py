"""How light is computed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from perilune.config.errors import fail
from perilune.config.types import Integer, NonNegative, Strict

TextureFilter = Literal[
    "nearest",
    "bilinear",
    "trilinear",
    "anisotropic_2",
    "anisotropic_4",
    "anisotropic_8",
    "anisotropic_16",
]


class Render(Strict):
    """Image quality and outputs of a frame."""

    quality: Literal["adaptive", "reference"] = "adaptive"
    """adaptive: saves effects and samples within `tolerance_dn`. reference: `tolerance_dn` is 0
    and `force_off` empty. Nothing is left out, shared between pixels or smoothed, every pixel gets
    all samples, and the image converges to the light of the scene as samples grow. See
    docs/convergence.md."""
    samples: Annotated[Integer, Field(ge=1, le=65536)] = 16
    """Colour samples per pixel. With adaptive sampling, pixels whose noise is within three
    tolerances get fewer and outlines up to twice as many, for about the error of this number
    everywhere. At a tolerance of 0 every pixel gets this number."""
    max_bounces: Annotated[Integer, Field(ge=0, le=64)] = 4
    """Largest number of bounces of a light path; 0: direct light only."""
    texture_filter: TextureFilter = "anisotropic_16"
    """Best texture filter that may be used. nearest and bilinear take one texel or four of one mip
    level, trilinear four of each of two levels, anisotropic_N up to N such lookups along the longer
    axis of the pixel's footprint."""
    volume_steps: Annotated[Integer, Field(ge=1, le=1024)] = 32
    """Largest number of steps along a ray through a volume. For a volume with a material it is also
    the resolution, from 8 to 64 cells a side, of the precomputed light inside it; rays from
    surfaces take a quarter of the steps."""
    tolerance_dn: NonNegative = 1.0
    """Largest change of any pixel by an effect that may be left out. 0 keeps every effect that
    applies. Default: 1, or 0 with `quality: reference`."""
    force_on: tuple[str, ...] = ()
    """Effects that are kept whatever their bound. `perilune plan` lists the names."""
    force_off: tuple[str, ...] = ()
    """Effects that are left out whatever their bound."""
    channels: tuple[str, ...] = ("rgb", "depth", "semantic", "part", "instance", "objects")
    """Channels that a sample holds unless it is asked for others."""
    scans: tuple[Literal["points", "lidar", "time_of_flight", "events"], ...] = ()
    """Measurements that datasets hold beside channels: `points` of the pixels, returns of all
    `lidars`, pixels of `time_of_flight`, and `events` until the next frame. docs/lidar.md."""
    amodal: Annotated[bool, Field(strict=True)] = True
    """Whether object labels cover whole silhouettes, including hidden and cut-off parts. Costs
    extra rays."""

    @model_validator(mode="before")
    @classmethod
    def _tolerance_of_reference(cls, data: Any) -> Any:
        if isinstance(data, Mapping) and data.get("quality") == "reference":
            return {"tolerance_dn": 0.0, **data}
        return data

    @model_validator(mode="after")
    def _whole_reference(self) -> Render:
        if self.quality == "reference" and self.tolerance_dn != 0.0:
            fail(
                "tolerance_dn",
                f"is {self.tolerance_dn:g}, but quality: reference is a tolerance of 0: leave one "
                "of them out",
            )
        if self.quality == "reference" and self.force_off:
            fail(
                "force_off",
                f"leaves out {self.force_off[0]}, but quality: reference leaves out nothing",
            )
        return self

    @model_validator(mode="after")
    def _not_both(self) -> Render:
        both = sorted(set(self.force_on) & set(self.force_off))
        if both:
            fail("force_off", f"{both[0]} is in force_on too")
        return self
