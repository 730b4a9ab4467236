"""RENDER_SETUP: passes become channels. RENDER_POST_PROCESSING_EFFECTS_SETUP: bloom becomes
glare."""

from __future__ import annotations

from typing import Any

from perilune.document.oaisys.node import Node
from perilune.document.oaisys.scene import Scene

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
    """Channels in our order, always with object labels."""
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
    effects.child("GENERAL").get("renderPasses")
    for entry in effects.children("POST_EFFECTS"):
        kind = entry.text("type", "effect")
        if kind == "BloomEffect" and "sensor" not in scene.tree["camera"]:
            _bloom(entry, scene)
        elif kind == "CombineEffect":
            entry.skip()  # it puts passes together, which channels are
        else:
            entry.leave(f"{kind}: has no counterpart here; it is not applied")


_ELECTRONS = 1e7
"""Full-well capacity with which noise is invisible."""
_WINGS = 0.03
"""Fraction of light that Blender's strongest mix spreads, as in the worst lenses."""


def _bloom(entry: Node, scene: Scene) -> None:
    """Wings of a point-spread function, for a sensor without noise: the channel sensor_rgb."""
    mix = entry.number("mix", 0.0)
    size = entry.number("size", 8.0)
    if not -1.0 <= mix <= 1.0:
        entry.fail("mix", f"must be from -1 to 1, not {mix:g}")
    if not 0.0 <= size <= 16.0:
        entry.fail("size", f"must be from 0 to 16, not {size:g}")
    entry.get("quality")
    entry.ignore("threshold", "not applied: a lens spreads all light, not the brightest alone")
    point_spread: dict[str, Any] = {"core": "point"}
    if mix > -1.0:
        point_spread |= {"wings": 0.5 * _WINGS * (1.0 + mix), "wing_radius_px": 2.0 ** (size - 7.0)}
    quiet = ("prnu", "dark_current_e_s", "read_noise_e", "vignetting")
    scene.tree["camera"]["sensor"] = {
        **dict.fromkeys(quiet, 0.0),
        "full_well_e": _ELECTRONS,
        "gain_e_dn": _ELECTRONS / 4000.0,
        "exposure": {"max_ms": 1e12},
        "point_spread": point_spread,
    }
    for ours, theirs in (("wings", "mix"), ("wing_radius_px", "size")):
        entry.comes(f"camera.sensor.point_spread.{ours}", theirs)
    channels = scene.tree["render"]["channels"]
    if "rgb" in channels:
        channels.insert(channels.index("rgb") + 1, "sensor_rgb")
    entry.notes.warn(
        entry.path,
        "BloomEffect: the glare of a lens, in the channel sensor_rgb, which exposes itself and has "
        "a mosaic of colour filters; rgb is clean",
    )
