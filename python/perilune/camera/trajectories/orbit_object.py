"""orbit_object: random positions around a moving target within given limits."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.camera.trajectories.view import distance_noise_m, noise, noisy, refuse, unclear
from perilune.config.trajectory import OrbitObject
from perilune.world import World

F64 = NDArray[np.float64]

_TRIES = 2000
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class _Band:
    """Directions whose angle to a unit axis is between two limits."""

    axis: F64
    low_rad: float
    high_rad: float

    @property
    def solid_angle(self) -> float:
        return 2.0 * math.pi * (math.cos(self.low_rad) - math.cos(self.high_rad))

    @cached_property
    def _basis(self) -> tuple[list[float], list[float], list[float]]:
        """Three unit axes, of which the last is the band's."""
        x_axis = rotations.cross(self.axis, np.eye(3)[int(np.argmin(np.abs(self.axis)))])
        x_axis /= rotations.norm(x_axis)
        y_axis = rotations.cross(self.axis, x_axis)
        return x_axis.tolist(), y_axis.tolist(), self.axis.tolist()

    def sample(self, rng: np.random.Generator) -> F64:
        """Uniform over the band; a band without width is a circle."""
        u, v = rng.random(2).tolist()
        low, high = math.cos(self.low_rad), math.cos(self.high_rad)
        z = low + (high - low) * u
        radius, angle = math.sqrt(max(0.0, 1.0 - z * z)), 2.0 * math.pi * v
        cosine, sine = math.cos(angle), math.sin(angle)
        rows = zip(*self._basis, strict=True)
        return np.array([radius * (cosine * x + sine * y) + z * axis for x, y, axis in rows])

    def holds(self, direction: F64) -> bool:
        angle = rotations.angle_rad(self.axis, direction)
        return self.low_rad - 1e-9 <= angle <= self.high_rad + 1e-9


def _unit(v: F64) -> F64:
    return np.asarray(v / rotations.norm(v))


def _bands(world: World, spec: OrbitObject) -> dict[str, _Band]:
    """Limits of the direction target -> camera, by the key that sets them."""
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
        distance = rotations.norm(to_body)
        radius = world.radius_m(spec.background)
        half = math.asin(radius / distance) if radius < distance else math.pi
        bands["background"] = _Band(_unit(-to_body) if distance > 0.0 else _UP, 0.0, half)
    return bands


def _fault(world: World, spec: OrbitObject, direction: F64, camera: F64, shift: F64) -> str | None:
    """Reason why a camera cannot be at a position; None if it can."""
    target = world.position_m(spec.target)
    if spec.background is not None and world.hit_m(spec.background, target, -direction) is None:
        return f"{spec.background} is not behind the target"
    places = (camera,) if world.window_s == 0.0 else (camera, camera + shift)
    for when, place in enumerate(places):
        fault = unclear(world, place, spec.clearance_m, when)
        if fault is not None:
            return fault
    length = rotations.norm(target - camera)
    for name in world.body_radii_m:
        if name != spec.target:
            hit = world.hit_m(name, camera, -direction)
            if hit is not None and hit < length:
                return f"{name} hides the target"
    return None


def _no_pose(world: World, spec: OrbitObject, faults: Counter[str]) -> NoReturn:
    why = "; ".join(f"{count} times: {fault}" for fault, count in faults.most_common())
    text = f"no camera pose in {_TRIES} tries ({why})"
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
    refuse(world, text)


def _place(world: World, spec: OrbitObject) -> F64:
    """Vector from the target to the camera: draws from the narrowest band until all limits are
    met."""
    bands = _bands(world, spec)
    narrowest = min(bands, key=lambda key: bands[key].solid_angle)
    others = {key: band for key, band in bands.items() if key not in (narrowest, "background")}
    rng = world.brief_random("camera.place", spec.interval)
    noise = distance_noise_m(world, spec.distance_noise_m)
    target = world.poses[spec.target]
    shift = target[1, :3] - target[0, :3]
    low, high = spec.distance_m
    faults: Counter[str] = Counter()
    for _ in range(_TRIES):
        direction = bands[narrowest].sample(rng)
        distance = low + (high - low) * float(rng.random()) + noise
        missed = next((key for key, band in others.items() if not band.holds(direction)), None)
        fault = f"{missed} is not met" if missed else None
        if fault is None:
            camera = target[0, :3] + distance * direction
            fault = _fault(world, spec, direction, camera, shift)
        if fault is None:
            return distance * direction
        faults[fault] += 1
    _no_pose(world, spec, faults)


def orbit_object(world: World) -> F64:
    """Random positions around a target within the given limits, looking at it.

    While the shutter is open, the camera keeps its position relative to the target's centre, and
    its axes in the root frame."""
    spec = world.camera.trajectory
    assert isinstance(spec, OrbitObject)
    offset = _place(world.shared, spec)
    q = noisy(rotations.look_at(-offset, _UP), noise(world, spec))
    return np.array([np.concatenate([pose[:3] + offset, q]) for pose in world.poses[spec.target]])
