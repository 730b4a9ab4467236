"""The effective configuration of a dataset, kept beside it: from it, frames can be made again."""

from __future__ import annotations

import json
from typing import Any

from perilune.simulation import Simulation

CONFIG_FILE = "config.json"
_REPLAY = ("index", "drivers", "scene_drivers")
"""What a replay reads of a sample's metadata."""


def config_entry(sim: Simulation) -> dict[str, Any]:
    """config.json.

    tree: the configuration with all overrides, includes and defaults of files that it was made of;
    its order is that of the instances, and of the frame's random draws. base: the folder that
    relative paths in it refer to. functions: what was given in code, which no file can hold.
    replay: the metadata that a frame's drivers are taken from. overrides: what of the tree was
    changed since the configuration was opened, as each frame tells.
    """
    document = sim.document
    entry: dict[str, Any] = {"base": str(document.base.resolve())}
    if sim.functions:
        entry["functions"] = sim.functions
    if document.replay is not None:
        entry["replay"] = {key: document.replay[key] for key in _REPLAY if key in document.replay}
    if document.changes:
        entry["overrides"] = dict(document.changes)
    return {**entry, "tree": document.tree}


def config_text(entry: dict[str, Any]) -> str:
    """In the order of the configuration; numbers that YAML may hold, infinity too."""
    return json.dumps(entry, indent=1) + "\n"
