"""hook: poses from a function of the user's, and the check of what it answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import hooks
from perilune.config.trajectory import Hook
from perilune.world import World

F64 = NDArray[np.float64]

_REACH_M = 1e18  # as in the core: beyond, squares of float coordinates overflow


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


def called(world: World, function: Callable[..., Any], key: str, params: Mapping[str, Any]) -> F64:
    """The poses that a function gives for the step; `key` names it in errors and draws."""
    answer = hooks.call(
        function,
        key,
        seed=world.config.seed,
        index=world.step,
        offers={"world": lambda: world},
        params=params,
        first="world",
    )
    return checked(answer, getattr(function, "__name__", repr(function)))


def hook(world: World) -> F64:
    """The user's module:function, called as function(world, **params); it may ask for `rng`."""
    spec = world.camera.trajectory
    assert isinstance(spec, Hook)
    key = "camera.trajectory.function"
    function = hooks.load(spec.function, key, world.system.setting.file)
    return called(world, function, key, spec.params)
