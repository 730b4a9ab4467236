"""centred_target: on a line from a target, at a fixed distance or landing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.camera.trajectories.progress import Progress, progress
from perilune.camera.trajectories.view import aimed, axes, refuse
from perilune.config.trajectory import CentredTarget
from perilune.world import World

F64 = NDArray[np.float64]

_RADII = 3.0


def _direction(world: World, spec: CentredTarget, run: Progress) -> F64:
    if spec.direction is not None:
        return np.array(spec.direction)
    drawn = run.random(world, "camera.direction").standard_normal(3)
    return np.asarray(drawn / np.linalg.norm(drawn))


def _surface_m(world: World, spec: CentredTarget, direction: F64, when: int) -> float:
    """Distance from the centre to the surface along the line; for a spacecraft, to its bounding
    sphere."""
    if spec.target in world.craft_radius_m:
        return world.craft_radius_m[spec.target]
    line = rotations.rotate(axes(world, spec.target, spec.frame, when), direction)
    own = world.body_axes(spec.target, line, when)
    return world.surface_m(spec.target, own)


def centred_target(world: World) -> F64:
    """When landing, the distance to the surface is h0 (h1 / h0)^share."""
    spec = world.camera.trajectory
    assert isinstance(spec, CentredTarget)
    run = progress(world, spec)
    direction = _direction(world, spec, run)
    far = spec.distance_m
    if far is None:
        far = (spec.distance_scale or _RADII) * world.radius_m(spec.target)

    def place(when: int) -> F64:
        if spec.final_distance_m is None:
            return np.asarray(far * direction)
        surface = _surface_m(world, spec, direction, when)
        high, low = far - surface, spec.final_distance_m
        if not high > 0.0:
            refuse(
                world,
                f"the landing starts {far:.6g} m from the centre of {spec.target}, below its "
                f"surface at {surface:.6g} m",
            )
        return np.asarray((surface + high * (low / high) ** run.share[when]) * direction)

    return aimed(world, spec, place)
