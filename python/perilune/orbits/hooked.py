"""Orbits by functions of the user's: their input and their results."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.base import arguments, hooks, rotations
from perilune.base.hooks import Hook
from perilune.config import Config
from perilune.config.errors import ConfigError, nearest
from perilune.config.orbit import Drawn, Hook as HookOrbit
from perilune.orbits.drawn import run_through, start_rev
from perilune.orbits.kinds.circular import path
from perilune.orbits.place import Motion, Place
from perilune.orbits.setting import KM

F64 = NDArray[np.float64]

_PAPER = frozenset({"scale_xyz", "rotation_rpy"})
_STATE = frozenset({"position_km", "velocity_km_s"})


@dataclass(frozen=True)
class Entity:
    """A body or spacecraft as a hook sees it; metres, root frame (ICRF axes)."""

    _pose: F64
    _radii_m: Callable[[], F64]

    @property
    def pose(self) -> F64:
        """(7,): x, y, z, qw, qx, qy, qz, from its own axes to the root's."""
        return _frozen(self._pose)

    @property
    def position_m(self) -> F64:
        """Position (3,) of its centre."""
        return _frozen(self._pose[:3])

    @property
    def radii_m(self) -> F64:
        """Semi-axes (3,) of a body; for a spacecraft, its bounding radius three times."""
        return _frozen(self._radii_m())


def _frozen(array: F64) -> F64:
    found = array.copy()
    found.flags.writeable = False
    return found


class Surroundings(Mapping[str, Entity]):
    """The argument `world` of an orbit's hook: all objects whose positions are known before it, at
    the scene's first step. Read-only."""

    def __init__(self, entities: Mapping[str, Entity]) -> None:
        self._entities = dict(entities)

    def __getitem__(self, name: str) -> Entity:
        return self._entities[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._entities)

    def __len__(self) -> int:
        return len(self._entities)


def _vector(answer: Mapping[str, Any], key: str) -> F64:
    try:
        array = np.asarray(answer[key], dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{key} must be three numbers, not {answer[key]!r}") from None
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ValueError(f"{key} must be three finite numbers, not {array.tolist()}")
    return array


def _circle(answer: Mapping[str, Any], orbit: Any, place: Place) -> Motion:
    """The form of the Space OAISYS paper: a circle scaled by the central body's radii, rotated by
    roll, pitch, yaw."""
    scale, rpy = _vector(answer, "scale_xyz"), _vector(answer, "rotation_rpy")
    if not (scale > 0.0).all():
        raise ValueError(f"scale_xyz must be positive, not {scale.tolist()}")
    drawn = isinstance(orbit, Drawn)
    v_step = orbit.v_step if drawn else 0.0
    if v_step is None:
        raise ValueError("returned {scale_xyz, rotation_rpy}: needs the orbit's key v_step")
    start = start_rev(orbit, place) if drawn else float(place.scene_random("orbit_start").random())
    return path(place, scale, rotations.from_rpy_deg(np.degrees(rpy).tolist()), v_step, start)


def _motion(answer: Any, orbit: Any, place: Place) -> Motion:
    if not isinstance(answer, Mapping):
        raise ValueError(
            "must return a mapping {scale_xyz, rotation_rpy}, {position_km, velocity_km_s}, or "
            f"elements such as altitude_km and inclination_deg, not {type(answer).__name__}"
        )
    keys, propagator = set(answer), getattr(orbit, "propagator", None)
    if keys & _PAPER:
        if keys != _PAPER:
            raise ValueError(f"must return scale_xyz and rotation_rpy alone, not {sorted(keys)}")
        if propagator not in (None, "circular"):
            raise ValueError(f"returned {{scale_xyz, rotation_rpy}}: not for {propagator}")
        return _circle(answer, orbit, place)
    if propagator == "circular":
        raise ValueError("propagator: circular needs {scale_xyz, rotation_rpy}")
    if keys & _STATE:
        if not keys <= _STATE | {"frame"} or not keys >= _STATE:
            text = f"must return position_km and velocity_km_s (and frame), not {sorted(keys)}"
            raise ValueError(text)
        state = {key: tuple(_vector(answer, key).tolist()) for key in sorted(_STATE)}
        rest = {"frame": answer["frame"]} if "frame" in answer else {}
        return run_through(propagator or "kepler", {"state": state, **rest}, place)
    return run_through(propagator or "kepler", {k: _plain(v) for k, v in answer.items()}, place)


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else value


def hook(orbit: Any, place: Place, world: Callable[[], Surroundings]) -> Motion:
    """The path that a hook returns for the scene; place: that of the scene's first step."""
    setting = place.setting
    given = place.setting.hooks.get(place.name)
    key = f"{place.key}.hook"
    if given is None:
        assert isinstance(orbit, HookOrbit)  # the caller has seen to it
        given = hooks.load(orbit.hook, key, setting.file)
    answer = hooks.call(
        given,
        key,
        seed=setting.config.seed,
        index=setting.scene,
        offers={
            "body_radius_xyz": lambda: place.parent.radii_m / KM,
            "world": world,
        },
        params=getattr(orbit, "params", None),
        draws=f"{place.key}.function",
    )
    try:
        return _motion(answer, orbit, place)
    except ValueError as error:
        name = getattr(given, "__name__", repr(given))
        raise ValueError(f"orbit.hook: {name}: {error}") from None


_AS_HOOK = "that draws its orbit (the keys of one go into overrides)"


def hooks_of(orbits: Mapping[str, Hook] | None, config: Config) -> dict[str, Hook]:
    """The hooks given in code, checked: ConfigError for a name that no entry has."""
    like = "{'sat': function}"
    found = dict(arguments.mapping("orbits", orbits or {}, like))
    known = [*config.bodies, *config.spacecraft]
    for name, hook in found.items():
        if name not in known:
            raise ConfigError(f"orbits: no entry named '{name}'{nearest(name, known)}")
        arguments.function(f"orbits['{name}']", hook, _AS_HOOK)
    return found
