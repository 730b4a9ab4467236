"""The section `shape` of a body."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field

from perilune.config.types import FileName, Positive, Strict, refuse_drawn, triple


class Shape(Strict):
    """A closed mesh as the surface of a body, in body axes: x at longitude 0, z at the north pole.

    All other properties of the body apply: orbit, rotation, maps by longitude and latitude,
    photometry, material, labels. `radii_km` remains the reference for altitudes, eclipses of
    `light_curve` and hooks. Materials of a glTF file are the body's surface, unless the body has an
    `albedo`, `color_map`, `photometry`, a `reflectance` other than lambert, or a `material` that
    replaces it. Their base colour, roughness, metalness, textures, normal maps and coats are used,
    but not opacity and emission. Materials of other file formats are ignored."""

    file: FileName
    """Mesh file: .obj; .tab or .txt with vertices and plates as in the Planetary Data System; .gltf
    or .glb (y up in the file). Relative to this file, or data:... under PERILUNE_DATA."""
    metres_per_unit: (
        Annotated[
            tuple[Positive, Positive, Positive],
            BeforeValidator(triple),
            BeforeValidator(refuse_drawn),
        ]
        | None
    ) = None
    """Scale: a number, or one for each of the axes x, y, z. Default: 1 for glTF; 1000 for others,
    because shapes are published in km."""
    smooth: Annotated[bool, Field(strict=True)] = True
    """Whether normals are interpolated between vertices; false: flat facets."""


def named(value: object) -> object:
    """For BeforeValidator: turns a path into a shape with this file."""
    return {"file": value} if isinstance(value, str) else value
