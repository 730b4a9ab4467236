"""Common parts of trajectories: axes at a target, viewing direction, noise, clearance."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.config.trajectory import Aimed, Pointing
from perilune.config.trajectory.common import CameraAxes, Frame
from perilune.world import World

F64 = NDArray[np.float64]

IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])
_FROM_OPENGL = np.array([0.0, 1.0, 0.0, 0.0])
"""Half a turn about x, which converts a camera with y up, z backward."""


def refuse(world: World, text: str) -> NoReturn:
    """Error for a trajectory that cannot be followed in this frame."""
    raise ValueError(f"camera.trajectory: frame {world.index}: {text}")


def orbit_axes(world: World, name: str, frame: Frame, when: int) -> F64:
    """The axes rsw or lvlh of an object's orbit as columns, in the root frame."""
    position, velocity = world.orbital_state(name, when)
    normal = rotations.cross(position, velocity)
    size, distance = rotations.norm(normal), rotations.norm(position)
    if not size > 1e-12 * (distance * rotations.norm(velocity)):
        refuse(world, f"frame: {frame}: {name} moves in no plane, it stands or falls straight")
    outward, normal = position / distance, normal / size
    forward = rotations.cross(normal, outward)
    columns = (outward, forward, normal) if frame == "rsw" else (forward, -normal, -outward)
    return np.column_stack(columns)


def axes(world: World, name: str | None, frame: Frame, when: int) -> F64:
    """Quaternion from the axes of `frame` at an object to the root's; None is the root frame."""
    if name is None or frame == "icrf":
        return IDENTITY
    if frame == "target":
        return np.asarray(world.poses[name][when, 3:])
    return rotations.from_matrix(orbit_axes(world, name, frame, when))


def origin(world: World, name: str | None, when: int) -> F64:
    """Centre of an object, or of the root frame."""
    return np.zeros(3) if name is None else np.asarray(world.poses[name][when, :3])


def camera_turn(q: F64, camera_axes: CameraAxes) -> F64:
    """Converts a given rotation to that of a camera with x right, y down, z forward."""
    return rotations.multiply(q, _FROM_OPENGL) if camera_axes == "opengl" else q


def look(world: World, place: F64, aim: F64, up: F64) -> F64:
    """Rotation of a camera at a position that looks at a point, in any axes; the two must
    differ."""
    forward = aim - place
    if not rotations.norm(forward) > 0.0:
        refuse(world, "the camera is at the point that it looks at")
    return rotations.look_at(forward, up)


def noise(world: World, spec: Pointing) -> list[F64]:
    """The step's aim jitter, roll and pointing noise as successive rotations, constant during the
    exposure."""
    rng = world.brief_random("camera.aim")
    low, high = spec.roll_deg
    roll = math.radians(low + (high - low) * float(rng.random()))
    right, down = math.radians(spec.aim_jitter_deg) * rng.standard_normal(2)
    jitter = (((0, 1, 0), float(right)), ((1, 0, 0), float(down)), ((0, 0, 1), roll))
    turns = [rotations.axis_angle(axis, angle) for axis, angle in jitter]
    if spec.pointing_noise_deg > 0.0:
        deviation = math.radians(spec.pointing_noise_deg)
        error = deviation * world.brief_random("camera.pointing").standard_normal(3)
        angle = rotations.norm(error)
        turns.append(rotations.axis_angle(error / angle, angle))
    return turns


def noisy(q: F64, turns: list[F64]) -> F64:
    """A view with its noise."""
    for turn in turns:
        q = rotations.multiply(q, turn)
    return q


def unclear(world: World, place: F64, clearance_m: float | None, when: int) -> str | None:
    """The object that a camera at a position would be too close to, as a message; None if clear."""
    body = world.inside(place, 0.0, when)
    if body is not None:
        depth = world.depth_m(body, place, when)
        if depth is not None:
            return f"the camera is {depth:.4g} m below the ground of {body}"
        return f"the camera is inside {body}"
    if clearance_m is None:
        return None
    body = world.inside(place, clearance_m, when)
    if body is not None:
        return f"the camera is within clearance_m of {body}"
    for name, radius in world.craft_radius_m.items():
        distance = rotations.norm(place - world.poses[name][when, :3])
        if distance <= radius + clearance_m:
            return (
                f"the camera is within clearance_m of {name} "
                f"(bounding sphere of radius {radius:.4g} m)"
            )
    return None


def finished(world: World, spec: Pointing, views: Callable[[int], tuple[F64, F64]]) -> F64:
    """Poses (2, 7) from positions and views at opening (0) and closing (1), with the step's noise.

    Refuses a position that is not clear, and states its distance."""
    poses, turns = [], noise(world, spec)
    for when in range(1 if world.window_s == 0.0 else 2):
        place, q = views(when)
        fault = unclear(world, place, spec.clearance_m, when)
        if fault is not None:
            target = getattr(spec, "target", None)
            told = ""
            if target is not None:
                distance = float(np.linalg.norm(place - world.poses[target][when, :3]))
                told = f"; it is {distance:.6g} m from the centre of {target}"
            limit = spec.clearance_m
            refuse(world, f"{fault}{told} (clearance_m: {'null' if limit is None else limit})")
        poses.append(np.concatenate([place, noisy(q, turns)]))
    return np.array([poses[0], poses[-1]])


def aimed(world: World, spec: Aimed, place_of: Callable[[int], F64]) -> F64:
    """Poses (2, 7) at positions in the axes of the target, looking at it."""

    def view(when: int) -> tuple[F64, F64]:
        q = axes(world, spec.target, spec.frame, when)
        place = place_of(when)
        turn = look(world, place, np.array(spec.aim_offset_m), np.array(spec.up))
        where = origin(world, spec.target, when) + rotations.rotate(q, place)
        return where, rotations.multiply(q, turn)

    return finished(world, spec, view)


def distance_noise_m(world: World, noise_m: float) -> float:
    """The step's deviation of a distance, uniform within plus and minus `noise_m`."""
    if noise_m == 0.0:
        return 0.0
    return float(world.brief_random("camera.distance").uniform(-noise_m, noise_m))


def uniform(rng: np.random.Generator, limits: tuple[float, float]) -> float:
    """Uniform between two limits."""
    low, high = limits
    return low + (high - low) * float(rng.random())
