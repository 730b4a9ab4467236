"""How light is computed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Final, Literal

from pydantic import Field, model_validator

from perilune.config.errors import fail, fail_unread
from perilune.config.types import Integer, NonNegative, Positive, Strict

TextureFilter = Literal[
    "nearest",
    "bilinear",
    "trilinear",
    "anisotropic_2",
    "anisotropic_4",
    "anisotropic_8",
    "anisotropic_16",
]

QUALITIES: Final[Mapping[str, Mapping[str, Any]]] = {
    "draft": {"samples": 4, "tolerance_dn": 4.0, "texture_filter": "trilinear"},
    "train": {"samples": 16, "tolerance_dn": 1.0, "texture_filter": "anisotropic_16"},
    "reference": {"samples": 256, "tolerance_dn": 0.0, "texture_filter": "anisotropic_16"},
}
"""What each word of `render.quality` sets; those of `train` are the defaults of the keys."""


class Render(Strict):
    """Image quality and outputs of a frame."""

    quality: Literal["adaptive", "draft", "train", "reference"] = "adaptive"
    """One word for `samples`, `tolerance_dn` and `texture_filter`. adaptive: as the keys say, whose
    defaults are those of train. draft: 4 samples, a tolerance of 4 and trilinear, to look at.
    train: 16 samples, a tolerance of 1 and anisotropic_16. reference: 256 samples, or as `samples`
    says, a tolerance of 0 and no `force_off`: nothing is left out, shared between pixels or
    smoothed, every pixel gets all samples, and the image converges to the light of the scene as
    samples grow. Other values beside a word are refused; a word that an override sets replaces
    those of the file. docs/cost.md shows what each costs, docs/convergence.md what reference
    guarantees."""
    samples: Annotated[Integer, Field(ge=1, le=65536)] = 16
    """Colour samples per pixel. With adaptive sampling, pixels whose noise is within three
    tolerances get fewer and outlines up to twice as many, for about the error of this number
    everywhere. At a tolerance of 0 every pixel gets this number."""
    target_error_dn: Positive | None = None
    """Error that samples are taken for, in steps of 255 of the image: a pixel gets as many, up to
    `samples`, as its noise needs to be below this with `target_confidence`. How many is judged by
    its neighbours alone, which leaves its mean as it is; no light is shared between pixels. A
    warning says how many pixels `samples` did not bring to it."""
    target_confidence: Annotated[float, Field(strict=True, gt=0.0, lt=1.0)] = 0.95
    """Probability with which noise is to be below `target_error_dn`, for errors that are normally
    distributed."""
    time_budget_ms: Positive | None = None
    """CPU time of all threads that the colour of a frame is expected to take at most: effects are
    left out and samples taken away as at a higher tolerance, the least that the model of costs
    expects to suffice. It counts work and takes the costs that ship, never the clock, so that
    frames are the same on every machine; labels are those without it. docs/cost.md."""
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
    applies."""
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
    def _of_word(cls, data: Any) -> Any:
        word = data.get("quality") if isinstance(data, Mapping) else None
        return {**QUALITIES[word], **data} if isinstance(word, str) and word in QUALITIES else data

    @model_validator(mode="after")
    def _as_the_word_says(self) -> Render:
        for key, value in QUALITIES.get(self.quality, {}).items():
            given = getattr(self, key)
            if given != value and (self.quality, key) != ("reference", "samples"):
                fail_unread(
                    key,
                    f"is {_text(given)}, but quality: {self.quality} is {_text(value)}: leave one "
                    "of them out",
                )
        if self.quality == "reference" and self.force_off:
            fail_unread(
                "force_off",
                f"leaves out {self.force_off[0]}, but quality: reference leaves out nothing",
            )
        return self

    @model_validator(mode="after")
    def _of_a_target(self) -> Render:
        given = self.model_fields_set
        if self.target_error_dn is None and "target_confidence" in given:
            fail_unread("target_confidence", "is not used without target_error_dn")
        if self.time_budget_ms is not None and self.quality == "reference":
            fail_unread(
                "time_budget_ms", "leaves out effects, but quality: reference leaves out none"
            )
        if self.target_error_dn is not None and "antialiasing" in self.force_on:
            fail_unread(
                "target_error_dn",
                "chooses the samples of pixels, but force_on: antialiasing takes all of them",
            )
        return self

    @property
    def spelt_out(self) -> dict[str, Any]:
        """Overrides that say what the word says, so that others may stand beside them."""
        keys = {f"render.{key}": getattr(self, key) for key in QUALITIES["train"]}
        return {"render.quality": "adaptive", **keys}

    @property
    def named_quality(self) -> str:
        """The word whose values the keys have, whether or not it was given; adaptive for none."""
        if self.quality != "adaptive":
            return self.quality
        words = (
            word
            for word, keys in QUALITIES.items()
            if word != "reference"  # which leaves out nothing, too
            and all(getattr(self, key) == value for key, value in keys.items())
        )
        return next(words, "adaptive")

    @model_validator(mode="after")
    def _not_both(self) -> Render:
        both = sorted(set(self.force_on) & set(self.force_off))
        if both:
            fail("force_off", f"{both[0]} is in force_on too")
        return self


def _text(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
