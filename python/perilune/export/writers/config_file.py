"""The effective configuration of a dataset, stored with it so that frames can be rendered again."""

from __future__ import annotations

import json
from typing import Any

from perilune.simulation import Simulation

CONFIG_FILE = "config.json"
_REPLAY = ("index", "drivers", "scene_drivers")
"""Keys of a sample's metadata that a replay reads."""


def config_entry(sim: Simulation) -> dict[str, Any]:
    """config.json.

    tree: the configuration with all overrides, includes and defaults of files; its order is that of
    the instances and of the frame's random draws. base: folder that relative paths in it refer to.
    functions: those given in code, which no file can hold. replay: metadata with the values of a
    frame's drivers. overrides: changes since the configuration was opened, as recorded in each
    frame."""
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
    """JSON in the order of the configuration, with the numbers that YAML allows, such as
    infinity."""
    return json.dumps(entry, indent=1) + "\n"
