"""Reads OAISYS files: translates their JSON tree to a tree of Perilune's configuration.

One module per section. Keys without a counterpart cause a warning (OaisysWarning) that names them,
impossible values a ConfigError. Units: `metres_per_unit` at the top of the file converts scene
units to metres everywhere. Its default is the mean radius of the central body that orbits nothing,
6.378e6 for the Earth, and 1 in a scene without bodies and orbits. A mesh's `scale` applies to its
model's own units in addition. Frames: the scene's axes are ICRF's. Time: batches are scenes,
samples their steps, a step is 60 s. The keys name, description, seed and materials at the top are
Perilune's, and so are `materials` of a mesh and `material` of one that is a body;
`material_drivers` drives the nodes of these graphs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from perilune.document.loader import is_oaisys
from perilune.document.oaisys import drivers, environment, meshes, render, sensors, setup, stages
from perilune.document.oaisys.node import Node, Notes, OaisysWarning
from perilune.document.oaisys.scene import Scene

__all__ = ["OaisysWarning", "Translation", "is_oaisys", "translate"]


@dataclass(frozen=True)
class Translation:
    """An OAISYS file as a configuration of Perilune."""

    tree: dict[str, Any]
    origins: Mapping[str, str]
    """Key path of the tree -> key path of the file that it, with everything below, comes from."""


def translate(tree: Mapping[str, Any], base: Path, source: str) -> Translation:
    """Perilune's tree of an OAISYS file. base: the folder of its relative paths. source: its name.

    Warns (OaisysWarning) of every key that is not applied as given; ConfigError with the key path
    in the file for impossible values."""
    notes = Notes(source)
    root = Node(tree, "", notes)
    scene = Scene(base, notes, metres_per_unit=1.0, tree={"version": 1})
    if root.has("seed"):
        scene.tree["seed"] = root.whole("seed")
    for key in ("name", "description"):
        if root.has(key):
            scene.tree[key] = root.text(key)
    setup.read(root.child("SIMULATION_SETUP"), scene)
    assets = root.child("ASSET_SETUP")
    drivers.read_graphs(root, scene.tree)
    meshes.read(root, assets, scene)
    stages.read(assets)
    sensors.read(root.child("SENSOR_SETUP"), scene)
    effects = root.child("RENDER_POST_PROCESSING_EFFECTS_SETUP")
    render.read(root.child("RENDER_SETUP"), effects, scene)
    environment.read(root.child("ENVIRONMENT_EFFECTS_SETUP"), scene)
    root.close()
    notes.issue()
    return Translation(scene.tree, notes.origins)
