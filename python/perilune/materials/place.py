"""Assigns material graphs to the triangles of a spacecraft."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import partial
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base.same import Latest
from perilune.config.errors import nearest
from perilune.config.materials import MaterialUse
from perilune.config.schema import Config
from perilune.materials.drivers import drivers_of, given_by_drivers
from perilune.materials.graph import F64, Graph, triples
from perilune.spacecraft.parts import Partition, centroids, components, inside_box


@dataclass(frozen=True)
class Placed:
    """The graphs of a spacecraft in a frame, or the graph of a body."""

    names: tuple[str, ...]
    """Entry of `materials` of each graph."""
    graphs: tuple[Graph, ...]
    triangle_graph: NDArray[np.int32]
    """(T,) index into graphs; -1: the model's material."""

    def is_like(self, other: Placed) -> bool:
        """Whether the same graphs are on the same triangles."""
        same = self.triangle_graph is other.triangle_graph
        return self.graphs == other.graphs and (same or not len(self.triangle_graph))


def _triples(graph: Graph, config: Config, name: str, owner: str) -> Triples:
    return triples(graph, config.materials[name], given_by_drivers(config, name, owner))


def triangles(
    uses: Sequence[MaterialUse], model: _core.Model, cut: Partition, key: str
) -> NDArray[np.int32]:
    """(T,) index of the first of `uses` that matches each triangle; -1: none.

    ValueError with `key`, the path of the uses, for a pattern that matches no triangle."""
    mesh = model.mesh()
    mesh_part = mesh["triangle_part"].astype(np.int64)
    result = np.full(len(mesh_part), -1, dtype=np.int32)
    kinds = _kinds(uses, model, cut, mesh_part)
    middles = centroids(model, mesh) if any(use.box for use in uses) else np.empty((3, 0))
    for k, use in enumerate(uses):
        fits = np.ones(len(mesh_part), dtype=bool)
        for what, (names, of_triangle) in kinds.items():
            pattern = getattr(use, what)
            if pattern is not None:
                hit = np.array([_matches(pattern, name) for name in names])
                if use.required and not hit.any():
                    near = nearest(pattern, dict.fromkeys(names))
                    raise ValueError(f"{key}[{k}].{what}: no {what} fits '{pattern}'{near}")
                fits &= hit[of_triangle]
        if use.box is not None:
            fits &= inside_box(model, middles, use.box, f"{key}[{k}].box")
        if use.required and not fits.any():
            raise ValueError(f"{key}[{k}]: no triangle fits all that is asked")
        result[fits & (result < 0)] = k
    return result


def _kinds(
    uses: Sequence[MaterialUse], model: _core.Model, cut: Partition, mesh_part: NDArray[np.int64]
) -> dict[str, tuple[list[str], NDArray[np.int64]]]:
    """Names that patterns of uses are matched with, and the index of each triangle's."""
    part_of = mesh_part if cut.triangle_part is None else cut.triangle_part.astype(np.int64)
    kinds = {
        "material": ([part["material"] for part in model.parts], mesh_part),
        "part": ([entry.name for entry in cut.entries], part_of),
    }
    if any(use.component is not None for use in uses):
        of_triangle, names = components(model)
        kinds["component"] = (names, of_triangle)
    return kinds


def _matches(pattern: str, name: str) -> bool:
    return fnmatchcase(name.lower(), pattern.lower())


Triples: TypeAlias = list[tuple[float, float, float]]


def parameters(placed: Iterable[tuple[str, Placed]], config: Config, kept: Latest[Triples]) -> F64:
    """(n, 3) for the core's request, in the order of `placed`, each with its object.

    kept: rows of the graphs that no driver changes."""
    rows: Triples = []
    for owner, row in placed:
        for k, (name, graph) in enumerate(zip(row.names, row.graphs, strict=True)):
            material = config.materials[name]
            if graph.parameters:
                read = (graph, material, *drivers_of(config, name, owner))
                rows += kept.of(
                    f"{owner}.{k}",
                    read,
                    partial(_triples, graph, config, name, owner),
                )
    return np.array(rows, dtype=np.float64).reshape(-1, 3)
