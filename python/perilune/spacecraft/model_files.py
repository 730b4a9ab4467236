"""Reads models of spacecraft, and tells users of other formats how to convert them."""

from __future__ import annotations

import math
from pathlib import Path, PurePath

import numpy as np

from perilune import _core
from perilune.base.file_cache import FileCache
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

MODELS: FileCache[_core.Model] = FileCache(lambda model: model.nbytes)
"""Models of single files that were read last, for all simulations of this process."""


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


def _stands_alone(path: Path) -> bool:
    """Whether a model is one binary file that names no others, whose changes would not be seen."""
    try:
        with path.open("rb") as file:
            head = file.read(20)
            if head[:4] != b"glTF" or head[16:] != b"JSON":
                return False
            said = int.from_bytes(head[12:16], "little")
            text = file.read(min(said, path.stat().st_size))  # `read` makes room for all it is told
    except OSError:
        return False
    return b'"uri"' not in text and b"\\u" not in text  # a name may be spelt with escapes


def shared_model(
    path: str,
    crease_angle_rad: float,
    stretch: tuple[float, float, float],
    faces: Faces,
) -> _core.Model:
    """As read_model; simulations of a process share models of files that have not changed."""

    def read() -> _core.Model:
        return read_model(path, crease_angle_rad, stretch, faces)

    if not _stands_alone(Path(path)):
        return read()
    return MODELS.of(Path(path), (crease_angle_rad, stretch, repr(faces)), read)
