"""The shape of a body."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field

from perilune.config.types import FileName, Positive, Strict, refuse_drawn, triple


class Shape(Strict):
    """A closed mesh as the surface of a body, in body axes: x at longitude 0, z at the north pole.

    What else the body has (place, rotation, maps by longitude and latitude, photometry, material,
    labels) stays; `radii_km` is then what altitudes, eclipses of `light_curve` and hooks count
    from. Materials of a glTF file are the body's surface where it has no `albedo`, `color_map`,
    `photometry`, `reflectance` but lambert, or `material` that replaces it: base colour, roughness,
    metalness, their textures, normal maps and coats; opacity and emission are not used. Materials
    of other files are not.
    """

    file: FileName
    """.obj; .tab or .txt with vertices and plates as of the Planetary Data System; .gltf or .glb
    (y up there). Relative to this file, or data:... under PERILUNE_DATA."""
    metres_per_unit: (
        Annotated[
            tuple[Positive, Positive, Positive],
            BeforeValidator(triple),
            BeforeValidator(refuse_drawn),
        ]
        | None
    ) = None
    """A number, or one for each of the axes x, y, z. Default: 1000, as shapes are published in km;
    of glTF 1."""
    smooth: Annotated[bool, Field(strict=True)] = True
    """Whether normals are interpolated between the facets' corners; false: facets are flat."""


def named(value: object) -> object:
    """For BeforeValidator: a path is a shape of nothing but a file."""
    return {"file": value} if isinstance(value, str) else value
