"""The reader of OAISYS files: their JSON tree becomes a tree of our configuration.

One file a section. What has no counterpart is a warning (OaisysWarning) that names its key; what
cannot be is a ConfigError that does. Units: `metres_per_unit` at the top of the file (default: the
mean radius of the body that is orbited and orbits nothing, 6.378e6 for the Earth; 1 in a scene
without bodies and orbits) turns scene units into metres everywhere; a mesh's `scale` applies to its
model's own units on top of that. Frames: the scene's axes are ICRF's. Time: batches are scenes,
samples their steps, a step is 60 s. The keys name, description, seed and materials at the top are
ours, and so are `materials` of a mesh and `material` of one that is a body; `material_drivers`
drives the nodes of these graphs.
"""

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
    """An OAISYS file as a configuration of ours."""

    tree: dict[str, Any]
    origins: Mapping[str, str]
    """Key path of the tree -> key path of the file that it, and what is below it, comes from."""


def translate(tree: Mapping[str, Any], base: Path, source: str) -> Translation:
    """Our tree of an OAISYS file. base: the folder of its relative paths. source: its name.

    Warns (OaisysWarning) of every key that is not applied as it stands; ConfigError, by the key
    path of the file, of what cannot be.
    """
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
