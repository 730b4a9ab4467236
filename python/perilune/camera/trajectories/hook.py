"""hook: poses from a user's function, with checks of its result."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.base import hooks
from perilune.config.trajectory import Hook
from perilune.world import World

F64 = NDArray[np.float64]

_REACH_M = 1e18  # as in the core: beyond, squares of float coordinates overflow


def checked(poses: Any, what: str) -> F64:
    """A hook's result as (2, 7); refuses wrong shapes, non-finite values, zero quaternions."""
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


def _nearest(world: World, place: F64) -> str:
    """The object whose surface, or bounding sphere, is nearest to a position at the opening."""
    entities = [*world.craft_radius_m, *world.body_radii_m]
    return min(
        entities,
        key=lambda name: (
            float(np.linalg.norm(place - world.position_m(name))) - world.radius_m(name)
        ),
    )


def beside(world: World, pose: F64, target: str | None) -> F64:
    """Poses (2, 7) of a camera that moves with an object (default: the nearest) while the shutter
    is open. pose: (7,), at the opening."""
    poses = world.poses[target or _nearest(world, pose[:3])]
    closing = pose.copy()
    closing[:3] += poses[1, :3] - poses[0, :3]
    return np.stack([pose, closing])


def called(
    world: World,
    function: Callable[..., Any],
    key: str,
    params: Mapping[str, Any],
    target: str | None,
) -> F64:
    """The poses that a function returns for the step; `key` names it in errors.

    target: object that a camera with one pose moves with (default: the nearest)."""
    answer = hooks.call(
        function,
        key,
        seed=world.config.seed,
        index=world.step,
        offers={"world": lambda: world},
        params=params,
        first="world",
        draws=key.replace(".hook", ".function"),
    )
    poses = checked(answer, getattr(function, "__name__", repr(function)))
    return beside(world, poses[0], target) if np.shape(answer) == (7,) else poses


def hook(world: World) -> F64:
    """The user's module:function, called as function(world, **params); it may have an argument
    `rng`."""
    spec = world.camera.trajectory
    assert isinstance(spec, Hook)
    key = "camera.trajectory.hook"
    function = hooks.load(spec.hook, key, world.system.setting.file)
    return called(world, function, key, spec.params, spec.target)
