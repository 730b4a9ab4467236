"""Bounded volumes: from the configuration of a frame to the core's input."""

from __future__ import annotations

from typing import Any

import numpy as np

from perilune import materials
from perilune.base import rotations
from perilune.config.schema import Config
from perilune.document.document import Document
from perilune.materials import Graph, ImageFiles


class Volumes:
    """The volumes of a configuration; each graph is compiled once."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._images = ImageFiles(document.path)
        self._graphs: dict[tuple[str, str], Graph] = {}

    def request(self, config: Config) -> list[dict[str, Any]]:
        """The core's volumes of a frame, in the order of the configuration.

        Each has "name", "shape" (a row of the core's bounds) with "size_m" (3,), "parent" (index of
        the spacecraft, or of the body after all of them), "pose" (7,) in the parent's axes,
        "extinction_per_m", "albedo", "emission" (W m-3 sr-1), all (3,), "g", "core_m", and "graph"
        with its "parameters" (n, 3), or None."""
        entities = [*config.spacecraft, *config.bodies]
        rows = []
        for name, volume in config.volumes.items():
            row: dict[str, Any] = {
                "name": name,
                "shape": volume.shape,
                "size_m": volume.numbers_m,
                "parent": entities.index(volume.parent),
                "pose": np.array(
                    [*volume.position_m, *rotations.from_rpy_deg(volume.rotation_deg)]
                ),
                "extinction_per_m": volume.extinction_per_m,
                "albedo": volume.albedo,
                "emission": volume.emission_w_m3_sr,
                "g": volume.g,
                "core_m": volume.core_m,
                "graph": None,
            }
            if volume.material is not None:
                graph = self._graph(name, volume.material)
                material = materials.applied(config, volume.material, name)
                row |= {"graph": graph.core, "parameters": materials.values(graph, material)}
            rows.append(row)
        return rows

    def _graph(self, owner: str, name: str) -> Graph:
        """Compiles a graph with all values that drivers of the ideal configuration may vary."""
        if (owner, name) not in self._graphs:
            material = materials.applied(self._document.config, name, owner)
            self._graphs[owner, name] = materials.build(name, material, False, self._images)
        return self._graphs[owner, name]
