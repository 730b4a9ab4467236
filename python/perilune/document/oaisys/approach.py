"""sensorMovementType approach_trajectory: runs towards a target, one per batch."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from perilune.base import rotations
from perilune.document.oaisys.node import Node
from perilune.document.oaisys.scene import Scene

_PLANES: dict[str, dict[str, Any]] = {
    "xy": {"plane": "xy"},
    "yz": {"plane": "yz"},
    "zx": {"plane": "zx"},
    # The other way round: from the first axis to the second.
    "xz": {"normal": [0.0, -1.0, 0.0]},
    "yx": {"normal": [0.0, 0.0, -1.0], "start_angle_deg": -90.0},
    "zy": {"normal": [-1.0, 0.0, 0.0], "start_angle_deg": -90.0},
}


def _from_quaternion_deg(q: list[float]) -> list[float]:
    """Roll, pitch, yaw of a unit quaternion about the fixed axes x, y, z in this order."""
    m = rotations.to_matrix(np.array(q) / np.linalg.norm(q))
    pitch = math.asin(min(1.0, max(-1.0, -float(m[2, 0]))))
    if abs(m[2, 0]) < 1.0 - 1e-12:
        roll, yaw = math.atan2(m[2, 1], m[2, 2]), math.atan2(m[1, 0], m[0, 0])
    else:  # looking along the pole only roll and yaw together count
        roll, yaw = math.atan2(-m[1, 2], m[1, 1]), 0.0
    return [math.degrees(angle) for angle in (roll, pitch, yaw)]


def _pose(params: Node, key: str, scene: Scene) -> dict[str, Any]:
    """[x, y, z], looking at the target, or [x, y, z, qw, qx, qy, qz] of Blender's camera."""
    value = params.get(key)
    count = 7 if isinstance(value, list) and len(value) == 7 else 3
    numbers = params.numbers(key, count)
    pose: dict[str, Any] = {"position_m": scene.lengths_m(numbers[:3])}
    if count == 7:
        if not any(numbers[3:]):
            params.fail(key, "the quaternion [qw, qx, qy, qz] must not be zero")
        pose["rotation_deg"] = _from_quaternion_deg(numbers[3:])
    return pose


def _linear(node: Node, params: Node, scene: Scene) -> dict[str, Any]:
    """A straight line from start to end; only the ratio of the speeds matters over a batch."""
    found: dict[str, Any] = {
        "kind": "linear",
        "start": _pose(params, "start_pose", scene),
        "end": _pose(params, "end_pose", scene),
        "positions": scene.steps,
    }
    if "rotation_deg" in found["start"] or "rotation_deg" in found["end"]:
        found["camera_axes"] = "opengl"
    params.comes("camera.trajectory.start", "start_pose")
    params.comes("camera.trajectory.end", "end_pose")
    for ours, theirs in (("start_speed_m_s", "start_velocity"), ("end_speed_m_s", "end_velocity")):
        if params.has(theirs):
            found[ours] = scene.metres_per_unit * params.number(theirs)
            params.comes(f"camera.trajectory.{ours}", theirs)
    return found


def _spiral(node: Node, params: Node, scene: Scene) -> dict[str, Any]:
    """Around the target; r_start defaults to orbit_radius, r_end to a circle."""
    found: dict[str, Any] = {"kind": "spiral", "positions": scene.steps}
    if params.has("start_position"):
        found["start_m"] = scene.lengths_m(params.numbers("start_position", 3))
        params.comes("camera.trajectory.start_m", "start_position")
    else:
        owner, key = (params, "r_start") if params.has("r_start") else (node, "orbit_radius")
        found["r_start_m"] = scene.metres_per_unit * owner.number(key)
        owner.comes("camera.trajectory.r_start_m", key)
    if params.has("r_end"):
        found["r_end_m"] = scene.metres_per_unit * params.number("r_end")
        params.comes("camera.trajectory.r_end_m", "r_end")
    plane = params.choice("plane", _PLANES, "xy")
    found |= _PLANES[plane] if "start_m" not in found else _without_start(_PLANES[plane])
    found["rotations"] = params.number("rotations", 1.0)
    params.comes("camera.trajectory.rotations", "rotations")
    return found


def _without_start(plane: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in plane.items() if key != "start_angle_deg"}


def _custom(node: Node, params: Node, scene: Scene) -> dict[str, Any]:
    """The user's function; other keys of the section are passed to it."""
    function = params.text("function")
    params.skip()
    rest = {key: value for key, value in params.raw.items() if key != "function"}
    params.comes("camera.trajectory.hook", "function")
    return {"kind": "hook", "hook": function, "params": rest}


_KINDS: dict[str, Callable[[Node, Node, Scene], dict[str, Any]]] = {
    "linear": _linear,
    "spiral": _spiral,
    "custom": _custom,
}


def read(node: Node, scene: Scene) -> dict[str, Any]:
    """Perilune's section `camera.trajectory` from SENSOR_SETUP.GENERAL."""
    target = scene.find(node, "orbit_mesh")
    kind = node.choice("approach_moving_type", _KINDS)
    params = node.child("approach_moving_params")
    params.comes("camera.trajectory")
    found = _KINDS[kind](node, params, scene)
    node.get("orbit_radius")  # what r_start and the others replace
    noise = scene.metres_per_unit * node.number("orbit_radius_noise", 0.0)
    if kind == "spiral" and noise:
        found["distance_noise_m"] = noise
        node.comes("camera.trajectory.distance_noise_m", "orbit_radius_noise")
    elif noise:
        node.ignore("orbit_radius_noise", f"not applied: {kind} has no noise")
    return found if kind == "custom" else found | {"target": target.name}
