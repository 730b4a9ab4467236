"""Moving parts of models: joints and animations of the configuration, posed by the core."""

from __future__ import annotations

import fnmatch
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import rotations
from perilune.config.articulation import Animation, Joint
from perilune.config.errors import ConfigError, nearest
from perilune.config.spacecraft import Spacecraft
from perilune.world import World

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Rig:
    """Moving parts of a spacecraft; the same in all frames."""

    core: _core.Articulation
    nodes: tuple[str, ...]
    """Names of the moving nodes, unique, in the core's order."""
    joints: tuple[int, ...]
    """Index in `nodes` of each joint of the configuration."""
    offset: F64
    """Offset of the model: p_object = scale * (p_model - offset)."""
    reach_units: float
    """Bound on the distance of any part from the offset under rotations and animations;
    translations add to it."""


def rig(model: _core.Model, craft: Spacecraft, offset: F64, scale: float, where: str) -> Rig | None:
    """The rig of a spacecraft; None if nothing on it moves.

    scale: metres per model unit at the ideal size. where: file and key of the spacecraft, for
    errors."""
    if not craft.articulation and craft.animation is None:
        return None
    joints = [
        _joint(model, joint, offset, scale, f"{where}.articulation[{i}]")
        for i, joint in enumerate(craft.articulation)
    ]
    animations: list[int] = []
    if craft.animation is not None:
        animations = _find_animations(model, craft.animation, f"{where}.animation")
    try:
        core = _core.Articulation(model, joints, np.array(animations, dtype=np.int32))
    except ValueError as error:
        raise ConfigError(f"{where}.articulation: {error}") from None
    order = list(core.nodes)
    return Rig(
        core=core,
        nodes=tuple(_unique_name(model, node) for node in order),
        joints=tuple(order.index(joint["node"]) for joint in joints),
        offset=offset,
        reach_units=_reach_units(
            model, core, [joint["node"] for joint in joints], offset, animations
        ),
    )


def _unique_name(model: _core.Model, node: int) -> str:
    """A node's name, with its index in the file where another node has the same."""
    names = [row["name"] for row in model.nodes]
    return names[node] if names.count(names[node]) == 1 else f"{names[node]}#{node}"


def _joint(
    model: _core.Model, joint: Joint, offset: F64, scale: float, where: str
) -> dict[str, Any]:
    pivot = np.array(joint.pivot_m) / scale
    own = joint.axes == "node"
    return {
        "node": _find_node(model, joint.node, f"{where}.node"),
        "kind": joint.kind,
        "axis": joint.axis,
        "pivot": pivot if own else pivot + offset,
        "normal": joint.normal or (0.0, 0.0, 0.0),
        "in_node_axes": own,
    }


def _find_node(model: _core.Model, pattern: str, where: str) -> int:
    names = [row["name"] for row in model.nodes]
    found = [i for i, name in enumerate(names) if fnmatch.fnmatchcase(name, pattern)]
    if not found:
        raise ConfigError(f"{where}: no node matches '{pattern}'{nearest(pattern, names)}")
    if len(found) > 1:
        shown = ", ".join(names[i] for i in found[:8]) + (", ..." if len(found) > 8 else "")
        raise ConfigError(
            f"{where}: '{pattern}' matches {len(found)} nodes, must match one: {shown}"
        )
    return found[0]


def _find_animations(model: _core.Model, wanted: Animation, where: str) -> list[int]:
    names = [row["name"] for row in model.animations]
    if wanted.index is not None:
        if wanted.index >= len(names):
            raise ConfigError(
                f"{where}.index = {wanted.index}: the model has {len(names)}: {', '.join(names)}"
            )
        return [wanted.index]
    assert wanted.name is not None  # the schema asks for one of the two
    found = [i for i, name in enumerate(names) if fnmatch.fnmatchcase(name, wanted.name)]
    if not found:
        hint = nearest(wanted.name, names)
        raise ConfigError(f"{where}.name: no animation matches '{wanted.name}'{hint}")
    return found


def _reach_units(
    model: _core.Model,
    core: _core.Articulation,
    joint_nodes: Sequence[int],
    offset: F64,
    animations: Sequence[int],
) -> float:
    """Largest distance of any part from the offset at all angles, without translations."""
    reach = math.hypot(*np.abs(model.bounds - offset).max(axis=0))
    if animations:
        duration_s = max(model.animations[i]["duration_s"] for i in animations)
        return _animated_reach(model, core, offset, duration_s, reach)
    for node in core.nodes:
        centre, radius = _swept_sphere(model, core, joint_nodes, node)
        reach = max(reach, float(np.linalg.norm(centre - offset)) + radius)
    return reach


def _animated_reach(
    model: _core.Model, core: _core.Articulation, offset: F64, duration_s: float, reach: float
) -> float:
    """A loose bound: each moving node carries the bounding box of the whole model, at 33 instants
    of the animations, and a rotation moves a point away by at most twice the distance of its
    axis."""
    low, high = model.bounds
    corners = np.array(np.meshgrid(*zip(low, high, strict=True), indexing="ij")).reshape(3, 8).T
    still = np.zeros(len(core.axes))
    for play_s in np.linspace(0.0, duration_s, 33):
        _, motions = core.pose(still, np.zeros((len(still), 3)), float(play_s), "clamp")
        moved = corners @ motions[:, :, :3].transpose(0, 2, 1) + motions[:, None, :, 3]
        reach = max(reach, float(np.linalg.norm(moved - offset, axis=2).max()))
    for axis, pivot in core.axes:
        away = pivot - offset
        reach += 2.0 * float(np.linalg.norm(away - (away @ axis) * axis))
    return reach


def _swept_sphere(
    model: _core.Model, core: _core.Articulation, joint_nodes: Sequence[int], node: int
) -> tuple[F64, float]:
    """A sphere that contains everything below a moving node at all angles of all joints: each
    joint, from the node's last upwards, moves the centre onto its axis."""
    parents = [row["parent"] for row in model.nodes]
    mesh = model.mesh()
    below = [_is_below(parents, part["node"], node) for part in model.parts]
    used = np.unique(mesh["indices"][np.array(below)[mesh["triangle_part"]]])
    points = mesh["positions"][used].astype(np.float64)
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    radius = float(np.linalg.norm(points - centre, axis=1).max())
    while node >= 0:
        for i in reversed(range(len(joint_nodes))):
            if joint_nodes[i] == node:
                axis, pivot = core.axes[i]
                on_axis = pivot + ((centre - pivot) @ axis) * axis
                radius += float(np.linalg.norm(centre - on_axis))
                centre = on_axis
        node = parents[node]
    return centre, radius


def _is_below(parents: Sequence[int], node: int, above: int) -> bool:
    while node >= 0 and node != above:
        node = parents[node]
    return node >= 0


def moving_above(model: _core.Model, rigs: Iterable[Rig]) -> list[tuple[str, ...]]:
    """For each part of a model, the nodes above it that any of its rigs moves, nearest first."""
    names = {n: name for rig in rigs for n, name in zip(rig.core.nodes, rig.nodes, strict=True)}
    parents = [row["parent"] for row in model.nodes]
    chains = []
    for part in model.parts:
        node, chain = part["node"], []
        while node >= 0:
            if node in names:
                chain.append(names[node])
            node = parents[node]
        chains.append(tuple(chain))
    return chains


@dataclass(frozen=True)
class Posed:
    """A rig in one frame."""

    motions: F64
    """(nodes, 3, 4): motions in the core's form, model units."""
    meta: dict[str, dict[str, Any]]
    """The spacecraft's entry in a sample's `meta["articulation"]`."""


def posed(rig: Rig, scene: World, name: str, scale: float) -> Posed:
    """The moving nodes of spacecraft `name` in the middle of the exposure."""
    craft = scene.config.spacecraft[name]
    t_s = scene.t_s + 0.5 * scene.window_s
    values = [_value(joint, t_s, scale) for joint in craft.articulation]
    targets = [_target(joint, scene, name) for joint in craft.articulation]
    play = craft.animation
    reached, motions = rig.core.pose(
        np.array(values, dtype=np.float64),
        np.array(targets, dtype=np.float64).reshape(-1, 3) / scale + rig.offset,
        play.start_s + play.speed * t_s if play is not None else 0.0,
        play.loop if play is not None else "clamp",
    )
    return Posed(motions, _meta(rig, craft.articulation, reached, motions, scale))


def _value(joint: Joint, t_s: float, scale: float) -> float:
    if joint.translation_m is not None:
        return joint.translation_m / scale
    # A turn in degrees keeps its digits better when whole turns are taken out of the rate's part.
    grown = math.fmod((joint.rate_deg_s or 0.0) * t_s, 360.0)
    return math.radians((joint.angle_deg or 0.0) + grown)


def _middle(poses: F64) -> tuple[F64, F64]:
    """Position and rotation in the middle of the exposure."""
    return 0.5 * (poses[0, :3] + poses[1, :3]), rotations.middle(poses[0, 3:], poses[1, 3:])


def _target(joint: Joint, scene: World, name: str) -> F64:
    """Position of the target in the object's frame, m; the origin without a target."""
    if joint.towards is None:
        return np.zeros(3)
    place, turn = _middle(scene.poses[name])
    sun = joint.towards == "sun" and "sun" not in scene.poses
    target = scene.sun_position_m if sun else _middle(scene.poses[joint.towards])[0]
    return rotations.rotate_back(turn, target - place)


def in_object_frame(motions: F64, offset: F64, scale: float) -> list[F64]:
    """Motions (nodes, 3, 4) of the model, in its units, as (4, 4) in the object's frame, m."""
    matrices = []
    for motion in motions:
        matrix = np.eye(4)
        matrix[:3, :3] = motion[:, :3]
        matrix[:3, 3] = scale * (motion[:, :3] @ offset + motion[:, 3] - offset)
        matrices.append(matrix)
    return matrices


def _meta(
    rig: Rig, joints: Sequence[Joint], reached: F64, motions: F64, scale: float
) -> dict[str, dict[str, Any]]:
    meta: dict[str, dict[str, Any]] = {}
    matrices = in_object_frame(motions, rig.offset, scale)
    for node, matrix in zip(rig.nodes, matrices, strict=True):
        meta[node] = {"motion": matrix, "joints": []}
    for joint, k, value in zip(joints, rig.joints, reached, strict=True):
        slides = joint.kind == "slide"
        row = {"translation_m": value * scale} if slides else {"angle_deg": math.degrees(value)}
        meta[rig.nodes[k]]["joints"].append({key: float(v) for key, v in row.items()})
    return meta


def slides_m(craft: Spacecraft) -> float:
    """Largest displacement of a part by all translations of a spacecraft together."""
    return sum(abs(joint.translation_m or 0.0) for joint in craft.articulation)


def stacked(poses: Mapping[str, Posed]) -> F64:
    """(all moving nodes, 3, 4): motions for the core's request."""
    return np.concatenate([np.empty((0, 3, 4)), *(row.motions for row in poses.values())])
