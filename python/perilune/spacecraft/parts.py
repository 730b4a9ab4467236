"""Divides a model's triangles into parts: by the file's structure, connectivity, or position."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.config.errors import ConfigError
from perilune.config.parts import PartBox, Parts

F64 = NDArray[np.float64]

SMALL = "small"
"""Name of the part of all components that are too small for a part of their own."""
WHOLE = "model"


@dataclass(frozen=True)
class PartEntry:
    """A part before it is labelled."""

    name: str
    """Name, unique in its model: the second `panel` is `panel#2`."""
    base: str
    """Name without the number, which patterns are matched with too."""
    material: str
    """Material of most of its triangles."""


@dataclass(frozen=True)
class Partition:
    """Parts of a model, and the part of each triangle."""

    entries: tuple[PartEntry, ...]
    triangle_part: NDArray[np.uint32] | None
    """(T,) index into entries; None: the model's own parts."""


def unique_names(names: Iterable[str]) -> list[str]:
    """`a, a, a#2, a` -> `a, a#3, a#2, a#4`: all are unique; the first use of a name keeps it."""
    wanted = list(names)
    taken = set(wanted)
    last: dict[str, int] = {}
    result = []
    for name in wanted:
        unique, number = name, last.get(name, 0) + 1
        if number > 1:
            while f"{name}#{number}" in taken:
                number += 1
            unique = f"{name}#{number}"
        last[name] = number
        taken.add(unique)
        result.append(unique)
    return result


def partition(model: _core.Model, settings: Parts, key: str = "parts") -> Partition:
    """Divides a model as `settings` say; `key` is their path, for errors.

    Components are numbered in the whole model, so that a box does not change their numbers."""
    own = model.parts
    if settings.split == "primitive" and not settings.boxes:
        bases = [part["name"] for part in own]
        names = unique_names(bases)
        materials = [part["material"] for part in own]
        rows = zip(names, bases, materials, strict=True)
        return Partition(tuple(PartEntry(*row) for row in rows), None)
    mesh = model.mesh()
    group, labels = _split(model, mesh["triangle_part"], settings)
    group, labels = _with_boxes(model, mesh, settings.boxes, group, labels, key)
    used, triangle_part = np.unique(group, return_inverse=True)
    bases = [labels[k] for k in used]
    names = unique_names(bases)
    materials = _main_materials(model, mesh["triangle_part"], triangle_part, len(used))
    entries = tuple(PartEntry(*row) for row in zip(names, bases, materials, strict=True))
    return Partition(entries, triangle_part.astype(np.uint32))


def _split(
    model: _core.Model, triangle_part: NDArray[np.uint32], settings: Parts
) -> tuple[NDArray[np.int64], list[str]]:
    """Group of every triangle, and the groups' names."""
    own = model.parts
    part = triangle_part.astype(np.int64)
    if settings.split == "none":
        return np.zeros_like(part), [WHOLE]
    if settings.split == "primitive":
        return part, [row["name"] for row in own]
    if settings.split == "node":
        nodes = list(dict.fromkeys(row["node"] for row in own))
        of_part = np.array([nodes.index(row["node"]) for row in own], dtype=np.int64)
        first = {row["node"]: row["name"] for row in reversed(own)}
        return of_part[part], [first[node] for node in nodes]
    component, names = components(model)
    sizes = np.bincount(component)
    # Components are numbered by falling size, so that those to be merged come last.
    kept = int((sizes >= settings.merge_below).sum())
    return np.minimum(component, kept), [*names[:kept], SMALL]


def components(model: _core.Model) -> tuple[NDArray[np.int64], list[str]]:
    """(T,) connected piece of every triangle, the largest first; and the pieces' names."""
    component = model.components().astype(np.int64)
    return component, [f"component-{k}" for k in range(int(component.max(initial=-1)) + 1)]


def centroids(model: _core.Model, mesh: dict[str, NDArray[Any]]) -> NDArray[Any]:
    """(3, T): centroids of a model's triangles, in the units of its file."""
    corners = (mesh["positions"] / model.stretch).T[:, mesh["indices"].T]
    return (corners[:, 0] + corners[:, 1] + corners[:, 2]) / 3.0


def inside_box(
    model: _core.Model, middles: NDArray[Any], box: PartBox, key: str
) -> NDArray[np.bool_]:
    """(T,): whether a triangle's centroid, of `centroids`, is in a box; ConfigError with `key` if
    none is."""
    inside = np.ones(middles.shape[1], dtype=bool)
    for along, low, high in zip(middles, box.min, box.max, strict=True):
        inside &= (along >= low) & (along <= high)
    if not inside.any():
        raise ConfigError(f"{key}: no triangle is in it ({_extent_text(model)})")
    return inside


def _with_boxes(
    model: _core.Model,
    mesh: dict[str, NDArray[Any]],
    boxes: dict[str, PartBox],
    group: NDArray[np.int64],
    labels: Sequence[str],
    key: str,
) -> tuple[NDArray[np.int64], list[str]]:
    """Puts the triangles in boxes into groups of their own, which come first."""
    result = group + len(boxes)
    free = np.ones(len(group), dtype=bool)
    middles = centroids(model, mesh) if boxes else np.empty((3, 0))
    for number, (name, box) in enumerate(boxes.items()):
        where = f"{key}.boxes.{name}"
        inside = inside_box(model, middles, box, where)
        if not (inside & free).any():
            why = "earlier boxes hold all its triangles"
            raise ConfigError(f"{where}: no triangle is left in it ({why})")
        result[inside & free] = number
        free &= ~inside
    return result, [*boxes, *labels]


def _extent_text(model: _core.Model) -> str:
    low, high = model.bounds / model.stretch
    return (
        f"none has its centroid there; the model spans {np.round(low, 4).tolist()} to "
        f"{np.round(high, 4).tolist()}"
    )


def _main_materials(
    model: _core.Model,
    model_part: NDArray[np.uint32],
    triangle_part: NDArray[np.intp],
    count: int,
) -> list[str]:
    """Material with most triangles of each part; on a tie the first in the file."""
    materials = list(dict.fromkeys(part["material"] for part in model.parts))
    of_part = np.array([materials.index(part["material"]) for part in model.parts])
    cells = triangle_part * len(materials) + of_part[model_part]
    table = np.bincount(cells, minlength=count * len(materials))
    return [materials[k] for k in table.reshape(count, len(materials)).argmax(axis=1)]


@dataclass(frozen=True)
class PartExtent:
    """Size and position of a part, as `perilune parts` lists it."""

    triangles: int
    low: F64
    """(3,) lower corner, in the file's units."""
    high: F64


def extents(model: _core.Model, cut: Partition) -> list[PartExtent]:
    """Triangles and bounding box of every part, in their order."""
    mesh = model.mesh()
    part = mesh["triangle_part"] if cut.triangle_part is None else cut.triangle_part
    corners = (mesh["positions"] / model.stretch)[mesh["indices"]]
    low = np.full((len(cut.entries), 3), np.inf)
    high = np.full((len(cut.entries), 3), -np.inf)
    np.minimum.at(low, part, corners.min(axis=1))
    np.maximum.at(high, part, corners.max(axis=1))
    counts = np.bincount(part, minlength=len(cut.entries))
    return [PartExtent(int(n), a, b) for n, a, b in zip(counts, low, high, strict=True)]
