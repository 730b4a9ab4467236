"""Tables of the craters and rocks that a frame shows, from its labels."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.camera.label import CameraLabel
from perilune.config import Config
from perilune.frame import craters, rocks, shutter
from perilune.frame.handles import Handles
from perilune.frame.labels import Taxonomy
from perilune.world import World

Array = NDArray[Any]

_MOST_IN_TABLES = 500_000
"""Craters about the ground in view of a frame, of which a dataset has a table."""


def body_with_terrain(config: Config, body: str | None) -> str:
    """The body, or the only one with terrain. ValueError names those that have it."""
    having = [name for name, entry in config.bodies.items() if entry.terrain is not None]
    if body is None and len(having) == 1:
        return having[0]
    if body is None or body not in having:
        said = "several bodies have" if body is None else f"'{body}' has no"
        raise ValueError(f"body: {said} terrain; those with terrain: {', '.join(having) or '-'}")
    return body


class GroundTables:
    """Tables of one frame. sample: with the labels that each table is made from."""

    def __init__(
        self,
        scene: World,
        sample: Mapping[str, Array],
        camera: CameraLabel,
        handles: Handles,
        taxonomy: Taxonomy,
    ) -> None:
        self._scene = scene
        self._sample = sample
        self._camera = camera
        self._handles = handles
        self._taxonomy = taxonomy

    def craters(self, name: str, least_px: float, most: int) -> Array:
        """Rows of frame.craters.CRATER_LABEL of a body; see Simulation.craters."""
        sample, number = self._sample, self._taxonomy.instances[name]
        handles, config = self._handles, self._scene.config
        terrain, _ = handles.terrain_of(config, name)
        catalogue = handles.assets.terrains.catalogue(handles.document, name, config.bodies[name])
        rows = craters.in_view(
            sample["position"],
            sample["crater_id"] if "crater_id" in sample else np.zeros_like(sample["instance"]),
            sample["instance"] == number,
            self._camera,
            shutter.middle(self._scene),
            name,
            terrain,
            least_px,
            most,
            catalogue,
        )
        rows["instance_id"] = number
        return rows

    def rocks(self, name: str) -> Array:
        """Rows of frame.rocks.ROCK_LABEL of a body; see Simulation.rocks."""
        sample, number = self._sample, self._taxonomy.instances[name]
        ids = np.where(sample["instance"] == number, sample["rock_id"], 0)
        terrain, _ = self._handles.terrain_of(self._scene.config, name)
        world = shutter.middle(self._scene)
        rows = rocks.in_view(ids, self._camera, world, name, terrain)
        rows["instance_id"] = number
        return rows

    def all(self) -> dict[str, Array]:
        """Both tables, of all bodies; see Simulation.ground_tables."""
        config, found = self._scene.config, {}
        shown = config.labels.craters
        least_px = shown.least_px if shown is not None else 1.0  # no sample has crater_id then
        parts = {
            "craters": [
                self.craters(name, least_px, _MOST_IN_TABLES)
                for name in craters.bodies_with(config, "craters")
                if {"crater_id", "instance", "position"} <= set(self._sample)
            ],
            "rocks": [
                self.rocks(name)
                for name in craters.bodies_with(config, "rocks")
                if {"rock_id", "instance"} <= set(self._sample)
            ],
        }
        for table, rows in parts.items():
            if rows:
                found[table] = np.concatenate(rows)
        return found
