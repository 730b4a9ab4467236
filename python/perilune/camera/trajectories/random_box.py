"""random_box: random positions in a box."""

from __future__ import annotations

from collections import Counter

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.camera.trajectories.view import (
    axes,
    camera_turn,
    finished,
    look,
    origin,
    refuse,
    unclear,
)
from perilune.config.trajectory import RandomBox
from perilune.world import World

F64 = NDArray[np.float64]
Corner = tuple[float, float, float]

_TRIES = 2000


def _in_box(rng: np.random.Generator, low: Corner, high: Corner) -> F64:
    """A uniform draw; a box without extent is a point."""
    return np.asarray(np.array(low) + np.subtract(high, low) * rng.random(3))


def _root_place(world: World, spec: RandomBox, place: F64, when: int) -> F64:
    q = axes(world, spec.around, spec.frame, when)
    return np.asarray(origin(world, spec.around, when) + rotations.rotate(q, place))


def _place(world: World, spec: RandomBox) -> F64:
    """The first drawn position that is clear at opening and closing."""
    rng = world.brief_random("camera.place", spec.interval)
    faults: Counter[str] = Counter()
    for _ in range(_TRIES):
        place = _in_box(rng, spec.min_m, spec.max_m)
        found = (
            unclear(world, _root_place(world, spec, place, when), spec.clearance_m, when)
            for when in range(2)
        )
        fault = next((fault for fault in found if fault), None)
        if fault is None:
            return place
        faults[fault] += 1
    why = "; ".join(f"{count} times: {fault}" for fault, count in faults.most_common())
    refuse(world, f"no camera pose in {_TRIES} tries ({why})")


def random_box(world: World) -> F64:
    """Uniform positions with a random rotation, or looking at an object or a random point."""
    spec = world.camera.trajectory
    assert isinstance(spec, RandomBox)
    place = _place(world.shared, spec)
    rng = world.brief_random("camera.turn", spec.interval)
    turn = aim = None
    if spec.rotation_min_deg is not None and spec.rotation_max_deg is not None:
        angles = _in_box(rng, spec.rotation_min_deg, spec.rotation_max_deg)
        turn = camera_turn(rotations.from_rpy_deg(angles.tolist()), spec.camera_axes)
    elif spec.target_min_m is not None and spec.target_max_m is not None:
        aim = _in_box(rng, spec.target_min_m, spec.target_max_m)
        if spec.target_from == "camera":
            aim = place + aim

    def view(when: int) -> tuple[F64, F64]:
        q = axes(world, spec.around, spec.frame, when)
        where = _root_place(world, spec, place, when)
        if turn is not None:
            return where, rotations.multiply(q, turn)
        point = world.poses[spec.target][when, :3] if spec.target is not None else None
        if aim is not None:
            point = _root_place(world, spec, aim, when)
        assert point is not None  # the schema asks for one of the three
        return where, look(world, where, point, rotations.rotate(q, np.array(spec.up)))

    return finished(world, spec, view)
