"""SENSOR_SETUP.GENERAL: motion of the sensors' base, in a table of movement types."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from perilune.document.oaisys import approach, files
from perilune.document.oaisys.node import Node, varying
from perilune.document.oaisys.scene import Entity, Scene

Movement = Callable[[Node, Scene], dict[str, Any]]
_DEFAULT_RADII = 3.0
"""Default of orbit_radius, in radii of the target."""
_UNUSED = ("hoverBase", "hoverTarget", "targetObject", "positionOffset")
"""Groups of keys, each switched on by one of its keys, that need terrain or move the target in
undocumented ways."""


def _distance(node: Node, scene: Scene, target: Entity) -> dict[str, Any]:
    """orbit_radius, and the noise added at every step."""
    noise = scene.metres_per_unit * node.number("orbit_radius_noise", 0.0)
    if node.has("orbit_radius"):
        low, high = scene.lengths_m(list(node.span("orbit_radius")))
    else:
        low = high = _DEFAULT_RADII * max(target.radii_m())
        text = f"left out: {_DEFAULT_RADII:g} times the radius of {target.name}, {low:g} m"
        node.notes.warn(node.where("orbit_radius"), text)
    if not low > 0.0:
        node.fail("orbit_radius", "must be positive")
    found: dict[str, Any] = {"distance_m": [low, high]}
    node.comes("camera.trajectory.distance_m", "orbit_radius")
    node.comes("camera.trajectory.distance_noise_m", "orbit_radius_noise")
    return found | ({"distance_noise_m": noise} if noise else {})


def _roll_deg(node: Node) -> list[float]:
    """Roll about the optical axis; without it OAISYS keeps its +z up in the image."""
    node.comes("camera.trajectory.roll_deg", "randomTargetRollDeg")
    if node.has("randomTargetRollRad"):
        return [math.degrees(angle) for angle in node.span("randomTargetRollRad")]
    return list(node.span("randomTargetRollDeg", (0.0, 0.0)))


def _orbit_object(node: Node, scene: Scene) -> dict[str, Any]:
    """Random positions on a sphere around the target, with which they move."""
    target = scene.find(node, "orbit_mesh")
    distance = _distance(node, scene, target)
    return {"kind": "orbit_object", "target": target.name, **distance, "roll_deg": _roll_deg(node)}


def _deterministic(node: Node, scene: Scene) -> dict[str, Any]:
    """Poses from a table, camera axes as OpenCV's; its first row is for the first sample."""
    node.comes("camera.trajectory.file", "sensorMovementPose")
    offset = node.numbers("deterministicSensorOffsetPos", 3, [0.0, 0.0, 0.0])
    if node.text("interpolationMode", "none") != "none":
        node.ignore("interpolationMode", "between rows the camera moves and turns evenly")
    file = node.text("sensorMovementPose")
    first = files.first_frame(file, scene.base)
    if first != 0:
        text = f"its first row is for frame {first}, which is our frame 0"
        node.notes.warn(node.where("sensorMovementPose"), text)
    return {
        "kind": "deterministic",
        "file": file,
        **({"first_frame": first} if first != 0 else {}),
        "metres_per_unit": scene.metres_per_unit,
        "offset_m": scene.lengths_m(offset),
    }


def _box(node: Node, scene: Scene, key: str, default: Any) -> tuple[list[float], list[float]]:
    low, high = (node.numbers(f"{key}{end}", 3, default) for end in ("Min", "Max"))
    return low, high


def _random_euclidean(node: Node, scene: Scene) -> dict[str, Any]:
    """A box of positions; Euler angles, radians, of a camera that looks along its -z."""
    low, high = _box(node, scene, "randomEuclideanPos", [0.0, 0.0, 0.0])
    turns = _box(node, scene, "randomEuclideanEuler", [0.0, 0.0, 0.0])
    rotation = [[math.degrees(angle) for angle in angles] for angles in turns]
    return {
        "kind": "random_box",
        "min_m": scene.lengths_m(low),
        "max_m": scene.lengths_m(high),
        "rotation_min_deg": rotation[0],
        "rotation_max_deg": rotation[1],
        "camera_axes": "opengl",
        "roll_deg": _roll_deg(node),
    }


def _random_euclidean_target(node: Node, scene: Scene) -> dict[str, Any]:
    """A box of positions, and a box of points to look at, which lies at each position."""
    low, high = _box(node, scene, "randomEuclideanPos", [0.0, 0.0, 0.0])
    near, far = _box(node, scene, "randomTargetPos", [0.0, 0.0, 0.0])
    for key in ("randomEuclideanEuler", "randomTargetEuler"):
        if any(any(end) for end in _box(node, scene, key, [0.0, 0.0, 0.0])):
            text = "not applied: the camera looks at a point"
            for end in ("Min", "Max"):
                node.ignore(f"{key}{end}", text)
    return {
        "kind": "random_box",
        "min_m": scene.lengths_m(low),
        "max_m": scene.lengths_m(high),
        "target_min_m": scene.lengths_m(near),
        "target_max_m": scene.lengths_m(far),
        "target_from": "camera",
        "roll_deg": _roll_deg(node),
    }


def _centered(node: Node, scene: Scene) -> dict[str, Any]:
    """A line to the target; distances are in radii of the target."""
    target = scene.find(node, "targetObject")
    found: dict[str, Any] = {"kind": "centred_target", "target": target.name}
    if node.has("sensorDistanceScale"):
        found["distance_scale"] = varying(node.span("sensorDistanceScale"))
        node.comes("camera.trajectory.distance_scale", "sensorDistanceScale")
    final = node.number("finalApproachDistance", 1.05)
    if node.flag("landingMode", False):
        if not final > 1.0:
            text = f"must be more than 1 radius of {target.name} from its centre, not {final:g}"
            node.fail("finalApproachDistance", text)
        found |= {
            "landing": True,
            "final_distance_m": (final - 1.0) * max(target.radii_m()),
            "positions": scene.steps,
        }
        node.comes("camera.trajectory.final_distance_m", "finalApproachDistance")
    return found | {"roll_deg": _roll_deg(node)}


_MOVEMENTS: dict[str, Movement] = {
    "orbit_object": _orbit_object,
    "approach_trajectory": approach.read,
    "deterministic": _deterministic,
    "randomEuclidean": _random_euclidean,
    "randomEuclideanTarget": _random_euclidean_target,
    "centeredTarget": _centered,
}


def _groups(general: Node) -> None:
    """Warns of groups of keys that are switched on; ignores the others."""
    for group in _UNUSED:
        keys = [key for key in general.raw if key.startswith(group)]
        switch = next((key for key in keys if key.endswith(("Enabled", "Active"))), None)
        on = switch is not None and general.flag(switch, False)
        for key in keys:
            if on:
                general.ignore(key, "not applied: there is no terrain, and no object to look at")
            else:
                general.get(key)
    general.get("tragetObjectMovementType")  # (sic); goes with targetObjectActive


def read(general: Node, scene: Scene) -> dict[str, Any]:
    """Perilune's section `camera.trajectory`."""
    kind = general.choice("sensorMovementType", _MOVEMENTS)
    general.comes("camera.trajectory")
    general.comes("camera.trajectory.kind", "sensorMovementType")
    target = "targetObject" if kind == "centeredTarget" else "orbit_mesh"
    general.comes("camera.trajectory.target", target)
    trajectory = _MOVEMENTS[kind](general, scene)
    interval = general.whole("stepInterval", 1, smallest=1)
    if interval > 1 and trajectory["kind"] in ("orbit_object", "random_box"):
        trajectory["interval"] = interval
    elif interval > 1:
        general.ignore("stepInterval", "not applied: the base moves at every step")
    _groups(general)
    return trajectory
