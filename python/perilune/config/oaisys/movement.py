"""SENSOR_SETUP.GENERAL: how the base of the sensors moves; one table of movement types."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from perilune.config.oaisys.node import Node
from perilune.config.oaisys.scene import Scene, Thing

Movement = Callable[[Node, Scene], dict[str, Any]]
_DEFAULT_RADII = 3.0
"""orbit_radius left out: so many radii of the target."""


def _distance_m(node: Node, scene: Scene, target: Thing) -> tuple[float, float]:
    """orbit_radius, give or take orbit_radius_noise, drawn uniformly."""
    if node.has("orbit_radius"):
        low, high = node.span("orbit_radius")
        noise = node.number("orbit_radius_noise", 0.0)
        low, high = scene.lengths_m([low - noise, high + noise])
        if not low > 0.0:
            node.fail("orbit_radius", "must be positive, and larger than orbit_radius_noise")
        return low, high
    middle = _DEFAULT_RADII * max(target.radii_m())
    noise = scene.metres_per_unit * node.number("orbit_radius_noise", 0.0)
    if not noise < middle:
        node.fail("orbit_radius_noise", f"must be less than the radius of {middle:g} m")
    text = f"left out: {_DEFAULT_RADII:g} times the radius of {target.name}, {middle:g} m"
    node.notes.warn(node.where("orbit_radius"), text)
    return middle - noise, middle + noise


def _roll_deg(node: Node) -> list[float]:
    """About the optical axis; OAISYS keeps its +z up in the image without it."""
    if node.has("randomTargetRollRad"):
        return [57.29577951308232 * angle for angle in node.span("randomTargetRollRad")]
    return list(node.span("randomTargetRollDeg", (0.0, 0.0)))


def _orbit_object(node: Node, scene: Scene) -> dict[str, Any]:
    target = scene.find(node, "orbit_mesh")
    distance = list(_distance_m(node, scene, target))
    roll = _roll_deg(node)
    return {
        "kind": "orbit_object",
        "target": target.name,
        "distance_m": distance,
        "roll_deg": roll,
    }


def _custom(node: Node, scene: Scene, params: Node, target: Thing) -> dict[str, Any]:
    """The user's function; what else the section holds is handed to it."""
    function = params.text("function")
    params.skip()
    rest = {key: value for key, value in params.raw.items() if key != "function"}
    return {"kind": "hook", "function": function, "params": rest}


_APPROACHES: dict[str, Callable[[Node, Scene, Node, Thing], dict[str, Any]]] = {
    "custom": _custom,
}


def _approach(node: Node, scene: Scene) -> dict[str, Any]:
    target = scene.find(node, "orbit_mesh")
    kind = node.choice("approach_moving_type", _APPROACHES)
    params = node.child("approach_moving_params")
    return _APPROACHES[kind](node, scene, params, target)


_MOVEMENTS: dict[str, Movement] = {
    "orbit_object": _orbit_object,
    "approach_trajectory": _approach,
}


def read(general: Node, scene: Scene) -> dict[str, Any]:
    """Our section `camera.trajectory`."""
    kind = general.choice("sensorMovementType", _MOVEMENTS)
    trajectory = _MOVEMENTS[kind](general, scene)
    general.comes("camera.trajectory")
    general.comes("camera.trajectory.kind", "sensorMovementType")
    general.comes("camera.trajectory.target", "orbit_mesh")
    general.comes("camera.trajectory.distance_m", "orbit_radius")
    if general.whole("stepInterval", 1, smallest=1) > 1:
        general.ignore("stepInterval", "not applied: the base moves at every step")
    return trajectory
