"""Camera poses: one function a kind of trajectory, and the user's hooks.

A trajectory takes the world of a frame and returns camera-to-root poses (2, 7), at the opening and
the closing of the shutter. To add a kind: its section in config/camera.py, its function here, its
line in TRAJECTORIES.
"""

from __future__ import annotations

import importlib
import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import rotations
from perilune.config.camera import Fixed, Hook, OrbitObject
from perilune.config.sensors import Mounting, Sensor
from perilune.world import World

F64 = NDArray[np.float64]
Trajectory = Callable[[World], F64]

_TRIES = 2000
_REACH_M = 1e18  # as in the core: beyond, squares of float coordinates overflow
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class _Band:
    """Directions whose angle to a unit axis lies between two limits."""

    axis: F64
    low_rad: float
    high_rad: float

    @property
    def solid_angle(self) -> float:
        return 2.0 * math.pi * (math.cos(self.low_rad) - math.cos(self.high_rad))

    def sample(self, rng: np.random.Generator) -> F64:
        """Uniform over the band; a band of no width is a circle."""
        u, v = rng.random(2)
        low, high = math.cos(self.low_rad), math.cos(self.high_rad)
        z = low + (high - low) * u
        radius, angle = math.sqrt(max(0.0, 1.0 - z * z)), 2.0 * math.pi * v
        x_axis = rotations.cross(self.axis, np.eye(3)[int(np.argmin(np.abs(self.axis)))])
        x_axis /= np.linalg.norm(x_axis)
        y_axis = rotations.cross(self.axis, x_axis)
        sides = math.cos(angle) * x_axis + math.sin(angle) * y_axis
        return np.asarray(radius * sides + z * self.axis)

    def holds(self, direction: F64) -> bool:
        angle = rotations.angle_rad(self.axis, direction)
        return self.low_rad - 1e-9 <= angle <= self.high_rad + 1e-9


def _unit(v: F64) -> F64:
    return np.asarray(v / np.linalg.norm(v))


def _bands(world: World, spec: OrbitObject) -> dict[str, _Band]:
    """The limits on the direction target -> camera, by the key that sets them."""
    target = world.position_m(spec.target)
    bands = {"any direction": _Band(_UP, 0.0, math.pi)}
    if spec.sun_angle_deg is not None:
        low, high = (math.radians(angle) for angle in spec.sun_angle_deg)
        bands["sun_angle_deg"] = _Band(_unit(world.sun_position_m - target), low, high)
    if spec.cone_angle_deg is not None:
        low, high = (math.radians(angle) for angle in spec.cone_angle_deg)
        axis = rotations.rotate(world.poses[spec.target][0, 3:], np.array(spec.cone_axis))
        bands["cone_angle_deg"] = _Band(_unit(axis), low, high)
    if spec.background is not None:
        to_body = world.position_m(spec.background) - target
        distance = float(np.linalg.norm(to_body))
        radius = world.radius_m(spec.background)
        half = math.asin(radius / distance) if radius < distance else math.pi
        bands["background"] = _Band(_unit(-to_body) if distance > 0.0 else _UP, 0.0, half)
    return bands


def _fault(world: World, spec: OrbitObject, direction: F64, camera: F64, shift: F64) -> str | None:
    """Why a camera cannot be there; None when it can."""
    target = world.position_m(spec.target)
    if spec.background is not None and world.hit_m(spec.background, target, -direction) is None:
        return f"{spec.background} is not behind the target"
    for when, place in enumerate((camera, camera + shift)):
        body = world.inside(place, spec.clearance_m, when)
        if body is not None:
            return f"the camera is in {body}, or within clearance_m of it"
        for name, radius in world.craft_radius_m.items():
            distance = float(np.linalg.norm(place - world.poses[name][when, :3]))
            if distance <= radius + spec.clearance_m:
                return (
                    f"the camera is within clearance_m of {name} "
                    f"(bounding sphere of radius {radius:.4g} m)"
                )
    length = float(np.linalg.norm(target - camera))
    for name in world.body_radii_m:
        if name != spec.target:
            hit = world.hit_m(name, camera, -direction)
            if hit is not None and hit < length:
                return f"{name} hides the target"
    return None


def _no_pose(world: World, spec: OrbitObject, faults: Counter[str]) -> ValueError:
    why = "; ".join(f"{count} times: {fault}" for fault, count in faults.most_common())
    text = f"camera.trajectory: frame {world.index}: no camera pose in {_TRIES} tries ({why})"
    bands = _bands(world, spec)
    if "background" in bands and "sun_angle_deg" in bands:
        behind, sun = bands["background"], bands["sun_angle_deg"]
        middle = rotations.angle_rad(behind.axis, sun.axis)
        low = math.degrees(max(0.0, middle - behind.high_rad))
        high = math.degrees(min(math.pi, middle + behind.high_rad))
        text += (
            f". With {spec.background} behind the target, sun angles of {low:.1f} to {high:.1f} "
            "deg are possible in this frame"
        )
    return ValueError(text)


def _place(world: World, spec: OrbitObject) -> F64:
    """From the target to the camera: directions from the narrowest limit until all are met."""
    bands = _bands(world, spec)
    narrowest = min(bands, key=lambda key: bands[key].solid_angle)
    others = {key: band for key, band in bands.items() if key not in (narrowest, "background")}
    rng = world.random("camera.place")
    target = world.poses[spec.target]
    shift = target[1, :3] - target[0, :3]
    low, high = spec.distance_m
    faults: Counter[str] = Counter()
    for _ in range(_TRIES):
        direction = bands[narrowest].sample(rng)
        distance = low + (high - low) * float(rng.random())
        missed = next((key for key, band in others.items() if not band.holds(direction)), None)
        fault = f"{missed} is not met" if missed else None
        if fault is None:
            camera = target[0, :3] + distance * direction
            fault = _fault(world, spec, direction, camera, shift)
        if fault is None:
            return distance * direction
        faults[fault] += 1
    raise _no_pose(world, spec, faults)


def orbit_object(world: World) -> F64:
    """Random places around a target within the stated limits, looking at it.

    The camera keeps its place relative to the target's centre, and its axes in the root frame,
    while the shutter is open.
    """
    spec = world.camera.trajectory
    assert isinstance(spec, OrbitObject)
    offset = _place(world.shared, spec)
    rng = world.random("camera.aim")
    low, high = spec.roll_deg
    roll = math.radians(low + (high - low) * float(rng.random()))
    right, down = math.radians(spec.aim_jitter_deg) * rng.standard_normal(2)
    q = rotations.look_at(-offset, _UP)
    for axis, angle in (((0, 1, 0), right), ((1, 0, 0), down), ((0, 0, 1), roll)):
        q = rotations.multiply(q, rotations.axis_angle(axis, float(angle)))
    return np.stack([np.concatenate([pose[:3] + offset, q]) for pose in world.poses[spec.target]])


def fixed(world: World) -> F64:
    """A fixed place relative to a target, in ICRF axes or in the target's own."""
    spec = world.camera.trajectory
    assert isinstance(spec, Fixed)
    poses = []
    for target in world.poses[spec.target]:
        axes = target[3:] if spec.frame == "target" else np.array([1.0, 0.0, 0.0, 0.0])
        place = np.array(spec.position_m)
        aim = np.array(spec.aim_offset_m) - place
        if not np.linalg.norm(aim) > 0.0:
            raise ValueError("camera.trajectory: position_m is the point that is looked at")
        q = rotations.multiply(axes, rotations.look_at(aim, np.array(spec.up)))
        q = rotations.multiply(q, rotations.axis_angle((0, 0, 1), math.radians(spec.roll_deg)))
        poses.append(np.concatenate([target[:3] + rotations.rotate(axes, place), q]))
    return np.stack(poses)


def _load(name: str) -> Callable[..., Any]:
    module, _, path = name.partition(":")
    try:
        value: Any = importlib.import_module(module)
        for part in path.split("."):
            value = getattr(value, part)
    except (ImportError, AttributeError) as error:
        text = f"camera.trajectory.function = '{name}': {error}"
        raise ValueError(f"{text} (its module must be importable: see PYTHONPATH)") from error
    if not callable(value):
        raise ValueError(f"camera.trajectory.function = '{name}': not a function")
    return value  # type: ignore[no-any-return]


def checked(poses: Any, what: str) -> F64:
    """A hook's answer as (2, 7); refuses wrong shapes, non-finite values, zero quaternions."""
    try:
        array = np.asarray(poses, dtype=np.float64)
    except (TypeError, ValueError):
        text = "must return a pose (7,) or poses (2, 7) of numbers"
        raise ValueError(f"{what}: {text}, not {poses!r}") from None
    if array.shape == (7,):
        array = np.stack([array, array])
    if array.shape != (2, 7):
        raise ValueError(f"{what}: must return a pose (7,) or poses (2, 7), not {array.shape}")
    norms = np.linalg.norm(array[:, 3:], axis=1)
    if not np.isfinite(array).all() or not (norms > 0.0).all():
        raise ValueError(f"{what}: returned a pose that is not finite, or a zero quaternion")
    if np.abs(array[:, :3]).max() > _REACH_M:
        raise ValueError(f"{what}: returned a position more than {_REACH_M:g} m from the root")
    result = array.copy()
    result[:, 3:] /= norms[:, None]
    return result


def hook(world: World) -> F64:
    """The user's module:function, called as function(world, **params)."""
    spec = world.camera.trajectory
    assert isinstance(spec, Hook)
    return checked(_load(spec.function)(world, **spec.params), spec.function)


TRAJECTORIES: dict[str, Trajectory] = {
    "orbit_object": orbit_object,
    "fixed": fixed,
    "hook": hook,
}


def platform_poses(world: World, own: Callable[[World], Any] | None = None) -> F64:
    """Poses (2, 7) of the platform: the user's callable if there is one, else as configured."""
    if own is not None:
        return checked(own(world), getattr(own, "__name__", repr(own)))
    return TRAJECTORIES[world.camera.trajectory.kind](world)


def mounted(platform: F64, sensor: Sensor) -> F64:
    """A sensor's poses (2, 7) on the platform's."""
    place = sensor.transformation
    if isinstance(place, Mounting):
        offset, q = np.array(place.position_m), rotations.from_rpy_deg(place.rotation_deg)
    else:
        offset, q = np.array(place[:3]), np.array(place[3:])
    return np.stack(
        [
            np.concatenate(
                [
                    pose[:3] + rotations.rotate(pose[3:], offset),
                    rotations.multiply(pose[3:], q),
                ]
            )
            for pose in platform
        ]
    )


def camera_poses(world: World, own: Callable[[World], Any] | None = None) -> F64:
    """Poses (2, 7) of the camera that takes the frame: the platform's, or a sensor's on it."""
    poses = platform_poses(world, own)
    if world.sensor is not None:
        poses = mounted(poses, world.config.sensors[world.sensor])
    for when in range(2):
        body = world.inside(poses[when, :3], when=when)
        if body is not None:
            raise ValueError(f"camera.trajectory: frame {world.index}: the camera is inside {body}")
    return poses
