"""hook: poses from a function of the user's, and the check of what it answers."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.config.trajectory import Hook
from perilune.world import World

F64 = NDArray[np.float64]

_REACH_M = 1e18  # as in the core: beyond, squares of float coordinates overflow


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
