"""SIMULATION_SETUP: scenes and steps. Outputs are options of the command instead."""

from __future__ import annotations

from typing import Any

from perilune.document.oaisys.node import Node
from perilune.document.oaisys.scene import Scene

EPOCH = "2026-03-20T12:00:00Z"
"""Date of OAISYS scenes, which have none."""
STEP_S = 60.0
"""Duration of a step, which OAISYS does not define. Orbits and rotations of these files count by
steps, so it only affects the clock."""

_HINTS: dict[str, tuple[Any, str]] = {
    "outputPath": ("", "give the folder to the command: perilune render CONFIG --out DIR"),
    "outputIDOffset": (0, "frames count from 0; give the command --frames FIRST:END"),
    "renderImages": (True, "`perilune orbit` gives poses without images"),
    "saveMetaData": (True, "poses are always written with the images"),
    "saveBlenderFiles": (False, "there are no Blender files"),
    "defaultCfg": ("", "other files are not read; put their keys into this one"),
}
"""Key -> the value without a warning, and the warning for others."""


def read(node: Node, scene: Scene) -> None:
    """A batch is a scene, a sample one of its steps."""
    samples = node.whole("numSamplesPerBatch", 1, smallest=1)
    scene.steps = samples
    batches = node.whole("numBatches", 1, smallest=1)
    scene.tree["time"] = {"epoch": EPOCH, "step_s": STEP_S, "frames_per_scene": samples}
    node.comes("time.frames_per_scene", "numSamplesPerBatch")
    if batches > 1:
        total = batches * samples
        text = f"batches are scenes of {samples} steps; render them with --frames 0:{total}"
        node.notes.warn(node.where("numBatches"), text)
    for key, (quiet, hint) in _HINTS.items():
        if node.get(key, quiet) != quiet:
            node.ignore(key, f"not applied: {hint}")
