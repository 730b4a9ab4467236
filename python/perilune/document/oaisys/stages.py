"""ASSET_SETUP.STAGES and MATERIALS: terrain and its materials, which are not supported."""

from __future__ import annotations

from perilune.document.oaisys import drivers
from perilune.document.oaisys.node import Node


def read(assets: Node) -> None:
    """Warns of every entry by its path."""
    for entry in assets.children("STAGES"):
        kind = entry.text("type", "stage")
        entry.leave(f"{kind}: terrain is not there yet; the stage is left out")
    for entry in assets.children("MATERIALS"):
        params = entry.child("materialParams")
        for owner in (entry, params):
            drivers.read(owner, "meshes keep the materials of their own files")
        kind = entry.text("type", "material")
        entry.leave(f"{kind}: meshes keep the materials of their own files")
        params.skip()
