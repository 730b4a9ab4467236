"""Files named in an OAISYS file: models as glTF next to their .blend, maps next to models."""

from __future__ import annotations

import csv
import itertools
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from perilune import _core
from perilune.bodies import shape_files
from perilune.document.oaisys.node import Node

_GLTF = (".glb", ".gltf")
_SHAPES = (".obj", ".tab", ".txt")
_MAPS = (".jpg", ".jpeg", ".png")
_PICTURES = (*_MAPS, ".webp")
_DATA = "data:"


@dataclass(frozen=True)
class ModelFile:
    """Files of a mesh."""

    text: str
    """Path in the OAISYS file."""
    found: str | None
    """Path in our configuration; None if there is no such glTF file."""
    swapped: bool
    """Whether it, or the shape, replaces another file."""
    shape: str | None
    """File of a body's shape in our configuration, if there is one and no glTF file."""
    map: str | None
    """Picture of the same name next to it, in our configuration."""
    base: Path

    @property
    def stem(self) -> str:
        """The file's name without its suffix."""
        return Path(self.text).stem

    def missing(self) -> str:
        """Message if there is no glTF file."""
        stem = str(_located(self.text, self.base).with_suffix(""))
        endings = " or ".join(stem + ending for ending in (*_GLTF, *_SHAPES[:1]))
        return f"no such file: {endings} (.blend files are not read)"


def _located(text: str, base: Path) -> Path:
    """Resolves a path; `data:` is the folder of the sample data, as elsewhere."""
    if text.startswith(_DATA):
        return Path(os.environ.get("PERILUNE_DATA", "")) / text.removeprefix(_DATA).lstrip("/")
    return base / text


def _beside(text: str, base: Path, endings: tuple[str, ...]) -> str | None:
    for ending in endings:
        candidate = str(Path(text).with_suffix(ending))
        if _located(candidate, base).is_file():
            return candidate
    return None


def model(params: Node, key: str, base: Path) -> ModelFile:
    """The model named by a key, and the map next to it."""
    text = params.text(key)
    if not Path(text).name:
        params.fail(key, f"must name a file, not {text!r}")
    suffix = Path(text).suffix.lower()
    shape = _beside(text, base, (suffix,)) if suffix in _SHAPES else None
    found = _beside(text, base, (suffix,)) if suffix in _GLTF else None
    if found is None and shape is None and suffix not in _GLTF:
        found = _beside(text, base, _GLTF)
        shape = None if found is not None else _beside(text, base, _SHAPES[:1])
    swapped = (found or shape) is not None and suffix not in (*_GLTF, *_SHAPES)
    return ModelFile(text, found, swapped, shape, _beside(text, base, _MAPS), base)


def picture(text: str, base: Path) -> str | None:
    """The picture at a path, or one of the same name in a supported format."""
    suffix = Path(text).suffix.lower()
    return _beside(text, base, (suffix, *_PICTURES) if suffix in _PICTURES else _PICTURES)


def first_frame(text: str, base: Path) -> int:
    """The `frame` of the first row of a table of poses; 0 if the table has none."""
    try:
        with _located(text, base).open(encoding="utf-8-sig", newline="") as file:
            rows = [row for row in itertools.islice(csv.reader(file), 100) if "".join(row).strip()]
        names = [name.strip() for name in rows[0]]
        number = rows[1][names.index("frame")] if "frame" in names else rows[0][0]
        return int(float(number))
    except (OSError, ValueError, OverflowError, IndexError, csv.Error):
        return 0  # the reader of the table reports its faults


def has_graphs(file: ModelFile) -> bool:
    """Whether materials of the model have graphs in their extras; false for an invalid file, which
    its reader reports."""
    if file.found is None:
        return False
    try:
        return _core.gltf_graphs(str(_located(file.found, file.base))) != "[]"
    except ValueError:
        return False


def reach(file: ModelFile, params: Node, scale: float | Sequence[float]) -> float:
    """Distance from a model's origin to its farthest vertex, after uniform or axis-wise scaling."""
    assert file.found is not None  # the caller has reported missing files
    try:
        positions = _core.Model(str(_located(file.found, file.base))).mesh()["positions"]
    except (ValueError, OSError) as error:
        params.fail("meshFilePath", str(error))
    return float(np.linalg.norm(positions * np.asarray(scale), axis=1).max())


def semi_axes(text: str, file: ModelFile, params: Node) -> list[float]:
    """Extent of a closed shape along x, y and z from its origin, in its own units."""
    try:
        vertices, _ = shape_files.read(_located(text, file.base))
    except (ValueError, OSError) as error:
        params.fail("meshFilePath", str(error))
    return [float(reach) for reach in np.abs(vertices).max(axis=0)]
