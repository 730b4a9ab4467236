"""A spacecraft: its model, its orbit, its attitude, and what is on it."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from perilune.config.articulation import Animation, Joint
from perilune.config.attitude import Attitude, Inertial
from perilune.config.faces import DEFAULT, Faces
from perilune.config.keypoints import Keypoints
from perilune.config.labels import ClassPatterns, EntryClasses
from perilune.config.materials import DriverSection, MaterialUse
from perilune.config.orbit import Orbit
from perilune.config.parts import Parts
from perilune.config.symmetries import Symmetries
from perilune.config.types import (
    FileName,
    Integer,
    Positive,
    PositiveByAxis,
    StaticNonNegative,
    Strict,
)


class Spacecraft(Strict):
    """A model on an orbit."""

    model: FileName
    """Model file, .glb or .gltf; relative to this file, or data:... under PERILUNE_DATA."""
    size_m: Annotated[Positive, Field(ge=1e-9, le=1e18)] | None = None
    """Longest side of the model's bounding box; scales the model."""
    metres_per_unit: PositiveByAxis | None = None
    """Scale of the model: a number, or one for each of its axes x, y, z (z up). It acts like a
    parent node of that scale. Boxes of `parts` and `materials` are given in the file's units, all
    other lengths at the model's final size."""
    centre: Literal["bounds", "origin"] = "bounds"
    """Point of the model that follows the orbit: the centre of its bounding box, or the file's
    origin."""
    crease_angle_deg: Annotated[StaticNonNegative, Field(le=180)] = 65.0
    """Crease angle: an edge is shaded sharp if its faces meet at more than this angle although the
    file has one normal for both, and if that normal is more than half of this angle from one of
    them. 180 keeps the file's normals."""
    faces: Faces = DEFAULT
    """Which sides of faces exist, for visibility, light, labels and written models alike.
    double_sided: both. as_stated: as the file says; single-sided materials have no backs (glTF).
    single_sided: fronts only. A mapping from shell patterns on material names (case-insensitive) to
    one of these: the first match counts, double_sided without any. Of two sheets back to back,
    closer than a ten-thousandth of the model's size, the one facing the viewer is always visible.
    Solids that transmit light keep both sides."""
    orbit: Orbit
    gm_km3_s2: Positive | None = None
    """Gravitational parameter, for a model that others orbit: an asteroid or a moonlet."""
    attitude: Attitude = Inertial.of_defaults()
    obj_id: Annotated[Integer, Field(ge=0)] | None = None
    """BOP object id. Default: 1, 2, ... in the order of this section."""
    class_: str | None = Field(default=None, alias="class")
    """Class at the label level `object`. Default: the entry's name."""
    classes: EntryClasses = Field(default_factory=dict)
    """Classes at your own label levels: level of `labels.levels` -> class, or class -> shell
    patterns on part and material names, in place of those of `labels.classes`."""
    parts: Parts = Parts.of_defaults()
    part_classes: ClassPatterns = Field(default_factory=dict)
    """Class of part -> shell patterns on part and material names; tried before those of
    `labels`."""
    materials: tuple[MaterialUse, ...] = ()
    """Material graphs that replace or wrap the model's materials. For each triangle the first entry
    that matches counts."""
    model_graphs: bool = True
    """Whether to use material graphs stored in the model's file (`perilune_graph` in a material's
    extras, with the keys of an entry of `materials`) where `materials` assigns none. Such a graph
    is the entry `FILE-MATERIAL` of the top section `materials`; keys given there override the
    file's."""
    material_drivers: DriverSection | None = None
    """Values for driver nodes of these graphs that the materials' own drivers do not set."""
    articulation: tuple[Joint, ...] = ()
    """Joints: nodes of the model that move."""
    animation: Animation | None = None
    """The model's own animations. Joints act on top of them."""
    symmetries: Symmetries = Symmetries.of_defaults()
    keypoints: Keypoints = Keypoints.of_defaults()
    """Named points of it whose images are labels."""

    @model_validator(mode="after")
    def _one_scale(self) -> Spacecraft:
        self._exactly_one("size_m", "metres_per_unit")
        return self

    @property
    def stretch(self) -> tuple[float, float, float]:
        """Scale factors along the model's axes, relative to the largest, which is 1."""
        given = self.metres_per_unit
        if not isinstance(given, tuple):
            return (1.0, 1.0, 1.0)
        x, y, z = given
        return (x / max(given), y / max(given), z / max(given))
