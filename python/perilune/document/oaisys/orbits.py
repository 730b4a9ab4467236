"""orbit_params: the kinds of orbit of MeshSatelliteObject."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from perilune.document.oaisys.node import Node, varying
from perilune.document.oaisys.scene import Entity, Scene
from perilune.document.oaisys.units import EARTH_M, synchronous_radius_m

_CLASSES = ("LEO", "MEO", "GEO", "PO", "SSO", "LLO")
"""Classes of our database that a circle can represent."""


def _circular(node: Node, scene: Scene, parent: Entity) -> dict[str, Any]:
    """A path in radii of the central body; the file has scene units."""
    scale = node.numbers("scale", 3)
    if not min(scale) > 0.0:
        node.fail("scale", f"must be positive, not {scale}")
    ours = [m / r for m, r in zip(scene.lengths_m(scale), parent.radii_m(), strict=True)]
    turn = node.numbers("rotation_deg", 3, [0.0, 0.0, 0.0])
    start = varying(node.span("orbit_start", (0.0, 0.0)))
    return {"kind": "circular", "scale": ours, "rotation_deg": turn, "orbit_start": start}


def _database(node: Node, scene: Scene, parent: Entity) -> dict[str, Any]:
    """A class of orbits, drawn once a scene and traversed at v_step."""
    kind = node.choice("orbit_type", _CLASSES)
    if kind == "GEO":
        return _stationary(node, parent)
    return {
        "kind": "database",
        "class": kind,
        "propagator": "circular",
        "orbit_start": list(node.span("orbit_start", (0.0, 1.0))),
    }


def _stationary(node: Node, parent: Entity) -> dict[str, Any]:
    """A circle above the equator of the central body as rotated here, which our database with its
    equators of the table lacks; around unknown bodies at 6.6 radii, as for the Earth."""
    radii = parent.radii_m()
    if parent.table is not None:
        distance = synchronous_radius_m(parent.table)
    else:
        distance = synchronous_radius_m("earth") / EARTH_M * max(radii)
    return {
        "kind": "circular",
        "scale": [distance / radius for radius in radii],
        "rotation_deg": parent.rotation_deg,
        "orbit_start": varying(node.span("orbit_start", (0.0, 1.0))),
    }


def _custom(node: Node, scene: Scene, parent: Entity) -> dict[str, Any]:
    """The user's function, as in the paper's second listing."""
    params = node.child("params")
    params.skip()
    return {
        "kind": "hook",
        "hook": node.text("function"),
        "params": dict(params.raw),
        "propagator": "circular",
        "orbit_start": list(node.span("orbit_start", (0.0, 1.0))),
    }


_KINDS: dict[str, Callable[[Node, Scene, Entity], dict[str, Any]]] = {
    "circular": _circular,
    "orbit_database": _database,
    "custom": _custom,
}


def read(node: Node, scene: Scene, ours: str) -> dict[str, Any]:
    """Perilune's section `orbit`; `ours` is its key path."""
    kind = node.choice("type", _KINDS)
    parent = scene.find(node, "parent")
    orbit = {"around": parent.name, **_KINDS[kind](node, scene, parent)}
    orbit["v_step"] = node.number("v_step", 0.0)
    node.comes(ours)
    for key in ("scale", "rotation_deg", "orbit_start", "v_step", "params"):
        node.comes(f"{ours}.{key}", key)
    node.comes(f"{ours}.hook", "function")
    node.comes(f"{ours}.around", "parent")
    node.comes(f"{ours}.class", "orbit_type")
    return orbit
