"""Reads models of spacecraft, and tells users of other formats how to convert them."""

from __future__ import annotations

import math
from pathlib import PurePath

import numpy as np

from perilune import _core
from perilune.config.faces import DEFAULT, Faces
from perilune.spacecraft.faces import sides

SUFFIXES = (".glb", ".gltf")
FOREIGN: dict[str, str] = {
    ".obj": "Wavefront OBJ",
    ".stl": "STL",
    ".blend": "a file of Blender",
    ".fbx": "FBX",
    ".dae": "COLLADA",
    ".3ds": "3D Studio",
    ".ply": "PLY",
    ".usd": "USD",
    ".usda": "USD",
    ".usdc": "USD",
    ".usdz": "USD",
    ".step": "STEP",
    ".stp": "STEP",
}
"""Suffix -> name, for model formats that are not supported."""


def foreign(path: str) -> str:
    """What is wrong with the name of a model; empty for a supported format or an unknown suffix."""
    kind = FOREIGN.get(PurePath(path).suffix.lower())
    if kind is None:
        return ""
    ours = f"models are glTF 2.0 ({', '.join(SUFFIXES)})"
    return f"{kind}, which is not read; {ours}: Blender's File > Export > glTF 2.0 makes one"


def read_model(
    path: str,
    crease_angle_rad: float = math.pi,
    stretch: tuple[float, float, float] = (1.0, 1.0, 1.0),
    faces: Faces = DEFAULT,
) -> _core.Model:
    """A model; ValueError that names the file if it is damaged or has another format.

    crease_angle_rad, stretch: see _core.Model; pi keeps the file's normals. faces: as the key."""
    if wrong := foreign(path):
        raise ValueError(f"{path}: {wrong}")
    factors = None if stretch == (1.0, 1.0, 1.0) else np.array(stretch)
    return _core.Model(path, crease_angle_rad, factors, sides(faces))
