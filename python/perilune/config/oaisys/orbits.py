"""orbit_params: the kinds of orbit of MeshSatelliteObject."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from perilune.config.oaisys.node import Node, varying
from perilune.config.oaisys.scene import Scene, Thing

_CLASSES = ("LEO", "MEO", "GEO", "PO", "SSO", "MOLNIYA", "GTO", "LLO", "NRHO")


def _circular(node: Node, scene: Scene, parent: Thing) -> dict[str, Any]:
    """The path in radii of the parent; the file has it in scene units."""
    scale = node.numbers("scale", 3)
    if not min(scale) > 0.0:
        node.fail("scale", f"must be positive, not {scale}")
    ours = [m / r for m, r in zip(scene.lengths_m(scale), parent.radii_m(), strict=True)]
    turn = node.numbers("rotation_deg", 3, [0.0, 0.0, 0.0])
    start = varying(node.span("orbit_start", (0.0, 0.0)))
    return {"kind": "circular", "scale": ours, "rotation_deg": turn, "orbit_start": start}


def _database(node: Node, scene: Scene, parent: Thing) -> dict[str, Any]:
    """A class of orbits, drawn once a scene and run through at v_step."""
    return {
        "kind": "database",
        "class": node.choice("orbit_type", _CLASSES),
        "propagator": "circular",
        "orbit_start": list(node.span("orbit_start", (0.0, 1.0))),
    }


def _custom(node: Node, scene: Scene, parent: Thing) -> dict[str, Any]:
    """The user's function, as in the paper's second listing."""
    return {
        "kind": "hook",
        "function": node.text("function"),
        "params": dict(node.get("params", {})),
        "propagator": "circular",
        "orbit_start": list(node.span("orbit_start", (0.0, 1.0))),
    }


_KINDS: dict[str, Callable[[Node, Scene, Thing], dict[str, Any]]] = {
    "circular": _circular,
    "orbit_database": _database,
    "custom": _custom,
}


def read(node: Node, scene: Scene, ours: str) -> dict[str, Any]:
    """Our section `orbit`, whose key path is `ours`."""
    kind = node.choice("type", _KINDS)
    parent = scene.find(node, "parent")
    orbit = {"around": parent.name, **_KINDS[kind](node, scene, parent)}
    orbit["v_step"] = node.number("v_step", 0.0)
    node.comes(ours)
    for key in ("scale", "rotation_deg", "orbit_start", "v_step", "function", "params"):
        node.comes(f"{ours}.{key}", key)
    node.comes(f"{ours}.around", "parent")
    node.comes(f"{ours}.class", "orbit_type")
    return orbit
