"""RENDER_SETUP: passes become channels; RENDER_POST_PROCESSING_EFFECTS_SETUP is told of."""

from __future__ import annotations

from typing import Any

from perilune.config.oaisys.node import Node
from perilune.config.oaisys.scene import Scene

PASSES = ("RGBDPass", "SemanticPass", "InstancePass")


def _rgbd(params: Node, render: dict[str, Any]) -> list[str]:
    if params.has("renderSamples"):
        render["samples"] = params.whole("renderSamples", smallest=1)
        params.comes("render.samples", "renderSamples")
    if params.has("lightPathesMaxBounces"):
        render["max_bounces"] = params.whole("lightPathesMaxBounces")
        params.comes("render.max_bounces", "lightPathesMaxBounces")
    return ["rgb", "depth"] if params.flag("renderDepthActive", True) else ["rgb"]


def _labels(channel: str, params: Node) -> list[str]:
    params.get("renderSamples")  # labels come from the pixels' centres, whatever it says
    return [channel]


def read(section: Node, effects: Node, scene: Scene) -> None:
    """Channels, in our order; object labels always."""
    section.child("GENERAL")
    render: dict[str, Any] = {}
    found: set[str] = set()
    given = section.children("RENDER_PASSES")
    for entry in given:
        kind = entry.text("type")
        params = entry.child("passParams")
        if kind not in PASSES:
            entry.leave(f"{kind}: has no counterpart here; it is not applied")
            params.skip()
            continue
        if kind != "SemanticPass" and params.whole("numIter", 1) > 1:
            params.ignore("numIter", "a frame is rendered once")
        params.get("numIter")  # SemanticPass: levels, of which `semantic` holds all
        params.ignore("imageFileType", "not applied: the writer chooses the type of its files")
        if kind == "RGBDPass":
            found.update(_rgbd(params, render))
        else:
            found.update(_labels("semantic" if kind == "SemanticPass" else "instance", params))
    if not given:  # then what the sensors ask for
        names = {"RGBDPass": ["rgb", "depth"], "SemanticPass": ["semantic"]}
        for kind in scene.passes:
            found.update(names.get(kind, ["instance"]))
    order = ("rgb", "depth", "semantic", "instance")
    render["channels"] = [name for name in order if name in found or not found] + ["objects"]
    scene.tree["render"] = render
    effects.child("GENERAL")
    for entry in effects.children("POST_EFFECTS"):
        kind = entry.text("type", "effect")
        entry.leave(f"{kind}: not applied: there are no effects after rendering yet")
